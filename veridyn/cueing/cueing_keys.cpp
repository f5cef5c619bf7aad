#include "veridyn/cueing/cueing_keys.hpp"

#include <fmt/format.h>

#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/cueing/platform/platform.hpp"

namespace veridyn::cueing {

const KeyTable<MaskTable>& MaskTable::keys() {
  using M = MaskTable;
  std::vector<std::pair<std::string, Cue>> cues;
  for (const Cue cue : kAllCues) cues.emplace_back(name_of(cue), cue);
  static const auto table =
      KeyTable<M>("omct.mask", "Where the response has to be, on lines between the frequencies.")
          .repeated()
          .choice("cue", &M::cue, cues, "whose response")
          .numbers("frequency", &M::frequency, "rad/s", kAnyNumber, "growing, two at least")
          .required()
          .numbers("least_gain", &M::least_gain, "1", kAnyNumber, "one value per frequency, as in the next three")
          .otherwise("none")
          .numbers("most_gain", &M::most_gain, "1", kAnyNumber, "greatest gain")
          .otherwise("none")
          .numbers("least_phase", &M::least_phase, "rad", kAnyNumber, "least phase")
          .otherwise("none")
          .numbers("most_phase", &M::most_phase, "rad", kAnyNumber, "greatest phase")
          .otherwise("none");
  return table;
}

const KeyTable<ResponseOptions>& response_keys() {
  static const auto table =
      KeyTable<ResponseOptions>("omct", "Measure gain and phase of the chain.")
          .number("force", &ResponseOptions::force, "m/s^2", kPositive, "amplitude along an axis")
          .number("rate", &ResponseOptions::rate, "rad/s", kPositive, "amplitude about an axis")
          .numbers("frequencies", &ResponseOptions::frequencies, "rad/s", share_up_to(50.0), "of the sines")
          .otherwise("the twelve of the test");
  return table;
}

const KeyTable<TuningOptions>& tuning_keys() {
  static const auto table =
      KeyTable<TuningOptions>("tune", "Turn the knobs on this drive, or on another one.")
          .count("evaluations", &TuningOptions::evaluations, 1, 1'000'000'000, "drives of each algorithm, at most")
          .number("strength", &TuningOptions::strength, "1", kPositive,
                  "share of the vehicle's felt motion (RMS) that the platform is to have at least")
          .elsewhere({"data", "", "", "the drive itself", "`[tune.data]`, as `[data]`: another drive", true});
  return table;
}

namespace {

/// `[washout.NAME]` of each algorithm.
std::vector<StudyKeys> washout_keys() {
  std::vector<StudyKeys> all;
  for (const WashoutAlgorithm& a : washout_algorithms()) {
    StudyKeys keys{fmt::format("washout.{}", a.name), std::string(a.summary), {}};
    const std::unique_ptr<WashoutDesign> design = a.design();
    for (const Knob& knob : design->knobs()) {
      const std::vector<double> values(knob.values.begin(), knob.values.end());
      const std::string shown =
          values.size() == 1 ? internal::shown(values.front(), knob.unit) : internal::shown(values, knob.unit);
      keys.keys.push_back({knob.name, knob.unit, knob.zero ? ">= 0" : "> 0", shown, "turned up: " + knob.feel});
    }
    all.push_back(std::move(keys));
  }
  return all;
}

}  // namespace

const KeyTable<CueTable>& CueTable::keys() {
  using C = CueTable;
  std::vector<std::pair<std::string, std::string>> models;
  for (const VestibularModel& m : vestibular_models()) models.emplace_back(m.name, m.name);
  const auto place = [](C& c) -> Eigen::Vector3d& { return c.motion.place; };
  const auto gravity = [](C& c) -> recording::GravityIn& { return c.motion.gravity; };
  static const auto table =
      KeyTable<C>("cue", "What algorithms make of the drive, and how it is judged.")
          .texts("algorithms", &C::algorithms, "algorithms to compare; the first is the reference")
          .with(&C::settings, DriverSettings::keys())
          .numbers("driver", &C::driver, "m", kAnyNumber, "driver's head from the centre of gravity: forward, left, up")
          .numbers("sensor", place, "m", kAnyNumber, "the same of the recorded accelerometer")
          .choice("gravity", gravity,
                  {{"decide", recording::GravityIn::kDecide},
                   {"in", recording::GravityIn::kYes},
                   {"out", recording::GravityIn::kNo}},
                  "whether accelerations contain gravity; `decide`: by accel_z")
          .choice("perception", &C::perception, models, "model of the organs of balance")
          .choice("thresholds", &C::reid_nahon, {{"usual", false}, {"reid_nahon", true}}, "of what is felt")
          .flag("optimum", &C::optimum, "how small the perceived error could be with the drive known before")
          .flag("knobs", &C::knobs, "what each knob does, on a short drive of its own")
          .choice("foresee", &C::foresee,
                  {{"fade", ForesightBy::kFade}, {"lap", ForesightBy::kLap}, {"driver", ForesightBy::kDriver}},
                  "how algorithms that plan ahead foresee forces")
          .otherwise("`\"lap\"` with `[cue.lap]`, `\"driver\"` with `[cue.vehicle]`, else `\"fade\"`")
          .elsewhere({"lap", "", "", "none", "`[cue.lap]`, as `[data]`: a lap of the same track, driven before", true})
          .elsewhere({"vehicle", "", "", "the simulated vehicle",
                      "`[cue.vehicle]`, as `[subject]`: what steering and pedals act on", true});
  return table;
}

std::vector<StudyKeys> study_keys() {
  std::vector<StudyKeys> all = all_of(CueTable::keys());
  all.push_back(Platform::study_keys());
  const std::vector<std::vector<StudyKeys>> more = {washout_keys(),
                                                    all_of(response_keys(), MaskTable::keys(), tuning_keys())};
  for (const std::vector<StudyKeys>& some : more) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace veridyn::cueing
