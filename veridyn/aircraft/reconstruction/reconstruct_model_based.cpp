#include "veridyn/aircraft/reconstruction/reconstruct_solve_run.hpp"

namespace veridyn::aircraft::internal {

ModelError model_error_of(const Subject& subject, const ReconstructOptions& o) {
  ModelError error{.initial = o.model_error, .walk = o.model_error_walk, .modelled = {}};
  constexpr std::array<Coefficient, 3> kForces{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY};
  for (std::size_t i = 0; i < 3; ++i) error.modelled[i] = subject.model.find(kForces[i]) != nullptr;
  return error;
}

Solution solve_model_based(const SolveTask& task, Progress& progress) {
  // Two instantiations: who asks for any error of the inertial sensors pays for all of them, in time only.
  return task.options->wants_imu_biases() ? solve<ModelBasedAirData<12, false>>(task, progress)
                                          : solve<ModelBasedAirData<0, false>>(task, progress);
}

}  // namespace veridyn::aircraft::internal
