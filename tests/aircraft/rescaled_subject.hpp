#pragma once

#include <cmath>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft::testing {

/// Factor on a parameter's value when the reference lengths are those of the subject times `roll`, `pitch` and `yaw`.
struct LengthFactors {
  double roll = 1.0, pitch = 1.0, yaw = 1.0;

  [[nodiscard]] double on(Coefficient coefficient, const Term& term) const {
    double factor = 1.0;
    if (coefficient == Coefficient::kCl) factor /= roll;
    if (coefficient == Coefficient::kCm) factor /= pitch;
    if (coefficient == Coefficient::kCn) factor /= yaw;
    for (const Factor& f : term.factors) {
      if (f.variable == AeroVariable::kPn) factor /= std::pow(roll, f.power);
      if (f.variable == AeroVariable::kQn) factor /= std::pow(pitch, f.power);
      if (f.variable == AeroVariable::kRn) factor /= std::pow(yaw, f.power);
    }
    return factor;
  }
};

/// The same aircraft with other reference lengths: its numbers differ, its motion does not.
inline Subject with_lengths(const Subject& subject, const LengthFactors& by) {
  Subject s = subject;
  s.lengths = {.roll = by.roll * s.roll_length(), .pitch = by.pitch * s.pitch_length(), .yaw = by.yaw * s.yaw_length()};
  for (auto& model : s.model.coefficients) {
    if (!model) continue;
    for (std::size_t i = 0; i < model->size(); ++i) model->values[i] *= by.on(model->coefficient, model->terms[i]);
  }
  return s;
}

}  // namespace veridyn::aircraft::testing
