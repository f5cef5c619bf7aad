#include "veridyn/vehicle/tracking/drive_tracker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/analysis.hpp"
#include "veridyn/estimation/recursive/tracking_evidence.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::ParameterStatus;
using numerics::FirKernel;

/// Rows a cut-off frequency: they are nearly independent then.
constexpr double kRowsPerCutoff = 4.0;
/// Standard deviations of the constants at the start: of rates [rad/s] and of the steering [rad].
constexpr double kRateConstant = 0.05;
constexpr double kSteerConstant = 0.03;
/// Standard deviation after a change, relative to the values at the start.
constexpr double kAfterChange = 1.0;
/// Share of a parameter in held directions from which it is said to be held.
constexpr double kHeldShare = 0.05;

/// What the ring keeps of every sample.
enum Column : std::size_t { kDelta, kCurvature, kAccel, kSpeedAccel, kSpeedYaw, kSpeedSteer, kYawRate, kSpeedColumn };

/// Noise of a row [x..., z] from white noise of the sensors.
class NoiseTerms {
 public:
  NoiseTerms(std::size_t columns, const std::array<double, 4>& noise, std::size_t taps) : noise_(noise) {
    for (Eigen::MatrixXd& t : taps_)
      t = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(taps), static_cast<Eigen::Index>(columns));
  }
  void add(Eigen::Index column, std::size_t source, double coefficient, const FirKernel& kernel) {
    taps_[source].col(column) += coefficient * Eigen::Map<const Eigen::VectorXd>(
                                                   kernel.taps.data(), static_cast<Eigen::Index>(kernel.taps.size()));
  }
  [[nodiscard]] Eigen::MatrixXd covariance() const {
    const Eigen::Index n = taps_[0].cols();
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < taps_.size(); ++i) W += noise_[i] * noise_[i] * taps_[i].transpose() * taps_[i];
    // Without noise there is still rounding.
    W(n - 1, n - 1) += 1e-16;
    return W;
  }

 private:
  std::array<double, 4> noise_;
  std::array<Eigen::MatrixXd, 4> taps_;
};
constexpr std::size_t kSteerNoise = 0, kSpeedNoise = 1, kYawNoise = 2, kAccelNoise = 3;

}  // namespace

DriveTrackOptions::DriveTrackOptions() {
  memory_s = 40.0;
  // Shorter than half a period of quick steering, whose innovations would cancel within a block; what correlation the
  // overlap of the filters leaves between blocks the detector follows.
  detection.block_s = 0.2;
  detection.learn_s = 25.0;
  watch_against_W = true;
  watch_after_s = 10.0;
  detection.memory_s = 200.0;
}

DriveTrackOptions DriveTrackOptions::read(const StudyTable& table) {
  DriveTrackOptions o;
  o.read_keys(table);
  o.pass_Hz = table.positive_or("pass_band", "Hz", o.pass_Hz);
  o.start_sigma = table.positive_or("start_sigma", "1", o.start_sigma);
  const std::string_view estimate = table.renamed("estimate_file", "estimate");
  if (table.has(estimate)) o.estimate_file = table.file(estimate).string();
  return o;
}

DriveTracker::DriveTracker(const VehicleParameters<double>& start, const DriveTrackOptions& options,
                           double min_speed_mps, double rate_Hz, const std::array<double, 4>& noise,
                           const estimation::Estimate* estimate)
    : start_(start),
      options_(options),
      min_speed_(min_speed_mps),
      rate_Hz_(rate_Hz),
      noise_(noise),
      sigma_f_(options.start_sigma),
      sigma_r_(options.start_sigma),
      begin_text_("subject"),
      kernel_(numerics::modulating_kernel(rate_Hz, std::min(options.pass_Hz, 0.1 * rate_Hz))) {
  const double pass = std::min(options.pass_Hz, 0.1 * rate_Hz);
  stride_ = std::max<std::size_t>(1, static_cast<std::size_t>(rate_Hz / (kRowsPerCutoff * pass) + 1e-9));
  ring_.resize(kernel_.smooth.taps.size());
  if (estimate == nullptr) return;
  const auto take = [&](const char* name, double& value, double* sigma) {
    const estimation::Parameter* p = estimate->find(name);
    const bool usable = p != nullptr && p->value > 0.0 && std::isfinite(p->value) && p->sigma > 0.0 &&
                        std::isfinite(p->sigma) && p->status != ParameterStatus::kRejected &&
                        p->status != ParameterStatus::kNotExcited;
    if (!usable) return;
    value = p->value;
    if (sigma != nullptr) *sigma = p->sigma / p->value;
    begin_text_ = "estimate";
  };
  take("C_f", start_.C_f, &sigma_f_);
  take("C_r", start_.C_r, &sigma_r_);
  take("I_z", start_.I_z, nullptr);
}

double DriveTracker::latency_s() const { return static_cast<double>(kernel_.smooth.half_width()) / rate_Hz_; }

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
  return 0.5 * start_.mass / start_.wheelbase() * (start_.b / start_.C_f + start_.a / start_.C_r);
}

double DriveTracker::value(TrackedAxle axle) const {
  if (!started()) return begin_value(axle);
  const double theta = regression(axle).regression().theta()(0);
  return axle == TrackedAxle::kUndersteer ? theta * scale(axle) : scale(axle) / theta;
}

double DriveTracker::sigma(TrackedAxle axle) const {
  if (!started()) return begin_sigma(axle);
  const estimation::RecursiveRegression& r = regression(axle).regression();
  if (!r.usable()) return kInfinity;
  const double theta = r.theta()(0);
  return scale(axle) * (axle == TrackedAxle::kUndersteer ? r.sigma()(0) : r.sigma()(0) / (theta * theta));
}

double DriveTracker::filtered(std::size_t column, const FirKernel& kernel) const {
  double sum = 0.0;
  const std::size_t n = ring_.size();
  std::size_t at = next_;  // the oldest
  for (std::size_t j = 0; j < n; ++j) {
    sum += kernel.taps[j] * ring_[at][column];
    if (++at == n) at = 0;
  }
  return sum;
}

void DriveTracker::begin(double u) {
  const double m = start_.mass, a = start_.a, b = start_.b, L = start_.wheelbase(), k = start_.I_z / m;
  const double gain = 0.5 * m / L;
  const FirKernel &h = kernel_.smooth, &d = kernel_.first, &dd = kernel_.second;
  const std::size_t taps = h.taps.size();
  estimation::TrackerOptions options = options_;
  // The stated rate of false alarms is that of all three together.
  options.detection.false_alarm_interval_s *= static_cast<double>(kTrackedAxles);
  options.detection.block_s = std::max(options.detection.block_s, 1.0 / row_rate_Hz());
  const auto add = [&](std::vector<std::string> names, const NoiseTerms& noise, const Eigen::VectorXd& theta,
                       const Eigen::VectorXd& sigma) {
    trackers_.emplace_back(std::move(names), noise.covariance(), options, row_rate_Hz());
    trackers_.back().start(theta, sigma.cwiseAbs2().asDiagonal(), 0.0, 0.0);
  };
  NoiseTerms front(3, noise_, taps), rear(3, noise_, taps), understeer(4, noise_, taps);
  front.add(0, kAccelNoise, gain * b / start_.C_f, d);
  front.add(0, kYawNoise, gain * k / start_.C_f, dd);
  front.add(2, kSteerNoise, 1.0, d);
  front.add(2, kAccelNoise, -1.0 / u, h);
  front.add(2, kYawNoise, 1.0, h);
  front.add(2, kYawNoise, -a / u, d);
  rear.add(0, kAccelNoise, gain * a / start_.C_r, d);
  rear.add(0, kYawNoise, -gain * k / start_.C_r, dd);
  rear.add(2, kYawNoise, 1.0, h);
  rear.add(2, kAccelNoise, -1.0 / u, h);
  rear.add(2, kYawNoise, b / u, d);
  const double lag = lag_scale();
  understeer.add(0, kAccelNoise, scale(TrackedAxle::kUndersteer), h);
  understeer.add(1, kYawNoise, lag, d);
  understeer.add(3, kSteerNoise, 1.0, h);
  understeer.add(3, kYawNoise, -L / u, h);
  static_cast<void>(kSpeedNoise);
  add({"C_f0/C_f", "constant"}, front, Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(sigma_f_, kRateConstant));
  add({"C_r0/C_r", "constant"}, rear, Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(sigma_r_, kRateConstant));
  const double K_0 = scale(TrackedAxle::kUndersteer);
  add({"understeer_gradient/K_0", "yaw_lag/T_0", "constant"}, understeer,
      Eigen::Vector3d(understeer_gradient(start_) / K_0, 1.0, 0.0),
      Eigen::Vector3d(begin_sigma(TrackedAxle::kUndersteer) / K_0, std::max(sigma_f_, sigma_r_), kSteerConstant));
}

double DriveTracker::lag_scale() const {
  return 0.5 * start_.I_z / start_.wheelbase() * (1.0 / start_.C_f + 1.0 / start_.C_r);
}

void DriveTracker::form_row(std::vector<DriveChange>& found) {
  const FirKernel &h = kernel_.smooth, &d = kernel_.first, &dd = kernel_.second;
  const double m = start_.mass, a = start_.a, b = start_.b, L = start_.wheelbase(), k = start_.I_z / m;
  const double gain = 0.5 * m / L;
  const double u = filtered(kSpeedColumn, h), a_y = filtered(kAccel, h), dr = filtered(kYawRate, d);
  if (!started()) begin(u);
  // u r' = (u r)' - u' r, with the rate of the speed taken as constant over the kernel.
  const double d_ur = filtered(kSpeedYaw, dd) - filtered(kSpeedColumn, d) * dr;
  const double d_ua = filtered(kSpeedAccel, d);
  const double v_prime = filtered(kSpeedYaw, h) - a_y;
  const double time = last_ - latency_s();
  const auto feed = [&](TrackedAxle axle, std::span<const double> x, double z) {
    if (const auto change = trackers_[static_cast<std::size_t>(axle)].update(time, x, z)) {
      changes_.push_back({axle, *change});
      found.push_back(changes_.back());
    }
  };
  const std::array<double, 2> front{gain * (b * d_ua + k * d_ur) / (u * start_.C_f), 1.0};
  feed(TrackedAxle::kFront, front, (filtered(kSpeedSteer, d) + v_prime - a * dr) / u);
  const std::array<double, 2> rear{gain * (a * d_ua - k * d_ur) / (u * start_.C_r), 1.0};
  feed(TrackedAxle::kRear, rear, (v_prime + b * dr) / u);
  const std::array<double, 3> understeer{a_y * scale(TrackedAxle::kUndersteer), dr * lag_scale(), 1.0};
  feed(TrackedAxle::kUndersteer, understeer, filtered(kDelta, h) - L * filtered(kCurvature, h));
  if (!found.empty()) {
    // The road or the tyres are not what they were: what was learned of them is forgotten, by all three.
    trackers_[0].restart(Eigen::Vector2d(kAfterChange, kRateConstant));
    trackers_[1].restart(Eigen::Vector2d(kAfterChange, kRateConstant));
    trackers_[2].restart(Eigen::Vector3d(kAfterChange, kAfterChange, kSteerConstant));
  }
  ++rows_;
  if (time >= next_history_ - 1e-9) remember(time);
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
    to.suspicion.push_back(tracker.detector().suspicion());
  }
}

std::vector<DriveChange> DriveTracker::append(const DriveSample& s) {
  std::vector<DriveChange> found;
  const bool hole = s.time - last_ > 1.5 / rate_Hz_;
  const bool whole = std::isfinite(s.steer) && std::isfinite(s.speed) && std::isfinite(s.yaw_rate) &&
                     std::isfinite(s.accel_y) && s.speed >= min_speed_;
  last_ = s.time;
  if (hole || !whole) filled_ = since_row_ = 0;
  if (!whole) return found;
  ring_[next_] = {s.steer,           s.yaw_rate / s.speed, s.accel_y, s.speed * s.accel_y, s.speed * s.yaw_rate,
                  s.speed * s.steer, s.yaw_rate,           s.speed};
  next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
  filled_ = std::min(filled_ + 1, ring_.size());
  if (filled_ < ring_.size()) return found;
  if (since_row_ == 0) form_row(found);
  since_row_ = since_row_ + 1 == stride_ ? 0 : since_row_ + 1;
  return found;
}

namespace {

/// The estimate with rows for values that no tyre has and the grades that all rows give; what must not be used is
/// marked.
estimation::Estimate judged(estimation::Estimate estimate) {
  std::vector<estimation::Judgement> parts;
  for (estimation::Parameter& p : estimate.parameters) {
    const bool plausible = p.name == "understeer_gradient" || p.value > 0.0;
    if (!plausible) {
      estimate.evidence.push_back({.name = "plausibility of " + p.name,
                                   .about = p.name,
                                   .outcome = estimation::Outcome::kFailed,
                                   .value = p.value,
                                   .limit = 0.0,
                                   .scale = p.unit,
                                   .text = fmt::format("{} is negative: no tyre pushes that way", p.name),
                                   .bears_on = estimation::Purpose::kParameters,
                                   .advice = "check the signs of steer, yaw_rate and accel_y"});
    }
    std::vector<estimation::Evidence> rows;
    for (const estimation::Evidence& row : estimate.evidence)
      if (row.about == p.name) rows.push_back(row);
    if (rows.empty()) continue;
    parts.push_back(estimation::judge(rows));
    p = estimation::marked({p}, estimation::verdict_of(parts.back())).front();
  }
  estimate.judgement = estimation::judge_together(parts);
  return estimate;
}

}  // namespace

estimation::Estimate DriveTracker::estimate(const std::string& subject) const {
  estimation::Estimate out;
  out.subject = subject;
  out.method = fmt::format("{} on line", estimation::to_string(options_.method));
  out.covariance =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(kTrackedAxles), static_cast<Eigen::Index>(kTrackedAxles));
  std::vector<std::string> followed, held;
  for (const TrackedAxle axle : kAllTrackedAxles) {
    const double v = value(axle), s = sigma(axle);
    estimation::Parameter p{
        std::string(kTrackedAxleNames[axle]), v, s, v - 1.96 * s, v + 1.96 * s, std::string(kTrackedAxleUnits[axle]),
        ParameterStatus::kNotExcited};
    const auto at = static_cast<Eigen::Index>(axle);
    out.covariance(at, at) = s * s;
    if (started()) {
      const estimation::RegressionTracker& tracker = regression(axle);
      const estimation::RecursiveRegression& r = tracker.regression();
      p.status = r.status(0);
      // In units of the start's value, or its inverse: a relative error is the same in both.
      const estimation::RegressionEstimate regression = tracker.estimate();
      const double factor = regression.parameters[0].sigma / r.sigma()(0);
      if (factor > 1.0 && std::isfinite(factor)) {
        p.sigma *= factor;
        out.covariance(at, at) *= factor * factor;
      }
      const double half =
          regression.parameters[0].sigma > 0.0
              ? (regression.parameters[0].high95 - regression.parameters[0].value) / regression.parameters[0].sigma
              : 1.96;
      p.low95 = v - half * p.sigma;
      p.high95 = v + half * p.sigma;
      for (estimation::Evidence& row : estimation::tracking_evidence(p.name, tracker, regression))
        out.evidence.push_back(std::move(row));
      out.fit[p.name + ".residual_sd"] = r.residual_sd();
      out.fit[p.name + ".samples"] = r.effective_samples();
      const bool is_held = !history_[axle].held.empty() && history_[axle].held.back();
      if (is_held) p.status = ParameterStatus::kNotExcited;
      (is_held ? held : followed).push_back(p.name);
    }
    out.parameters.push_back(std::move(p));
  }
  out.verdict =
      started() ? fmt::format("followed: {}; started from the {}",
                              followed.empty() ? "nothing" : fmt::format("{}", fmt::join(followed, ", ")), begin_text_)
                : "nothing was followed: no stretch without holes is as long as the filter";
  out = judged(std::move(out));
  if (!held.empty()) out.verdict += fmt::format("; held at the end, because not excited: {}", fmt::join(held, ", "));
  return out;
}

}  // namespace veridyn::vehicle
