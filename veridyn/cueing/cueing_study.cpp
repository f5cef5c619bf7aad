#include "veridyn/cueing/cueing_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/washout/driver_foresight.hpp"
#include "veridyn/cueing/washout/driver_settings.hpp"
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

Eigen::Vector3d place(const StudyTable& table, std::string_view key) {
  if (!table.has(key)) return Eigen::Vector3d::Zero();
  const std::vector<double> v = table.numbers(key, "m");
  if (v.size() != 3) table.fail(key, fmt::format("has {} numbers; takes forward, left, up", v.size()));
  return {v[0], v[1], v[2]};
}

recording::MotionOptions motion_options(const StudyTable& cue) {
  recording::MotionOptions o{.place = place(cue, "sensor")};
  const std::vector<std::string> choices = {"in", "out", "decide"};
  const std::string gravity = cue.choice_or("gravity", choices, "decide");
  if (gravity == "in") o.gravity = recording::GravityIn::kYes;
  if (gravity == "out") o.gravity = recording::GravityIn::kNo;
  return o;
}

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

std::vector<StudyAlgorithm> read_algorithms(const StudyTable& root, const StudyTable& cue, const Platform& platform) {
  std::vector<StudyAlgorithm> algorithms;
  const DriverSettings settings = DriverSettings::read(cue);
  const std::vector<std::string> names =
      cue.has("algorithms") ? cue.texts("algorithms") : std::vector<std::string>{"classical"};
  if (names.empty()) cue.fail("algorithms", "names none");
  const StudyTable washouts = root.table_or_empty("washout");
  std::vector<std::string> known;
  for (const WashoutAlgorithm& a : washout_algorithms()) known.emplace_back(a.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      cue.fail("algorithms", fmt::format("there is no algorithm '{}'{}", name, suggestion(name, known)));
    StudyAlgorithm algorithm{name, washout_algorithm(name).design()};
    settings.apply(*algorithm.design);
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

StudyForesight read_foresight(const StudyTable& root, const StudyTable& cue, const CueingStudy& study) {
  const std::vector<std::string> choices = {"fade", "lap", "driver"};
  const std::string usual = cue.has("lap") ? "lap" : cue.has("vehicle") ? "driver" : "fade";
  const std::string choice = cue.choice_or("foresee", choices, usual);
  if (choice == "lap" && !cue.has("lap")) cue.fail("foresee", "= 'lap' needs a lap of the same track: [cue.lap]");
  // What is there is read, also where the choice is another one.
  StudyForesight foresight;
  if (cue.has("lap")) {
    foresight.lap_drive = read_lap(cue, study);
    foresight.lap = foresight_of(cue, *foresight.lap_drive);
  }
  if (cue.has("vehicle") || choice == "driver") foresight.driver = read_driver_foresight(root, cue, study);
  if (choice != "lap") foresight.lap.reset();
  if (choice != "driver") foresight.driver.reset();
  return foresight;
}

Cue read_cue(const StudyTable& table) {
  std::vector<std::string> names;
  for (const Cue cue : kAllCues) names.emplace_back(name_of(cue));
  const std::string name = table.choice_or("cue", names, names.front());
  return static_cast<Cue>(std::find(names.begin(), names.end(), name) - names.begin());
}

ResponseStudy read_response(const StudyTable& table) {
  ResponseStudy r;
  r.options.force = table.positive_or("force", "m/s^2", r.options.force);
  r.options.rate = table.positive_or("rate", "rad/s", r.options.rate);
  if (table.has("frequencies")) {
    r.options.frequencies = table.numbers("frequencies", "rad/s");
    for (const double f : r.options.frequencies) {
      if (!(f > 0.0 && f <= 50.0))
        table.fail("frequencies", fmt::format("holds {}; takes more than 0 and up to 50 rad/s", f));
    }
  }
  for (const StudyTable& of : table.tables("mask")) {
    const std::vector<double> at = of.numbers("frequency", "rad/s");
    std::vector<MaskPoint> points(at.size());
    const auto column = [&](const char* key, const char* unit, double MaskPoint::*member) {
      if (!of.has(key)) return;
      const std::vector<double> values = of.numbers(key, unit);
      if (values.size() != at.size())
        of.fail(key, fmt::format("has {} values for {} frequencies", values.size(), at.size()));
      for (std::size_t i = 0; i < at.size(); ++i) points[i].*member = values[i];
    };
    for (std::size_t i = 0; i < at.size(); ++i) points[i].frequency = at[i];
    if (at.size() < 2 || !std::is_sorted(at.begin(), at.end(), std::less_equal<>()))
      of.fail("frequency", "takes two frequencies at least, growing");
    column("least_gain", "1", &MaskPoint::least_gain);
    column("most_gain", "1", &MaskPoint::most_gain);
    column("least_phase", "rad", &MaskPoint::least_phase);
    column("most_phase", "rad", &MaskPoint::most_phase);
    r.mask[read_cue(of)] = points;
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

}  // namespace

namespace {

/// All but the drive and what is foreseen of it.
CueingStudy read_rig(const StudyTable& root) {
  CueingStudy s;
  s.title = root.text_or("title", "");
  s.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  const StudyTable cue = root.table_or_empty("cue");
  s.platform = root.has("platform") ? Platform::read(root.table("platform")) : built_in_platform("three_axis");
  if (root.has("platform") && root.table("platform").has("file"))
    s.inputs.push_back(root.table("platform").file("file"));
  s.algorithms = read_algorithms(root, cue, s.platform);
  std::vector<std::string> models;
  for (const VestibularModel& m : vestibular_models()) models.push_back(m.name);
  s.perception = cue.choice_or("perception", models, s.perception);
  s.optimum = cue.flag_or("optimum", true);
  s.knobs = cue.flag_or("knobs", false);
  const std::vector<std::string> thresholds = {"usual", "reid_nahon"};
  if (cue.choice_or("thresholds", thresholds, "usual") == "reid_nahon") s.thresholds = reid_nahon_thresholds();
  if (root.has("omct")) s.response = read_response(root.table("omct"));
  s.motion = motion_options(cue);
  s.driver = place(cue, "driver");
  return s;
}

}  // namespace

CueingStudy read_study_without_drive(const Study& study) {
  const StudyTable& root = study.root();
  const StudyTable cue = root.table_or_empty("cue");
  CueingStudy s = read_rig(root);
  const std::vector<std::string> choices = {"fade"};
  static_cast<void>(cue.choice_or("foresee", choices, "fade"));
  for (const char* key : {"lap", "vehicle"}) {
    if (cue.has(key)) cue.fail(key, "needs a drive that is known; live, forces are foreseen by fade only");
  }
  if (root.has("tune")) root.fail("tune", "needs a drive that is known: tune on a recorded one first");
  return s;
}

CueingStudy read_study(const Study& study, Progress& progress) {
  const StudyTable& root = study.root();
  const StudyTable cue = root.table_or_empty("cue");
  CueingStudy s = read_rig(root);
  root.accept("live");  // of `veridyn cue --live`
  if (root.has("tune")) {
    const StudyTable tune = root.table("tune");
    s.tune.emplace();
    const long long evaluations = tune.integer_or("evaluations", static_cast<long long>(s.tune->evaluations));
    if (evaluations < 1) tune.fail("evaluations", fmt::format("is {}; must be above 0", evaluations));
    s.tune->evaluations = static_cast<std::size_t>(evaluations);
    s.tune->strength = tune.positive_or("strength", "1", s.tune->strength);
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
  const StudyForesight foresight = read_foresight(root, cue, s);
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
