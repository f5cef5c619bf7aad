#include "veridyn/cueing/washout/shoarai_washout.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_systems/discretisation.hpp"
#include "veridyn/numerics/linear_systems/transfer_function.hpp"

namespace veridyn::cueing {
namespace {

using numerics::TransferFunction;

numerics::StateSpace sampled(const TransferFunction& transfer, double step) {
  return numerics::bilinear(numerics::realise(transfer), step);
}

template <std::size_t kCount, typename Filter>
std::array<Filter, kCount> alike(const Filter& filter) {
  if constexpr (kCount == 3) {
    return {filter, filter, filter};
  } else {
    return {filter, filter};
  }
}

const ShoaraiSettings& usable(const ShoaraiSettings& s) {
  if (!(std::min({s.step, s.shift_high_pass, s.tilt_low_pass, s.turn_high_pass, s.zeta}) > 0.0))
    throw InputError("washout", "step, frequencies and damping ratio must be above 0");
  return s;
}

}  // namespace

ShoaraiWashout::Filter::Filter(const numerics::StateSpace& s) : D_(s.D(0, 0)) {
  const Eigen::Index n = s.states();
  A_.topLeftCorner(n, n) = s.A;
  B_.head(n) = s.B;
  C_.head(n) = s.C.transpose();
}

double ShoaraiWashout::Filter::step(double u) {
  const double y = C_.dot(x_) + D_ * u;
  x_ = A_ * x_ + B_ * u;
  return y;
}

ShoaraiWashout::ShoaraiWashout(const ShoaraiSettings& settings)
    : settings_(usable(settings)),
      shift_(alike<3>(Filter(sampled(numerics::high_pass(settings.shift_high_pass, settings.zeta), settings.step)))),
      turn_(alike<3>(Filter(sampled(numerics::high_pass(settings.turn_high_pass), settings.step)))),
      tilt_(alike<2>(Filter(sampled(numerics::low_pass(settings.tilt_low_pass, settings.zeta), settings.step)))),
      gravity_(0.0, 0.0, settings.gravity_from_zero ? 0.0 : kGravity) {}

const ShoaraiWashout::Pose& ShoaraiWashout::step(const Eigen::Vector3d& a, const Eigen::Vector3d& omega) {
  const Eigen::Vector3d felt = a + gravity_ - kGravity * Eigen::Vector3d::UnitZ();
  for (Eigen::Index i = 0; i < 3; ++i) {
    speed_(i) += settings_.step * shift_[i].step(felt(i));
    pose_.shift(i) += settings_.step * speed_(i);
    turned_(i) += settings_.step * turn_[i].step(omega(i));
  }
  const auto leaning = [](double force) { return std::asin(std::clamp(force / kGravity, -1.0, 1.0)); };
  const double along = tilt_[0].step(a.x()), across = tilt_[1].step(a.y());
  pose_.angle = turned_ + Eigen::Vector3d(leaning(across), -leaning(along), 0.0);
  const double roll = pose_.angle.x(), pitch = pose_.angle.y();
  gravity_ =
      kGravity * Eigen::Vector3d(-std::sin(pitch), std::sin(roll) * std::cos(pitch), std::cos(roll) * std::cos(pitch));
  return pose_;
}

}  // namespace veridyn::cueing
