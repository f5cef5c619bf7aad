#include "veridyn/cueing/chain/cueing_chain.hpp"

#include <cmath>
#include <utility>

namespace veridyn::cueing {

CueingChain::CueingChain(std::unique_ptr<Washout> washout, const Platform& platform)
    : washout_(std::move(washout)), guard_((platform.validate(), platform.limits)), simulator_(platform) {}

CueingChain::CueingChain(const CueingChain& other)
    : washout_(other.washout_->clone()),
      guard_(other.guard_),
      simulator_(other.simulator_),
      desired_(other.desired_),
      joined_at_(other.joined_at_),
      since_joined_(other.since_joined_) {}

CueingStep CueingChain::reset(const recording::MotionSample& sample) {
  joined_at_ = {};
  since_joined_ = 0.0;
  CueingStep s;
  s.desired = desired_ = washout_->reset(sample);
  s.ordered = guard_.reset(s.desired);
  s.reached = simulator_.reset(s.ordered);
  return s;
}

std::unique_ptr<Washout> CueingChain::take_over(std::unique_ptr<Washout> washout, const recording::MotionSample& sample,
                                                double share) {
  std::swap(washout_, washout);
  restart(sample, share);
  return washout;
}

void CueingChain::restart(const recording::MotionSample& sample, double share) {
  desired_ = washout_->reset(sample);
  const PlatformState at = guard_.state();
  joined_at_.shift = at.shift - share * desired_.shift;
  joined_at_.angle = at.angle - share * desired_.angle;
  since_joined_ = 0.0;
}

CueingStep CueingChain::step(const recording::MotionSample& sample, double step, double share) {
  desired_ = washout_->step(sample, step);
  return follow(step, share);
}

CueingStep CueingChain::hold(double step, double share) { return follow(step, share); }

CueingStep CueingChain::brake(double step) {
  CueingStep s;
  s.ordered = guard_.brake(step);
  s.desired = s.ordered;
  s.reached = simulator_.step(s.ordered, step);
  if (simulator_.leg_rates().size() > 0) s.leg_speed = simulator_.leg_rates().cwiseAbs().maxCoeff();
  return s;
}

CueingStep CueingChain::follow(double step, double share) {
  constexpr double kJoins = 0.5;  // time constant, of second order [s]
  CueingStep s;
  if (step > 0.0 && std::isfinite(step)) since_joined_ += step;
  const double t = since_joined_ / kJoins, left = (1.0 + t) * std::exp(-t);
  s.desired = desired_;
  s.desired.shift = share * desired_.shift + left * joined_at_.shift;
  s.desired.angle = share * desired_.angle + left * joined_at_.angle;
  s.ordered = guard_.step(s.desired, step);
  s.limited = guard_.limited();
  s.reached = simulator_.step(s.ordered, step);
  if (simulator_.leg_rates().size() > 0) s.leg_speed = simulator_.leg_rates().cwiseAbs().maxCoeff();
  return s;
}

CueingRun drive_platform(const std::vector<recording::MotionSample>& vehicle, const Washout& washout,
                         const Platform& platform, Progress& progress) {
  CueingRun run;
  if (vehicle.empty()) return run;
  CueingChain chain(washout.clone(), platform);
  run.vehicle.reserve(vehicle.size());
  run.rider.reserve(vehicle.size());
  run.steps.reserve(vehicle.size());
  for (std::size_t k = 0; k < vehicle.size(); ++k) {
    run.steps.push_back(k == 0 ? chain.reset(vehicle[0])
                               : chain.step(vehicle[k], vehicle[k].time - vehicle[k - 1].time));
    run.vehicle.push_back(recording::in_frame(vehicle[k], Frame::kFrd));
    run.rider.push_back(rider_motion(run.steps.back().reached, platform.rider));
    run.rider.back().time = vehicle[k].time;
    constexpr std::size_t kBetweenLooks = 1000;
    if (k % kBetweenLooks == 0 && !progress.update(static_cast<double>(k) / static_cast<double>(vehicle.size()))) break;
  }
  run.account = chain.washout().account();
  return run;
}

}  // namespace veridyn::cueing
