#include "bench/reproduction/cueing/cueing_reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "bench/reproduction/cueing/experiments.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/cueing/score/frequency_response.hpp"
#include "veridyn/cueing/washout/classical_washout.hpp"
#include "veridyn/cueing/washout/shoarai_washout.hpp"

namespace veridyn::cueing {
namespace {

/// Runs that several figures and the curves of a study show, each computed when it is asked for first.
class Runs {
 public:
  const Experiment& ramp_about(PlatformAxis axis) {
    std::optional<Experiment>& run = axis == PlatformAxis::kPitch ? ramp_pitch_ : ramp_roll_;
    if (!run) run = ramp(axis);
    return *run;
  }
  const Experiment& track() {
    if (!track_) track_ = level_track();
    return *track_;
  }

 private:
  std::optional<Experiment> ramp_pitch_, ramp_roll_, track_;
};

/// Something that a study may compare.
struct Quantity {
  const char* name;
  const char* at;    ///< unit of what it depends on; empty: nothing
  const char* unit;  ///< SI
  const char* text;  ///< how it is printed
  std::function<double(double at, Runs& runs)> value;
};

double largest(const Experiment& e, std::size_t curve) {
  double most = 0.0;
  for (const double v : e.curves[curve].values) most = std::max(most, std::abs(v));
  return most;
}

/// After this many steps of the input that the program's own test holds.
ShoaraiWashout::Pose golden(double steps, bool gravity_from_zero) {
  ShoaraiSettings settings;
  settings.gravity_from_zero = gravity_from_zero;
  ShoaraiWashout washout(settings);
  ShoaraiWashout::Pose pose;
  for (int k = 0; k < static_cast<int>(std::lround(steps)); ++k)
    pose = washout.step(1e-3 * Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(4.0, 5.0, 6.0));
  return pose;
}

/// Of the classical algorithm through the whole chain, on a platform that is at once where it is ordered to be.
ResponsePoint response(Cue cue, double frequency) {
  Platform platform = built_in_platform("ideal");
  platform.rider.setZero();
  ResponseOptions options;
  options.frequencies = {frequency};
  options.step = 0.001;  // the guard is a sample behind
  // So small that neither the arcsine nor a limit is seen.
  options.force = 0.01;
  options.rate = 0.01 * kDegree;
  return frequency_response(ClassicalWashout(ClassicalDesign{}), platform, cue, options, Progress{}).front();
}

std::span<const Quantity> quantities() {
  using enum PlatformAxis;
  static const std::vector<Quantity> all = {
      {"pitch_reached", "rad", "rad", "pitch reached when ordered", [](double x, Runs&) { return reached(kPitch, x); }},
      {"roll_reached", "rad", "rad", "roll reached when ordered", [](double x, Runs&) { return reached(kRoll, x); }},
      {"pitch_held", "m/s^2", "rad", "pitch held under a force of",
       [](double x, Runs&) { return held_tilt(kPitch, x); }},
      {"roll_held", "m/s^2", "rad", "roll held under a force of", [](double x, Runs&) { return held_tilt(kRoll, x); }},
      {"tilt_wanted", "m/s^2", "rad", "tilt that stands for", [](double x, Runs&) { return std::asin(x / kGravity); }},
      {"chassis_pitch", "1", "rad", "pitch of a chassis at 15 deg, reference",
       [](double x, Runs&) { return reached(kPitch, 15.0 * kDegree * x / 20.0); }},
      {"ramp_pitch_with", "", "rad", "largest pitch on the ramp, with washout",
       [](double, Runs& runs) { return largest(runs.ramp_about(kPitch), 1); }},
      {"ramp_pitch_without", "", "rad", "largest pitch on the ramp, without",
       [](double, Runs& runs) { return largest(runs.ramp_about(kPitch), 2); }},
      {"ramp_roll_with", "", "rad", "largest roll on the ramp, with washout",
       [](double, Runs& runs) { return largest(runs.ramp_about(kRoll), 1); }},
      {"ramp_roll_without", "", "rad", "largest roll on the ramp, without",
       [](double, Runs& runs) { return largest(runs.ramp_about(kRoll), 2); }},
      {"level_track_naive", "", "rad", "largest false pitch, accelerometer alone",
       [](double, Runs& runs) { return largest(runs.track(), 0); }},
      {"level_track_camera", "", "rad", "largest false pitch, with the camera",
       [](double, Runs& runs) { return largest(runs.track(), 1); }},
      {"threshold_roll", "", "rad/s", "threshold of roll", [](double, Runs&) { return usual_thresholds().rate[0]; }},
      {"threshold_pitch", "", "rad/s", "threshold of pitch", [](double, Runs&) { return usual_thresholds().rate[1]; }},
      {"threshold_yaw", "", "rad/s", "threshold of yaw", [](double, Runs&) { return usual_thresholds().rate[2]; }},
      {"threshold_surge", "", "m/s^2", "threshold of surge", [](double, Runs&) { return usual_thresholds().force[0]; }},
      {"threshold_sway", "", "m/s^2", "threshold of sway", [](double, Runs&) { return usual_thresholds().force[1]; }},
      {"threshold_heave", "", "m/s^2", "threshold of heave", [](double, Runs&) { return usual_thresholds().force[2]; }},
      {"shoarai_surge", "1", "m", "shoarai/washout, surge at step",
       [](double x, Runs&) { return golden(x, true).shift.x(); }},
      {"shoarai_heave", "1", "m", "shoarai/washout, heave at step",
       [](double x, Runs&) { return golden(x, true).shift.z(); }},
      {"shoarai_roll", "1", "rad", "shoarai/washout, roll at step",
       [](double x, Runs&) { return golden(x, true).angle.x(); }},
      {"shoarai_heave_corrected", "1", "m", "the same with gravity from the start, heave at step",
       [](double x, Runs&) { return golden(x, false).shift.z(); }},
      {"surge_gain", "rad/s", "1", "gain of surge at", [](double x, Runs&) { return response(Cue::kSurge, x).gain; }},
      {"surge_phase", "rad/s", "rad", "phase of surge at",
       [](double x, Runs&) { return response(Cue::kSurge, x).phase; }},
      {"heave_gain", "rad/s", "1", "gain of heave at", [](double x, Runs&) { return response(Cue::kHeave, x).gain; }},
      {"pitch_gain", "rad/s", "1", "gain of pitch at", [](double x, Runs&) { return response(Cue::kPitch, x).gain; }},
      {"pitch_phase", "rad/s", "rad", "phase of pitch at",
       [](double x, Runs&) { return response(Cue::kPitch, x).phase; }},
  };
  return all;
}

const Quantity& quantity_of(const StudyTable& table) {
  const std::string name = table.text("quantity");
  std::vector<std::string> names;
  for (const Quantity& q : quantities()) {
    if (name == q.name) return q;
    names.emplace_back(q.name);
  }
  table.fail("quantity", fmt::format("there is none called '{}'{}", name, suggestion(name, names)));
}

/// The unit of a text such as "18.5 deg"; the SI one of a plain number.
Unit unit_of(const StudyTable& table, const char* si) {
  std::string text;
  try {
    text = table.text("value");
  } catch (const InputError&) {
    return parse_unit(si);  // a number
  }
  const std::size_t blank = text.find(' ');
  return blank == std::string::npos ? parse_unit(si) : parse_unit_like(text.substr(blank + 1), parse_unit(si));
}

ReproducedFigure read_figure(const StudyTable& table, Runs& runs) {
  const Quantity& q = quantity_of(table);
  static const std::vector<std::string> kOrigins = {"printed", "derived", "computed"};
  const Unit unit = unit_of(table, q.unit);
  ReproducedFigure f{.quantity = q.text, .origin = table.choice_or("origin", kOrigins, "printed"), .unit = unit.name};
  double at = 0.0;
  if (*q.at != '\0') {
    at = table.number("at", q.at);
    const std::string_view kind = q.at;
    f.quantity += kind == "rad" ? fmt::format(" {:g} deg", at / kDegree)
                  : kind == "1" ? fmt::format(" {:g}", at)
                                : fmt::format(" {:g} {}", at, kind);
  }
  f.published = unit.from_si(table.number("value", q.unit));
  f.within = table.positive("within", q.unit) / unit.scale;
  f.ours = unit.from_si(q.value(at, runs));
  return f;
}

}  // namespace

bool ReproducedFigure::passed() const { return std::abs(ours - published) <= within; }

bool CueingReproduction::passed() const {
  return std::all_of(figures.begin(), figures.end(), [](const ReproducedFigure& f) { return f.passed(); });
}

CueingReproduction reproduce_cueing(const StudyTable& root, Progress& progress) {
  CueingReproduction r;
  r.title = root.text("title");
  r.finding = root.text_or("finding", "");
  r.how = root.text_or("how", "");
  progress.stage(r.title);
  const std::vector<std::string> pictures = {"none", "ramp_pitch", "ramp_roll", "level_track"};
  const std::string picture = root.choice_or("curves", pictures, "none");
  Runs runs;
  for (const StudyTable& table : root.tables("figure")) {
    r.interrupted = progress.interrupted();
    if (r.interrupted) return r;
    r.figures.push_back(read_figure(table, runs));
  }
  if (picture == "none") return r;
  const Experiment& e = picture == "level_track"
                            ? runs.track()
                            : runs.ramp_about(picture == "ramp_roll" ? PlatformAxis::kRoll : PlatformAxis::kPitch);
  r.time = e.time;
  for (const Experiment::Curve& curve : e.curves) {
    r.curves.push_back({curve.name, "deg", curve.values});
    for (double& v : r.curves.back().values) v /= kDegree;
  }
  return r;
}

}  // namespace veridyn::cueing
