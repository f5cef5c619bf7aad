#pragma once

#include <Eigen/Core>

namespace veridyn::estimation {

/// Most parameters that a recursive estimator takes. Its matrices live inside the object, at their largest size, so
/// that an update never asks for memory; the batch estimators have no limit.
inline constexpr int kMaxRecursiveParameters = 8;
/// Columns of [X, z] at most.
inline constexpr int kMaxRecursiveColumns = kMaxRecursiveParameters + 1;

/// Vector of at most 9 elements, on the stack or inside an object.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRecursiveColumns, 1>;
/// Matrix of at most 9 x 9, on the stack or inside an object.
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRecursiveColumns, kMaxRecursiveColumns>;

}  // namespace veridyn::estimation
