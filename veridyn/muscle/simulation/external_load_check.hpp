#pragma once

#include <string>
#include <vector>

#include "veridyn/muscle/simulation/motion_analysis.hpp"

namespace veridyn::muscle {

/// How external loads fit the motion that was recorded with them.
///
/// Along a coordinate that lifts the whole model (the vertical translation of the pelvis) nothing but the loads can
/// give the force that the motion needs: the least squares of what is left say by which factor the loads would fit.
struct ExternalLoadFit {
  int coordinate = -1;   ///< that lifts the model; -1: it has none that is free
  double weight = 0.0;   ///< of the model [N]
  double without = 0.0;  ///< root mean square of the force at the coordinate without the loads [N]
  double with = 0.0;     ///< and with them
  double factor = 1.0;   ///< by which the loads would have to be multiplied
};

/// The free coordinate that translates the whole model against gravity; -1: it has none.
[[nodiscard]] int lifting_coordinate(const MusculoskeletalSystem& system);

/// @param analysis of `motion` with its loads.
[[nodiscard]] ExternalLoadFit external_load_fit(const MusculoskeletalSystem& system, const MotionAnalysis& analysis);

/// What is likely wrong with the loads, a line each: a residual that grows with them (opposite sign, another unit), one
/// above a tenth of the weight, forces that act farther from their bodies than a metre (points in millimetres or in
/// another frame).
[[nodiscard]] std::vector<std::string> external_load_warnings(const MusculoskeletalSystem& system,
                                                              const ExternalLoads& loads,
                                                              const MotionAnalysis& analysis);

/// Of reserves (rows x coordinates) that carry the model where nothing but the surroundings could: more than a
/// twentieth of the weight at the coordinate that lifts it. Empty when they do not.
[[nodiscard]] std::string lifting_reserve_warning(const MusculoskeletalSystem& system,
                                                  const estimation::RowMatrix& reserve);

}  // namespace veridyn::muscle
