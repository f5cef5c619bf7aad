#include "veridyn/cueing/score/felt_motion.hpp"

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

constexpr PerCue<std::string_view> kCueNames = {"surge", "sway", "heave", "roll", "pitch", "yaw"};

/// Forces less that of rest, then rates.
PerCue<double> cues_of(const Eigen::Vector3d& force, const Eigen::Vector3d& rate) {
  return {force.x(), force.y(), force.z() + kGravity, rate.x(), rate.y(), rate.z()};
}

}  // namespace

std::string_view name_of(Cue cue) { return kCueNames[cue]; }
std::string_view unit_of(Cue cue) { return cue < Cue::kRoll ? "m/s^2" : "rad/s"; }

FeltMotion felt_motion(const CueingRun& run, const VestibularModel& model, const MotionThresholds& thresholds) {
  if (model.felt_rate_unit != "1" || model.felt_force_unit != "1")
    throw InputError("perception", "model '" + model.name +
                                       "' answers in a nerve's firing rate; a score needs forces and rates: take "
                                       "\"young_meiry\", \"telban_cardullo\" or \"hosman\"");
  FeltMotion felt;
  for (std::size_t i = 0; i < 3; ++i) {
    felt.threshold[i] = thresholds.force[i];
    felt.threshold[i + 3] = thresholds.rate[i];
  }
  // The otoliths' lasting answer to gravity is taken off before them: they are linear.
  const auto follow = [&](const std::vector<recording::MotionSample>& samples, bool vehicle) {
    Perception perception(model);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const auto physical = cues_of(samples[k].force, samples[k].rate);
      const Eigen::Vector3d force(physical[0], physical[1], physical[2]), rate = samples[k].rate;
      const Perception::Felt f =
          k == 0 ? perception.reset(force, rate) : perception.step(force, rate, samples[k].time - samples[k - 1].time);
      for (std::size_t i = 0; i < kCues; ++i) {
        const auto axis = static_cast<Eigen::Index>(i % 3);
        (vehicle ? felt.physical[i].vehicle : felt.physical[i].platform).push_back(physical[i]);
        (vehicle ? felt.felt[i].vehicle : felt.felt[i].platform).push_back(i < 3 ? f.force(axis) : f.rate(axis));
      }
    }
  };
  for (const recording::MotionSample& s : run.rider) felt.time.push_back(s.time);
  follow(run.vehicle, true);
  follow(run.rider, false);
  return felt;
}

}  // namespace veridyn::cueing
