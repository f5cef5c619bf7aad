#include "veridyn/vehicle/tracking/drive_tracker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/recursive/tracking_evidence.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::ParameterStatus;

/// Rows a cut-off frequency: they are nearly independent then.
constexpr double kRowsPerCutoff = 4.0;
/// Standard deviations of the constants at the start: of rates [rad/s] and of the steering [rad].
constexpr double kRateConstant = 0.05;
constexpr double kSteerConstant = 0.03;
/// Standard deviation after a change, relative to the values at the start.
constexpr double kAfterChange = 1.0;
/// Share of a parameter in held directions from which it is said to be held.
constexpr double kHeldShare = 0.05;

double pass_band(const DriveTrackOptions& options, double rate_Hz) { return std::min(options.pass_Hz, 0.1 * rate_Hz); }

/// A stiffness of the estimate, where it is one to begin with.
const estimation::Parameter* usable(const estimation::Estimate* estimate, const char* name) {
  const estimation::Parameter* p = estimate == nullptr ? nullptr : estimate->find(name);
  const bool found = p != nullptr && p->value > 0.0 && std::isfinite(p->value) && p->sigma > 0.0 &&
                     std::isfinite(p->sigma) && p->status != ParameterStatus::kRejected &&
                     p->status != ParameterStatus::kNotExcited;
  return found ? p : nullptr;
}

/// Mass, a and b as given, I_z of the body, stiffnesses of the estimate where it has usable ones.
VehicleParameters<double> known_vehicle(const DriveTrackStart& start) {
  VehicleParameters<double> vehicle = start.vehicle;
  if (start.body.source != BodySource::kNone) {
    const double wheelbase = vehicle.wheelbase();
    vehicle.I_z = start.body.I_z;
    if (std::isfinite(start.body.a)) vehicle.a = start.body.a;
    vehicle.b = wheelbase - vehicle.a;
  }
  if (const estimation::Parameter* p = usable(start.estimate, "C_f")) vehicle.C_f = p->value;
  if (const estimation::Parameter* p = usable(start.estimate, "C_r")) vehicle.C_r = p->value;
  return vehicle;
}

/// Where an axle slips more than this share further than tyres without a limit would, a row of it says more of the
/// limit than of the stiffness.
constexpr double kMostSaturation = 0.3;

}  // namespace

DriveTrackOptions::DriveTrackOptions() {
  memory_s = 40.0;
  detection.learn_s = 25.0;
  watch_after_s = 10.0;
  detection.memory_s = 200.0;
  // Grip that falls to two thirds; what a tyre loses as it is driven harder is less than half of that.
  watch.share = 0.5;
  // Innovations of a car grow with how it is driven: neither their mean nor their spread is a sign of a change.
  watch_innovations = false;
  // Once in 1000 hours of driving: losses of grip are found soon enough with it.
  detection.false_alarm_interval_s = 3.6e6;
}

const KeyTable<DriveTrackOptions>& DriveTrackOptions::keys() {
  using O = DriveTrackOptions;
  static const auto table =
      KeyTable<O>("track", "How cornering stiffnesses are followed on line.")
          .with(estimation::TrackerOptions::keys())
          .number("pass_band", &O::pass_Hz, "Hz", kPositive,
                  "of the causal filters; lower ones remove more noise and are later")
          .number("start_sigma", &O::start_sigma, "1", kPositive,
                  "relative standard deviation of the subject's stiffnesses at the start")
          .number(
              "learning", &O::learning_s, "s", kNotNegative,
              "first part of the drive, from which lean and I_z are learned where no estimate gives them; 0: a body "
              "that does not lean, with the I_z of the subject")
          .file("estimate_file", &O::estimate_file, "`estimate.json` to start from")
          .was("estimate")
          .otherwise("the subject's C_f and C_r");
  return table;
}

DriveTracker::DriveTracker(const DriveTrackStart& start, const DriveTrackOptions& options, double min_speed_mps,
                           double rate_Hz, const std::array<double, 4>& noise)
    : start_(known_vehicle(start)),
      body_(start.body),
      options_(options),
      min_speed_(min_speed_mps),
      rate_Hz_(rate_Hz),
      noise_(noise),
      sigma_f_(options.start_sigma),
      sigma_r_(options.start_sigma),
      begin_text_("subject"),
      axle_rows_(start_, body_, start.sensor, rate_Hz, pass_band(options, rate_Hz)),
      stride_(std::max<std::size_t>(
          1, static_cast<std::size_t>(rate_Hz / (kRowsPerCutoff * pass_band(options, rate_Hz)) + 1e-9))) {
  for (const auto& [name, sigma] : {std::pair{"C_f", &sigma_f_}, std::pair{"C_r", &sigma_r_}}) {
    const estimation::Parameter* p = usable(start.estimate, name);
    if (p == nullptr) continue;
    *sigma = p->sigma / p->value;
    begin_text_ = "estimate";
  }
}

double DriveTracker::latency_s() const { return axle_rows_.latency_s(); }

const estimation::RegressionTracker& DriveTracker::regression(TrackedAxle axle) const {
  VERIDYN_ASSERT(started());
  return trackers_[static_cast<std::size_t>(axle)];
}

const DriveTrackHistory& DriveTracker::history(TrackedAxle axle) const { return history_[axle]; }

double DriveTracker::begin_value(TrackedAxle axle) const {
  return axle == TrackedAxle::kFront  ? start_.C_f
         : axle == TrackedAxle::kRear ? start_.C_r
                                      : understeer_gradient(start_);
}

double DriveTracker::begin_sigma(TrackedAxle axle) const {
  if (axle == TrackedAxle::kFront) return sigma_f_ * start_.C_f;
  if (axle == TrackedAxle::kRear) return sigma_r_ * start_.C_r;
  const double gain = 0.5 * start_.mass / start_.wheelbase();
  return gain * std::hypot(sigma_f_ * start_.b / start_.C_f, sigma_r_ * start_.a / start_.C_r);
}

/// Parameters are followed in units of these, so that all are of order one: a held one then stays where it is instead
/// of moving in place of a constant.
double DriveTracker::scale(TrackedAxle axle) const {
  if (axle == TrackedAxle::kFront) return start_.C_f;
  if (axle == TrackedAxle::kRear) return start_.C_r;
  return axle_rows_.understeer_scale();
}

double DriveTracker::value(TrackedAxle axle) const {
  if (!started()) return begin_value(axle);
  const double theta = regression(axle).regression().theta()(0);
  return axle == TrackedAxle::kUndersteer ? theta * scale(axle) : scale(axle) / theta;
}

double DriveTracker::followed_sigma(TrackedAxle axle) const {
  const estimation::RecursiveRegression& r = regression(axle).regression();
  if (!r.usable()) return kInfinity;
  const double theta = r.theta()(0);
  return scale(axle) * (axle == TrackedAxle::kUndersteer ? r.sigma()(0) : r.sigma()(0) / (theta * theta));
}

double DriveTracker::body_sigma(TrackedAxle axle) const {
  const auto i = static_cast<std::size_t>(axle);
  if (axle == TrackedAxle::kUndersteer) return body_.sigma[i];
  // Where grip has changed, friction may have changed with stiffness, as is assumed, or not.
  const double saturation = force_power_[i] > 0.0 ? saturated_power_[i] / force_power_[i] : 0.0;
  return std::abs(value(axle)) * std::hypot(body_.sigma[i], saturation * (1.0 - grip_[i]));
}

double DriveTracker::sigma(TrackedAxle axle) const {
  if (!started()) return begin_sigma(axle);
  return std::hypot(followed_sigma(axle), body_sigma(axle));
}

void DriveTracker::begin(double speed) {
  estimation::TrackerOptions options = options_;
  // The stated rate of false alarms is that of both axles together.
  options.detection.false_alarm_interval_s *= 2.0;
  options.detection.block_s = std::max(options.detection.block_s, 1.0 / row_rate_Hz());
  const auto add = [&](TrackedAxle axle, std::vector<std::string> names, const Eigen::VectorXd& theta,
                       const Eigen::VectorXd& sigma) {
    estimation::TrackerOptions own = options;
    // An understeer gradient may be any share of its unit, or none: there is no share by which it changes.
    if (axle == TrackedAxle::kUndersteer) own.watch.share = 0.0;
    trackers_.emplace_back(std::move(names), axle_rows_.noise_covariance(axle, noise_, speed), own, row_rate_Hz());
    trackers_.back().start(theta, sigma.cwiseAbs2().asDiagonal(), 0.0, 0.0);
  };
  add(TrackedAxle::kFront, {"C_f0/C_f", "constant"}, Eigen::Vector2d(1.0, 0.0),
      Eigen::Vector2d(sigma_f_, kRateConstant));
  add(TrackedAxle::kRear, {"C_r0/C_r", "constant"}, Eigen::Vector2d(1.0, 0.0),
      Eigen::Vector2d(sigma_r_, kRateConstant));
  const double K_0 = scale(TrackedAxle::kUndersteer);
  add(TrackedAxle::kUndersteer, {"understeer_gradient/K_0", "yaw_lag/T_0", "constant"},
      Eigen::Vector3d(understeer_gradient(start_) / K_0, 1.0, 0.0),
      Eigen::Vector3d(begin_sigma(TrackedAxle::kUndersteer) / K_0, std::max(sigma_f_, sigma_r_), kSteerConstant));
}

/// The road's grip is that of the stiffnesses now over those that the body was known with.
void DriveTracker::follow_grip() {
  if (is_linear(body_.tyres)) return;
  constexpr double kLeastGrip = 0.2, kMostGrip = 2.0;
  const std::array known = stiffnesses_of(body_.tyres);
  for (const TrackedAxle axle : {TrackedAxle::kFront, TrackedAxle::kRear}) {
    const estimation::RecursiveRegression& r = regression(axle).regression();
    if (!r.usable() || r.excited_directions() < r.parameters()) continue;
    const auto i = static_cast<std::size_t>(axle);
    grip_[i] = std::clamp(value(axle) / known[i], kLeastGrip, kMostGrip);
  }
  axle_rows_.set_grip(grip_);
}

void DriveTracker::weigh_saturation(const AxleRowSet& rows) {
  const double lambda = options_.forgetting_at(row_rate_Hz()).lambda;
  for (std::size_t i = 0; i < 2; ++i) {
    const double power = rows.force[i] * rows.force[i];
    force_power_[i] = lambda * force_power_[i] + power;
    saturated_power_[i] = lambda * saturated_power_[i] + power * rows.saturation[i];
  }
}

void DriveTracker::take_rows(std::vector<DriveChange>& found) {
  if (!started()) begin(axle_rows_.speed());
  follow_grip();
  const AxleRowSet rows = axle_rows_.rows();
  weigh_saturation(rows);
  const auto feed = [&](TrackedAxle axle, std::span<const double> x, double z) {
    if (auto change = trackers_[static_cast<std::size_t>(axle)].update(rows.time, x, z)) {
      // Of the stiffness, whose inverse is followed.
      if (change->kind == estimation::ChangeKind::kParameter) change->shift = 1.0 / (1.0 + change->shift) - 1.0;
      changes_.push_back({axle, *change});
      found.push_back(changes_.back());
    }
  };
  if (rows.saturation[0] < kMostSaturation) feed(TrackedAxle::kFront, rows.front.x, rows.front.z);
  if (rows.saturation[1] < kMostSaturation) feed(TrackedAxle::kRear, rows.rear.x, rows.rear.z);
  feed(TrackedAxle::kUndersteer, rows.understeer.x, rows.understeer.z);
  if (!found.empty()) {
    // The road or the tyres are not what they were: what was learned of them is forgotten, by all three.
    trackers_[0].restart(Eigen::Vector2d(kAfterChange, kRateConstant));
    trackers_[1].restart(Eigen::Vector2d(kAfterChange, kRateConstant));
    trackers_[2].restart(Eigen::Vector3d(kAfterChange, kAfterChange, kSteerConstant));
    force_power_ = saturated_power_ = {};
  }
  ++rows_;
  if (rows.time >= next_history_ - 1e-9) remember(rows.time);
}

void DriveTracker::remember(double time) {
  next_history_ = std::max(next_history_ + 1.0 / options_.history_Hz, time);
  if (!std::isfinite(next_history_)) next_history_ = time + 1.0 / options_.history_Hz;
  for (const TrackedAxle axle : kAllTrackedAxles) {
    const estimation::RegressionTracker& tracker = regression(axle);
    const estimation::RecursiveRegression& r = tracker.regression();
    DriveTrackHistory& to = history_[axle];
    to.time.push_back(time);
    to.value.push_back(value(axle));
    to.sigma.push_back(sigma(axle));
    const auto& share = r.unexcited_share();
    to.held.push_back(!r.usable() || (share.size() > 0 && share(0) > kHeldShare));
    to.suspicion.push_back(tracker.suspicion());
  }
}

std::vector<DriveChange> DriveTracker::append(const DriveSample& s) {
  std::vector<DriveChange> found;
  last_ = s.time;
  if (s.speed < min_speed_) axle_rows_.empty();
  if (s.speed < min_speed_ || !axle_rows_.append(s)) {
    since_row_ = 0;
    return found;
  }
  if (since_row_ == 0) take_rows(found);
  since_row_ = since_row_ + 1 == stride_ ? 0 : since_row_ + 1;
  return found;
}

namespace {

estimation::Evidence body_row(const KnownBody& body) {
  const bool known = body.source != BodySource::kNone;
  estimation::Evidence row = estimation::row_of(
      estimation::Check::kBodyLean, "", estimation::passed_or(known && body.accepted, estimation::Outcome::kCare));
  if (!known) row.cause = estimation::Cause::kMissing;
  row.value = deg_per_g(body.roll.gradient);
  return std::move(row).with("relaxation_length", body.relaxation_length);
}

}  // namespace

estimation::Estimate DriveTracker::estimate(const std::string& subject,
                                            std::span<const estimation::Evidence> recording) const {
  estimation::Estimate out;
  out.subject = subject;
  out.method = fmt::format("{} on line", estimation::to_string(options_.method));
  out.covariance =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(kTrackedAxles), static_cast<Eigen::Index>(kTrackedAxles));
  std::vector<std::string> followed, held;
  EnumArray<TrackedAxle, std::vector<estimation::Evidence>, kTrackedAxles> of_axle;
  for (const TrackedAxle axle : kAllTrackedAxles) {
    const double v = value(axle);
    estimation::Parameter p{.name = std::string(kTrackedAxleNames[axle]),
                            .value = v,
                            .sigma = sigma(axle),
                            .unit = std::string(kTrackedAxleUnits[axle]),
                            .status = ParameterStatus::kNotExcited};
    double half = numerics::kNormal95;  // of the 95 % interval [sigma]
    if (started()) {
      const estimation::RegressionTracker& tracker = regression(axle);
      const estimation::RecursiveRegression& r = tracker.regression();
      p.status = r.status(0);
      // In units of the start's value, or its inverse: a relative error is the same in both.
      const estimation::RegressionEstimate regression = tracker.estimate();
      const estimation::Parameter& q = regression.parameters[0];
      const double factor = q.sigma / r.sigma()(0);
      if (factor > 1.0 && std::isfinite(factor)) p.sigma = std::hypot(factor * followed_sigma(axle), body_sigma(axle));
      if (q.sigma > 0.0) half = (q.high95 - q.value) / q.sigma;
      of_axle[axle] = estimation::tracking_evidence(p.name, tracker, regression);
      out.fit[p.name + ".residual_sd"] = r.residual_sd();
      out.fit[p.name + ".samples"] = r.effective_samples();
      const bool is_held = !history_[axle].held.empty() && history_[axle].held.back();
      if (is_held) p.status = ParameterStatus::kNotExcited;
      (is_held ? held : followed).push_back(p.name);
    }
    p.low95 = v - half * p.sigma;
    p.high95 = v + half * p.sigma;
    const auto at = static_cast<Eigen::Index>(axle);
    out.covariance(at, at) = p.sigma * p.sigma;
    out.parameters.push_back(std::move(p));
  }
  std::vector<estimation::Evidence> of_all(recording.begin(), recording.end());
  if (started()) of_all.insert(of_all.begin(), body_row(body_));
  if (body_.source == BodySource::kNone && !body_.text.empty()) out.warnings.push_back(body_.text);
  out.verdict =
      started() ? fmt::format("followed: {}; started from the {}",
                              followed.empty() ? "nothing" : fmt::format("{}", fmt::join(followed, ", ")), begin_text_)
                : "nothing was followed: no stretch without holes is as long as the filter";
  std::vector<estimation::Judgement> parts;
  for (const TrackedAxle axle : kAllTrackedAxles) {
    estimation::Parameter& p = out.parameters[static_cast<std::size_t>(axle)];
    std::vector<estimation::Evidence>& rows = of_axle[axle];
    if (started()) std::ranges::move(plausibility({&p, 1}, start_), std::back_inserter(rows));
    out.evidence.insert(out.evidence.end(), rows.begin(), rows.end());
    rows.insert(rows.end(), of_all.begin(), of_all.end());
    parts.push_back(estimation::judge(rows));
    if (started()) p = estimation::marked({p}, estimation::verdict_of(parts.back())).front();
  }
  out.evidence.insert(out.evidence.end(), of_all.begin(), of_all.end());
  if (started()) out.judgement = estimation::judge_together(parts);
  if (!held.empty()) out.verdict += fmt::format("; held at the end, because not excited: {}", fmt::join(held, ", "));
  return out;
}

}  // namespace veridyn::vehicle
