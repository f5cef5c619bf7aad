#include "veridyn/live/page/felt_now.hpp"

namespace veridyn::live {

FeltNow::FeltNow(const cueing::CueingStudy& study)
    : rider_place_(study.platform.rider),
      has_units_(cueing::vestibular_model(study.perception).felt_rate_unit == "1" &&
                 cueing::vestibular_model(study.perception).felt_force_unit == "1"),
      vehicle_(cueing::vestibular_model(study.perception)),
      rider_(cueing::vestibular_model(study.perception)) {
  for (std::size_t i = 0; i < 3; ++i) {
    threshold_[i] = study.thresholds.force[i];
    threshold_[i + 3] = study.thresholds.rate[i];
  }
}

cueing::PerCue<double> FeltNow::Head::feel(const recording::MotionSample& sample, std::optional<double> step) {
  // The lasting answer to gravity is taken off before, as in a score: the organs are linear.
  const Eigen::Vector3d force = sample.force - recording::force_at_rest(Frame::kFrd);
  const cueing::Perception::Felt f =
      step ? perception.step(force, sample.rate, *step) : perception.reset(force, sample.rate);
  return {{f.force.x(), f.force.y(), f.force.z(), f.rate.x(), f.rate.y(), f.rate.z()}};
}

void FeltNow::update(const RigStatus& status) {
  if (!has_units_ || !status.step.motion || (last_ && status.step.time <= *last_)) return;
  constexpr double kTornApart = 1.0;  // [s]: after a longer pause they begin again
  std::optional<double> step;
  if (last_) step = seconds(status.step.time - *last_);
  if (step && *step > kTornApart) step.reset();
  last_ = status.step.time;
  now_ = Cues{.vehicle = vehicle_.feel(recording::in_frame(status.step.motion->sample, Frame::kFrd), step),
              .rider = rider_.feel(rider_motion(status.step.cueing.reached, rider_place_), step)};
}

}  // namespace veridyn::live
