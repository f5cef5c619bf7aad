#include "veridyn/muscle/identification/task_warnings.hpp"

#include <fmt/format.h>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/muscle_simulation.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"

namespace veridyn::muscle {

std::vector<std::string> task_warnings(const MuscleParametricModel& model, const Eigen::VectorXd& theta) {
  std::vector<std::string> warnings;
  for (std::size_t s = 0; s < model.segments(); ++s) {
    const MusculoskeletalSystem& system = model.system_of(s);
    const MotionSegment& segment = model.motion()[s];
    // The free coordinates are simulated, those that follow them come from the couplers.
    const CoordinateReduction& reduction = system.reduction();
    std::vector<MuscleOutput> outputs;
    for (const int c : reduction.free()) outputs.push_back({MuscleOutputKind::kValue, c, 0.0});
    const auto initial = model.initial_conditions(s);
    Eigen::VectorXd all(theta.size() + signed_index(initial.size()));
    all.head(theta.size()) = theta;
    for (std::size_t i = 0; i < initial.size(); ++i) all(theta.size() + signed_index(i)) = initial[i].start;
    estimation::ModelResponse response;
    response.output.resize(model.samples(s), outputs.size());
    if (!internal::simulate_values({&system, &segment, model.unknowns(), outputs, model.accuracy()}, all, response)) {
      warnings.push_back(fmt::format("{}: the simulation cannot finish", model.segment_name(s)));
      continue;
    }
    std::vector<DrivenMotion<double>> driven = reduction.default_motion();
    for (std::size_t i = 0; i < driven.size(); ++i) driven[i].value = segment.start.q(reduction.driven()[i]);
    ExpandedState<double> state(reduction.coordinates());
    const std::vector<double> rest(reduction.free().size(), 0.0);
    estimation::RowMatrix q(response.output.rows(), reduction.coordinates());
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      expand(reduction, response.output.row(i).data(), rest.data(), driven.data(), state);
      q.row(i) = state.q.transpose();
    }
    for (const WrapBandVisit& visit : wrap_band_visits(system, segment.time, q))
      warnings.push_back(fmt::format("{}: {}", model.segment_name(s), wrap_band_text(system, visit)));
  }
  return warnings;
}

}  // namespace veridyn::muscle
