#include "veridyn/muscle/identification/muscle_values.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::muscle {

double& MuscleValues::at_name(const MuscleParameterName& name) {
  if (name.field == MuscleParameterName::kGain) return gain[name.muscle];
  if (name.field == MuscleParameterName::kDelay) return delay[name.muscle];
  return field_of(muscles[name.muscle], name.field);
}

bool MuscleValues::possible() const {
  for (const MusculotendonParameters<double>& m : muscles) {
    for (std::size_t f = 0; f < kEstimableFields; ++f) {
      const double value = field_of(m, f);
      if (!std::isfinite(value) || !(f == 3 ? value >= 0.0 && value < 1.5 : value > 0.0)) return false;
    }
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(gain.begin(), gain.end(), finite) && std::all_of(delay.begin(), delay.end(), finite);
}

MuscleValues values_at(const MuscleGroup<double>& muscles, std::span<const MuscleUnknown> unknowns,
                       const Eigen::VectorXd& theta) {
  MuscleValues values;
  for (std::size_t m = 0; m < muscles.size(); ++m) values.muscles.push_back(muscles.settings(m).musculotendon);
  values.gain.assign(muscles.size(), 1.0);
  values.delay.assign(muscles.size(), 0.0);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    for (const MuscleParameterName& name : unknowns[i].parameters) {
      double& value = values.at_name(name);
      value = unknowns[i].factor ? value * theta(i) : theta(i);
    }
  }
  return values;
}

}  // namespace veridyn::muscle
