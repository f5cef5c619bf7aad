#include "veridyn/cueing/perception/perception.hpp"

namespace veridyn::cueing {

Perception::Perception(const VestibularModel& model)
    : canals_{numerics::CausalFilter(model.canals[0]), numerics::CausalFilter(model.canals[1]),
              numerics::CausalFilter(model.canals[2])},
      otoliths_{numerics::CausalFilter(model.otoliths), numerics::CausalFilter(model.otoliths),
                numerics::CausalFilter(model.otoliths)} {}

Perception::Felt Perception::reset(const Eigen::Vector3d& force, const Eigen::Vector3d& rate) {
  Felt felt;
  for (std::size_t i = 0; i < 3; ++i) {
    felt.rate(i) = canals_[i].reset(rate(i));
    felt.force(i) = otoliths_[i].reset(force(i));
  }
  return felt;
}

Perception::Felt Perception::step(const Eigen::Vector3d& force, const Eigen::Vector3d& rate, double step) {
  Felt felt;
  for (std::size_t i = 0; i < 3; ++i) {
    felt.rate(i) = canals_[i].step(rate(i), step);
    felt.force(i) = otoliths_[i].step(force(i), step);
  }
  return felt;
}

}  // namespace veridyn::cueing
