#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"

namespace veridyn::estimation {

/// Which indices are computed.
enum class IndexMethod {
  kVariance,  ///< first and total order (Saltelli, Jansen) with intervals
  kMorris,    ///< elementary effects: a screening at a small share of the cost
  kNone,
};

/// How indices are computed. Keys of the study table `[sensitivity]`.
struct IndexOptions {
  IndexMethod method = IndexMethod::kVariance;
  numerics::SensitivityOptions variance = {};
  std::size_t morris_trajectories = 20;
  std::size_t morris_levels = 4;

  [[nodiscard]] static const KeyTable<IndexOptions>& keys();
};

/// The keys of IndexOptions. @param seed  of the design
[[nodiscard]] IndexOptions read_index_options(const StudyTable& table, std::uint64_t seed);

/// Indices of one result.
struct ResultIndices {
  std::string result;
  numerics::SensitivityIndices variance = {};       ///< without inputs: Morris, or too few runs finished
  std::vector<numerics::MorrisEffect> morris = {};  ///< change of the result over the whole range of the input
  std::size_t failed = 0;                           ///< points of which there is no result
};

/// Intervals wider than this share of their index are warned of.
inline constexpr double kWideInterval = 0.1;
/// Whether the interval of an index is so wide; also where one of them is not finite.
[[nodiscard]] bool wide_interval(double index, double low, double high);

/// The points, rows in the unit cube of the inputs, at which results are needed; none without a method.
[[nodiscard]] Eigen::MatrixXd index_design(std::size_t inputs, const IndexOptions& options);

/// Indices from a result's values at the points of `design`, in their order; NaN where there is none. Where too few
/// are left, there are no indices and a sentence more in `warnings`.
[[nodiscard]] ResultIndices result_indices(std::string result, const Eigen::VectorXd& values,
                                           const Eigen::MatrixXd& design, const IndexOptions& options,
                                           std::vector<std::string>& warnings);

/// One line for several results together: how many indices have wide intervals, and how many of these are of inputs
/// that move their result (a total order of at least 0.05); empty where none is.
[[nodiscard]] std::string wide_interval_warning(std::span<const ResultIndices> results, std::size_t samples);

/// One line for a result whose intervals are wide, naming what is influential (a total order of at least 0.05) and
/// uncertain; empty where none is.
[[nodiscard]] std::string wide_interval_warning(const ResultIndices& indices, const std::vector<std::string>& inputs,
                                                std::size_t samples);

}  // namespace veridyn::estimation
