#pragma once

#include <string>

#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle::test {

/// What random poses over the whole ranges show of a model's arms.
struct ArmCounts {
  int arms = 0;
  int stick_out = 0;     ///< more than 1.5 times the largest within 1 deg along a coordinate
  int no_slope = 0;      ///< more than 1e-7 m from every central difference of lengths, of steps from 1e-4 to 1e-7
  int unnamed = 0;       ///< of those, where `wrap_band_visits` names no side change within 2e-4 of the pose
  double largest = 0.0;  ///< [m]
  std::string where;     ///< of those that stick out or are unnamed
};

/// The poses are the same for the same seed.
[[nodiscard]] ArmCounts count_arms(const Model& model, int poses, unsigned seed = 18);

}  // namespace veridyn::muscle::test
