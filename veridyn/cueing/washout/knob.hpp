#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"

namespace veridyn::cueing {

/// A number of an algorithm that its user may turn.
struct Knob {
  std::string name;                       ///< key in `[washout]`
  std::string unit;                       ///< SI
  std::span<double> values;               ///< where they are kept: one, or one an axis
  std::string feel;                       ///< what the driver feels when it is turned up
  bool zero = false;                      ///< whether zero is allowed; below zero never is
  double tune_from = 0.0, tune_to = 0.0;  ///< where the automatic tuning looks; the same: nowhere
};

/// Reads the knobs that the table names. @throws InputError with file, line and key.
void read_knobs(const StudyTable& table, std::span<const Knob> knobs);
/// @throws InputError "washout.onset: is 0; must be above 0".
void check_knobs(std::span<const Knob> knobs);

/// The design, its knobs checked.
template <typename Design>
[[nodiscard]] Design checked(Design design) {
  check_knobs(design.knobs());
  return design;
}

}  // namespace veridyn::cueing
