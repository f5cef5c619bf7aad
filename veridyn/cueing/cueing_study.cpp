#include "veridyn/cueing/cueing_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/cueing_keys.hpp"
#include "veridyn/cueing/washout/driver_foresight.hpp"
#include "veridyn/cueing/washout/lap_foresight.hpp"
#include "veridyn/cueing/washout/shared_channels.hpp"
#include "veridyn/recording/consistency.hpp"
#include "veridyn/recording/motion_recording.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/simulation/trajectory_motion.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;

std::vector<MotionSample> at_driver(std::vector<MotionSample> samples, const Eigen::Vector3d& driver) {
  for (MotionSample& s : samples) s = recording::at_place(s, driver);
  return samples;
}

/// A drive at the driver's head, and where it comes from.
struct DrivenMotion {
  std::string name = {};
  std::vector<MotionSample> samples = {};
  std::vector<std::filesystem::path> inputs = {};
  std::vector<std::string> notes = {};
};

/// Adds inputs and notes of a drive to those of the study, each note once.
void account_for(const DrivenMotion& drive, CueingStudy& study) {
  study.inputs.insert(study.inputs.end(), drive.inputs.begin(), drive.inputs.end());
  for (const std::string& note : drive.notes) {
    if (std::find(study.notes.begin(), study.notes.end(), note) == study.notes.end()) study.notes.push_back(note);
  }
}

/// The recorded drive of a `[data]`.
DrivenMotion recorded(const StudyTable& data, const recording::MotionOptions& options, const Eigen::Vector3d& driver) {
  const vehicle::DriveLog log = vehicle::read_drive_log(data);
  DrivenMotion drive{.name = log.inputs.empty() ? "drive" : log.inputs.front().filename().string(),
                     .inputs = log.inputs};
  const recording::RecordedMotion motion = recording::motion_samples(log.mapped.recording, options);
  const recording::DriveMotion channels = recording::drive_motion(log.mapped.recording);
  const recording::Consistency found = recording::check_consistency(channels);
  for (std::size_t i = 0; i < found.explanations.size(); ++i) {
    for (const recording::ChannelFault& f : found.explanations[i]) {
      // A leaning body and a road across are felt as they are.
      if (f.cause == estimation::Cause::kMissingTerm) continue;
      const std::vector<std::string> lines = correction_of(f, channels.names, log.mapped.origins);
      drive.notes.push_back(fmt::format(
          "{}: {}{}",
          found.is_sure() ? "wrong"
          : i == 0        ? "either"
                          : "or",
          f.says(channels.names), lines.empty() ? "" : fmt::format("; correct it by {}", fmt::join(lines, "; "))));
    }
  }
  for (const auto* notes : {&log.mapped.notes, &motion.notes})
    drive.notes.insert(drive.notes.end(), notes->begin(), notes->end());
  drive.samples = at_driver(motion.samples, driver);
  return drive;
}

/// The recorded drive, or one that is simulated.
DrivenMotion read_drive(const StudyTable& root, const recording::MotionOptions& options, const Eigen::Vector3d& driver,
                        Progress& progress) {
  if (root.has("data")) return recorded(root.table("data"), options, driver);
  if (!root.has("drive"))
    throw InputError(root.place("data"),
                     "is missing: name a recorded drive, or simulate one with [subject] and [drive]");
  const vehicle::SimulationStudy simulation = vehicle::read_simulation_study(root, progress);
  progress.stage(fmt::format("driving {:.0f} s of {}", simulation.simulation.duration, simulation.vehicle.name));
  const vehicle::SimulationRun driven = vehicle::run_simulation_study(simulation, progress);
  if (!driven.trajectory.usable()) throw std::runtime_error(driven.trajectory.message());
  const vehicle::FourWheelOptions& options_of = simulation.four_wheel;
  return {.name = fmt::format("{} of {}", to_string(simulation.manoeuvre.kind), simulation.vehicle.name),
          .samples = at_driver(vehicle::motion_samples(driven.trajectory, options_of.gravity,
                                                       options_of.longitudinal ? options_of.longitudinal->grade : 0.0),
                               driver),
          .inputs = simulation.inputs,
          .notes = simulation.vehicle.warnings};
}

std::vector<StudyAlgorithm> read_algorithms(const StudyTable& root, const StudyTable& cue, const CueTable& keys,
                                            const Platform& platform) {
  std::vector<StudyAlgorithm> algorithms;
  const std::vector<std::string>& names = keys.algorithms;
  if (names.empty()) cue.fail("algorithms", "names none");
  const StudyTable washouts = root.table_or_empty("washout");
  std::vector<std::string> known;
  for (const WashoutAlgorithm& a : washout_algorithms()) known.emplace_back(a.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      cue.fail("algorithms", fmt::format("there is no algorithm '{}'{}", name, suggestion(name, known)));
    StudyAlgorithm algorithm{name, washout_algorithm(name).design()};
    keys.settings.apply(*algorithm.design);
    read_knobs(washouts.table_or_empty(name), algorithm.design->knobs());
    static_cast<void>(algorithm.design->make(platform));  // refuses what cannot be made
    algorithms.push_back(std::move(algorithm));
  }
  // Numbers of algorithms that are not driven this time are read all the same: a misspelt one is refused.
  for (const std::string& name : known) {
    if (washouts.has(name) && std::find(names.begin(), names.end(), name) == names.end())
      read_knobs(washouts.table(name), washout_algorithm(name).design()->knobs());
  }
  return algorithms;
}

/// A lap that was recorded, with a note where it is not another one than the study's drives.
DrivenMotion read_lap(const StudyTable& cue, const CueingStudy& study) {
  if (study.vehicle.front().position_from == recording::Origin::kAbsent)
    cue.fail("lap", "is of no use: the drive has no positions (channels pos_x and pos_y)");
  DrivenMotion lap = recorded(cue.table("lap"), study.motion, study.driver);
  for (const std::filesystem::path& input : lap.inputs) {
    if (std::find(study.inputs.begin(), study.inputs.end(), input) != study.inputs.end())
      lap.notes.push_back(
          fmt::format("the lap {} is also driven or tuned on: what is foreseen there is too good to be true",
                      input.filename().string()));
  }
  return lap;
}

LapForesight foresight_of(const StudyTable& cue, const DrivenMotion& lap) {
  try {
    return LapForesight(lap.samples);
  } catch (const InputError& error) {
    cue.fail("lap", error.what());
  }
}

/// The model that goes with the driver's steering and pedals: `[cue.vehicle]`, or the simulated vehicle itself.
DriverForesight read_driver_foresight(const StudyTable& root, const StudyTable& cue, const CueingStudy& study) {
  const MotionSample& first = study.vehicle.front();
  if (first.steer_from == recording::Origin::kAbsent)
    cue.fail("foresee", "= 'driver' needs the road wheels' angle: map a channel to `steer`");
  if (first.speed_from == recording::Origin::kAbsent) cue.fail("foresee", "= 'driver' needs the channel `speed`");
  if (!cue.has("vehicle") && !(root.has("drive") && !root.has("data")))
    cue.fail("foresee", "= 'driver' needs a model of the vehicle: [cue.vehicle], with the keys of [subject]");
  const StudyTable table = cue.has("vehicle") ? cue.table("vehicle") : root.table("subject");
  return DriverForesight(vehicle::read_vehicle(table, vehicle::VehicleNeeds::kFourWheel));
}

/// What algorithms that plan ahead foresee from; neither: they let forces fade.
struct StudyForesight {
  std::optional<DrivenMotion> lap_drive;  ///< of `[cue.lap]`, also where the choice is another one
  std::optional<LapForesight> lap;
  std::optional<DriverForesight> driver;

  void give_to(WashoutDesign& design) const {
    if (lap) design.foresee_from(*lap);
    if (driver) design.foresee_from(*driver);
  }
};

StudyForesight read_foresight(const StudyTable& root, const StudyTable& cue, const CueTable& keys,
                              const CueingStudy& study) {
  using enum ForesightBy;
  const ForesightBy choice = keys.foresee.value_or(cue.has("lap") ? kLap : cue.has("vehicle") ? kDriver : kFade);
  if (choice == kLap && !cue.has("lap")) cue.fail("foresee", "= 'lap' needs a lap of the same track: [cue.lap]");
  // What is there is read, also where the choice is another one.
  StudyForesight foresight;
  if (cue.has("lap")) {
    foresight.lap_drive = read_lap(cue, study);
    foresight.lap = foresight_of(cue, *foresight.lap_drive);
  }
  if (cue.has("vehicle") || choice == kDriver) foresight.driver = read_driver_foresight(root, cue, study);
  if (choice != kLap) foresight.lap.reset();
  if (choice != kDriver) foresight.driver.reset();
  return foresight;
}

std::vector<MaskPoint> mask_points(const StudyTable& table, const MaskTable& keys) {
  const std::vector<double>& at = keys.frequency;
  if (at.size() < 2 || !std::is_sorted(at.begin(), at.end(), std::less_equal<>()))
    table.fail("frequency", "takes two frequencies at least, growing");
  std::vector<MaskPoint> points(at.size());
  const auto column = [&](const char* key, const std::vector<double>& values, double MaskPoint::*member) {
    if (!table.has(key)) return;
    if (values.size() != at.size())
      table.fail(key, fmt::format("has {} values for {} frequencies", values.size(), at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) points[i].*member = values[i];
  };
  column("frequency", at, &MaskPoint::frequency);
  column("least_gain", keys.least_gain, &MaskPoint::least_gain);
  column("most_gain", keys.most_gain, &MaskPoint::most_gain);
  column("least_phase", keys.least_phase, &MaskPoint::least_phase);
  column("most_phase", keys.most_phase, &MaskPoint::most_phase);
  return points;
}

ResponseStudy read_response(const StudyTable& table) {
  ResponseStudy r{.options = response_keys().read(table)};
  for (const StudyTable& of : table.tables("mask")) {
    const MaskTable mask = MaskTable::keys().read(of);
    r.mask[mask.cue] = mask_points(of, mask);
  }
  return r;
}

/// Whether the platform has an axis that renders the cue.
bool renders(const Platform& platform, Cue cue) {
  const PlatformLimits& l = platform.limits;
  if (cue == Cue::kSurge) return l[PlatformAxis::kSurge].moves() || l[PlatformAxis::kPitch].moves();
  if (cue == Cue::kSway) return l[PlatformAxis::kSway].moves() || l[PlatformAxis::kRoll].moves();
  return l[static_cast<PlatformAxis>(cue)].moves();
}

std::vector<std::string> described(WashoutDesign& design) {
  std::vector<std::string> all;
  for (const Knob& knob : design.knobs())
    all.push_back(fmt::format("{} = {:.4g} {}", knob.name, fmt::join(knob.values, ", "), knob.unit));
  return all;
}

/// All but the drive and what is foreseen of it.
CueingStudy read_rig(const StudyTable& root, const CueTable& keys) {
  CueingStudy s;
  s.title = root.text_or("title", "");
  s.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  s.platform = root.has("platform") ? Platform::read(root.table("platform")) : built_in_platform("three_axis");
  if (root.has("platform") && root.table("platform").has("file"))
    s.inputs.push_back(root.table("platform").file("file"));
  s.algorithms = read_algorithms(root, root.table_or_empty("cue"), keys, s.platform);
  s.perception = keys.perception;
  s.optimum = keys.optimum;
  s.knobs = keys.knobs;
  if (keys.reid_nahon) s.thresholds = reid_nahon_thresholds();
  if (root.has("omct")) s.response = read_response(root.table("omct"));
  s.motion = keys.motion;
  s.driver = keys.driver;
  return s;
}

}  // namespace

CueingStudy read_study_without_drive(const Study& study) {
  const StudyTable& root = study.root();
  const StudyTable cue = root.table_or_empty("cue");
  const CueTable keys = CueTable::keys().read(cue);
  CueingStudy s = read_rig(root, keys);
  if (keys.foresee.value_or(ForesightBy::kFade) != ForesightBy::kFade)
    cue.fail("foresee", "must be \"fade\": live, a lap and the driver's intentions are not known");
  for (const char* key : {"lap", "vehicle"}) {
    if (cue.has(key)) cue.fail(key, "needs a drive that is known; live, forces are foreseen by fade only");
  }
  if (root.has("tune")) root.fail("tune", "needs a drive that is known: tune on a recorded one first");
  return s;
}

CueingStudy read_study(const Study& study, Progress& progress) {
  const StudyTable& root = study.root();
  const StudyTable cue = root.table_or_empty("cue");
  const CueTable keys = CueTable::keys().read(cue);
  CueingStudy s = read_rig(root, keys);
  root.accept("live");  // of `veridyn cue --live`
  if (root.has("tune")) {
    const StudyTable tune = root.table("tune");
    s.tune = tuning_keys().read(tune);
    if (tune.has("data")) {
      DrivenMotion on = recorded(tune.table("data"), s.motion, s.driver);
      account_for(on, s);
      s.tune_on = std::move(on.samples);
    }
  }
  DrivenMotion drive = read_drive(root, s.motion, s.driver, progress);
  account_for(drive, s);
  s.drive = std::move(drive.name);
  s.vehicle = std::move(drive.samples);
  const StudyForesight foresight = read_foresight(root, cue, keys, s);
  if (foresight.lap_drive) account_for(*foresight.lap_drive, s);
  for (const StudyAlgorithm& a : s.algorithms) foresight.give_to(*a.design);
  return s;
}

namespace {

/// [s]
double duration_of(const std::vector<MotionSample>& drive) {
  return drive.empty() ? 0.0 : drive.back().time - drive.front().time;
}

/// What of the drive the platform cannot render, or not yet.
std::vector<std::string> notes_on_drive(const CueingStudy& study) {
  std::vector<std::string> notes;
  if (study.vehicle.size() < 2) return notes;
  double longest = 0.0;
  int gaps = 0;
  for (std::size_t k = 1; k < study.vehicle.size(); ++k) {
    const double step = study.vehicle[k].time - study.vehicle[k - 1].time;
    gaps += step > AxisGuard::kLongestStep ? 1 : 0;
    longest = std::max(longest, step);
  }
  if (gaps > 0)
    notes.push_back(fmt::format("{} gap{} longer than {:g} s, up to {:.2g} s: the platform stops in them", gaps,
                                gaps == 1 ? "" : "s", AxisGuard::kLongestStep, longest));
  const double duration = duration_of(study.vehicle);
  for (const StudyAlgorithm& a : study.algorithms) {
    double slowest = kInfinity;
    std::string name;
    for (const Knob& knob : a.design->knobs()) {
      if (knob.unit != "rad/s" || knob.name.ends_with("rate")) continue;
      for (const double omega : knob.values) {
        if (omega > 0.0 && omega < slowest) {
          slowest = omega;
          name = knob.name;
        }
      }
    }
    constexpr double kSettled = 4.6;  // time constants to a hundredth
    if (duration * slowest < kSettled)
      notes.push_back(
          fmt::format("{}: the drive lasts {:.3g} s, its slowest filter ({} = {:g} rad/s) settles in "
                      "{:.3g} s: the beginning weighs in the score",
                      a.name, duration, name, slowest, kSettled / slowest));
  }
  return notes;
}

}  // namespace

AlgorithmResult scored(const CueingStudy& study, CueingRun run, WashoutDesign& design) {
  AlgorithmResult a;
  a.run = std::move(run);
  a.felt = felt_motion(a.run, vestibular_model(study.perception), study.thresholds);
  a.score = score(a.run, a.felt, study.platform, study.seed);
  a.knobs = described(design);
  return a;
}

CueingResult cue(const CueingStudy& study, Progress& progress) {
  CueingResult result;
  result.notes = notes_on_drive(study);
  const VestibularModel& model = vestibular_model(study.perception);
  for (const StudyAlgorithm& of : study.algorithms) {
    std::unique_ptr<WashoutDesign> design = of.design->clone();
    std::optional<Tuning> tuning;
    if (study.tune) {
      progress.stage(fmt::format("tuning {}", of.name));
      tuning = tuned(*design, study.platform, study.tune_on.empty() ? study.vehicle : study.tune_on, model,
                     study.thresholds, *study.tune, progress);
      design = tuning->design->clone();
    }
    progress.stage(fmt::format("driving the platform with {}", of.name));
    const std::unique_ptr<Washout> washout = design->make(study.platform);
    CueingRun run = drive_platform(study.vehicle, *washout, study.platform, progress);
    run.algorithm = of.name;
    if (!run.account.empty()) result.notes.push_back(fmt::format("{}: {}", of.name, run.account));
    if (progress.interrupted()) {
      result.interrupted = true;
      return result;
    }
    AlgorithmResult a = scored(study, std::move(run), *design);
    a.tuning = std::move(tuning);
    if (study.knobs) {
      progress.stage(fmt::format("turning the knobs of {}", of.name));
      a.effects = knob_effects(*design, study.platform, model, study.thresholds);
    }
    for (const Cue which : kAllCues) {
      if (!study.response || !renders(study.platform, which)) continue;
      progress.stage(fmt::format("response of {} in {}", of.name, name_of(which)));
      a.response[which] = frequency_response(*washout, study.platform, which, study.response->options, progress);
      const auto mask = study.response->mask.find(which);
      if (mask != study.response->mask.end()) a.outside_mask[which] = outside(a.response[which], mask->second);
    }
    result.algorithms.push_back(std::move(a));
  }
  for (const Eigen::Index pair : {0, 1}) {
    if (!study.optimum || progress.interrupted() || !study.platform.limits[tilt_axis(pair)].moves()) continue;
    progress.stage(pair == 0 ? "least error in sway and roll" : "least error in surge and pitch");
    try {
      auto& least = result.least[pair];
      least = least_error(study.vehicle, study.platform, model, study.thresholds, pair);
      if (!least)
        result.notes.push_back(
            duration_of(study.vehicle) > kLongestForLeastError
                ? fmt::format("no least error: the drive is longer than {:g} s", kLongestForLeastError)
                : fmt::format("no least error in {}: its search did not end", pair == 0 ? "sway" : "surge"));
    } catch (const InputError& error) {
      result.notes.push_back(fmt::format("no least error: {}", error.what()));
    }
  }
  result.notes.erase(std::unique(result.notes.begin(), result.notes.end()), result.notes.end());
  result.interrupted = progress.interrupted();
  return result;
}

}  // namespace veridyn::cueing
