#include "veridyn/muscle/actuator/muscle_group.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

std::vector<MuscleParameters> muscle_parameters(const Model& model) {
  std::vector<MuscleParameters> parameters;
  for (const Muscle& muscle : model.muscles) parameters.push_back(muscle.parameters);
  return parameters;
}

std::vector<CompiledCurves> compile_curves(std::span<const MuscleParameters> muscles) {
  std::vector<CompiledCurves> curves;
  for (std::size_t i = 0; i < muscles.size(); ++i) {
    check(muscles[i]);
    const auto damped = [](const MuscleParameters& p) {
      return p.rigid_tendon || p.fiber_damping >= Millard2012::kDampingThreshold;
    };
    std::size_t same = i;
    if (const auto* millard = std::get_if<MillardCurves>(&muscles[i].curves)) {
      for (std::size_t j = 0; j < i && same == i; ++j) {
        const auto* other = std::get_if<MillardCurves>(&muscles[j].curves);
        if (other != nullptr && *other == *millard && damped(muscles[i]) == damped(muscles[j])) same = j;
      }
    }
    curves.push_back(same < i ? CompiledCurves(curves[same]) : compile_curves(muscles[i]));
  }
  return curves;
}

void check_excitations(std::span<const MuscleParameters> muscles, std::span<const double> excitation) {
  if (muscles.size() != excitation.size())
    throw InputError("excitations", fmt::format("{} values for {} muscles", excitation.size(), muscles.size()));
  for (std::size_t i = 0; i < muscles.size(); ++i)
    if (!std::isfinite(excitation[i]))
      throw InputError(fmt::format("muscle {}", muscles[i].name),
                       fmt::format("its excitation is {}; must be a finite number", excitation[i]));
}

template class MuscleGroup<double>;

}  // namespace veridyn::muscle
