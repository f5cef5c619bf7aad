#include "veridyn/aircraft/reconstruction/guarded_filter.hpp"

#include <utility>

namespace veridyn::aircraft {
namespace {

bool is_finite(const internal::AirDataEstimator& filter) {
  const AirDataState<double>& x = filter.state();
  return x.attitude.coeffs().allFinite() && x.velocity.allFinite() && x.gust.allFinite() && x.wind.allFinite() &&
         x.coefficient_error.allFinite() && filter.covariance().matrix.diagonal().allFinite();
}

}  // namespace

GuardedFilter::GuardedFilter(bool imu_errors, const ModelBasedMotion& motion, std::shared_ptr<const Subject> subject,
                             const internal::Start& start, double t, const estimation::GuardOptions& guard,
                             const estimation::InnovationGate& gate)
    : subject_(std::move(subject)),
      free_(internal::model_free_engine(imu_errors)->estimator(motion, start)),
      based_(internal::model_based_engine(imu_errors)->estimator(motion, start)),
      guard_(guard),
      gate_(gate),
      t_(t) {
  based_->set_forces(subject_.get(), motion.error);
  free_monitors_.fill(estimation::InnovationMonitor(gate));
  restart_model_based();
  guard_.restart(t, subject_ != nullptr);
}

void GuardedFilter::set_model(std::shared_ptr<const Subject> subject, const ModelError& error) {
  const bool another = subject_ != nullptr && subject != nullptr;
  subject_ = std::move(subject);
  based_->set_forces(subject_.get(), error);
  restart_model_based();
  // With one model after the other the guard goes on: refinements must not begin its waiting time again and again.
  if (!another) guard_.restart(t_, false);
}

void GuardedFilter::propagate(const AirDataInput& u, double dt) {
  t_ += dt;
  if (subject_) based_->propagate(u, dt);
  free_->propagate(u, dt);
}

void GuardedFilter::measure(const internal::MeasurementContext& context, internal::Sensor which, double z,
                            double sigma) {
  static_cast<void>(free_->measure(context, which, z, sigma, free_monitors_[which], nullptr));
  if (!subject_) return;
  estimation::Innovation seen;
  const bool offered = based_->measure(context, which, z, sigma, based_monitors_[which], &seen);
  if (offered && which >= internal::kPitot) guard_.add(static_cast<std::size_t>(which), seen.nis());
}

void GuardedFilter::judge() {
  if (!subject_) return;
  // An absurd model drives its filter out of numbers, where no innovation is left to judge.
  if (!is_finite(*based_)) {
    restart_model_based();
    guard_.restart(t_, false);
    return;
  }
  if (guard_.advance(t_) && guard_.alarm()) restart_model_based();
}

void GuardedFilter::restart_model_based() {
  based_->restart_from(*free_);
  based_monitors_.fill(estimation::InnovationMonitor(gate_));
}

}  // namespace veridyn::aircraft
