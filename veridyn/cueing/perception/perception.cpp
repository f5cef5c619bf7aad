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
    const auto axis = static_cast<Eigen::Index>(i);
    felt.rate(axis) = canals_[i].reset(rate(axis));
    felt.force(axis) = otoliths_[i].reset(force(axis));
  }
  return felt;
}

Perception::Felt Perception::step(const Eigen::Vector3d& force, const Eigen::Vector3d& rate, double step) {
  Felt felt;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    felt.rate(axis) = canals_[i].step(rate(axis), step);
    felt.force(axis) = otoliths_[i].step(force(axis), step);
  }
  return felt;
}

}  // namespace veridyn::cueing
