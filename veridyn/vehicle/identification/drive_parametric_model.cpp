#include "veridyn/vehicle/identification/drive_parametric_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kLongestStep_s = 5e-3;
/// Step times the fastest decay rate of the bicycle: RK4 then errs by less than 1e-5 of a transient.
constexpr double kStepTimesRate = 0.25;
constexpr int kMostSubsteps = 40;
/// Beyond it a yaw rate is not that of a vehicle [rad/s].
constexpr double kLargestYawRate = 50.0;
/// How far delays reach beyond a segment [s].
constexpr double kReach_s = 0.5;

/// Cut-off of the smoothing [Hz], and the noise of the steering over its rms from which it is needed.
constexpr double kSmoothing_Hz = 4.0;
constexpr double kNoNoise = 1e-4;

double value_of(double x) { return x; }
template <int kN>
double value_of(const ceres::Jet<double, kN>& x) {
  return x.a;
}

/// Between `samples` at `position`, cubic.
template <typename Value, typename Scalar>
Scalar between(const std::vector<Value>& samples, const Scalar& position) {
  const auto last = static_cast<double>(samples.size() - 1);
  const double p = std::clamp(value_of(position), 0.0, last);
  const auto i = static_cast<std::size_t>(std::min(std::floor(p), std::max(0.0, last - 1.0)));
  if (samples.size() == 1) return Scalar(samples[0]);
  const Value& y1 = samples[i];
  const Value& y2 = samples[i + 1];
  const Value y0 = i > 0 ? samples[i - 1] : Value(2.0 * y1 - y2);
  const Value y3 = i + 2 < samples.size() ? samples[i + 2] : Value(2.0 * y2 - y1);
  Scalar s = position - static_cast<double>(i);
  if (value_of(position) < 0.0 || value_of(position) > last) s = Scalar(p - static_cast<double>(i));
  return y1 + 0.5 * s * (y2 - y0 + s * (2.0 * y0 - 5.0 * y1 + 4.0 * y2 - y3 + s * (3.0 * (y1 - y2) + y3 - y0)));
}

/// The cut-off of the smoothing that the noise of a steering signal needs [Hz]; 0: none.
double smoothing_for(const GridSignal& steer, double rate_Hz) {
  double power = 0.0, count = 0.0;
  for (const double v : steer.value) {
    if (!std::isfinite(v)) continue;
    power += v * v;
    count += 1.0;
  }
  const bool noisy = steer.sigma * steer.sigma * count > kNoNoise * kNoNoise * power;
  return noisy ? std::min(kSmoothing_Hz, 0.1 * rate_Hz) : 0.0;
}

std::vector<double> smoothed(const std::vector<double>& x, double rate_Hz, double cutoff_Hz) {
  if (!(cutoff_Hz > 0.0) || x.empty()) return x;
  return numerics::filter(x, numerics::modulating_kernel(rate_Hz, cutoff_Hz).smooth);
}

/// Lowest and highest value of an unknown that starts at `start`.
std::pair<double, double> bounds_of(DriveUnknown unknown, double start, double wheelbase, double factor) {
  switch (unknown) {
    case DriveUnknown::kCf:
    case DriveUnknown::kCr:
    case DriveUnknown::kIz:
      return {start / factor, factor * start};
    case DriveUnknown::kA:
      return {0.02 * wheelbase, 0.98 * wheelbase};
    case DriveUnknown::kMu:
      return {0.02, 5.0};
    case DriveUnknown::kShape:
      return {0.8, 2.5};
    case DriveUnknown::kCurvature:
      return {-10.0, 1.0};
    case DriveUnknown::kSteerScale:
    case DriveUnknown::kAccelYScale:
      return {-0.9, kInfinity};
    case DriveUnknown::kSteerDelay:
    case DriveUnknown::kYawRateDelay:
    case DriveUnknown::kAccelYDelay:
      return {-kReach_s, kReach_s};
    default:
      return {-kInfinity, kInfinity};
  }
}

estimation::ModelParameter model_parameter(DriveUnknown unknown, const DriveModelOptions& options, double wheelbase) {
  estimation::ModelParameter p;
  p.name = std::string(kDriveUnknownNames[unknown]);
  p.unit = std::string(kDriveUnknownUnits[unknown]);
  p.start = options.start[unknown];
  p.prior_sigma = options.prior[unknown];
  p.fixed = !options.free[unknown];
  // Bounds must hold at the start, whatever was given.
  const auto [low, high] = bounds_of(unknown, p.start, wheelbase, options.search_factor);
  p.low = std::min(low, p.start);
  p.high = std::max(high, p.start);
  return p;
}

}  // namespace

template <typename Scalar>
Scalar SampledInput::at(const Scalar& position) const {
  const auto n = value.size();
  const double p = std::clamp(value_of(position), 0.0, static_cast<double>(n - 1));
  if (n == 1) return Scalar(value[0]);
  const auto i = std::min(static_cast<std::size_t>(p), n - 2);
  const double s = p - static_cast<double>(i);
  const double y1 = value[i], y2 = value[i + 1];
  const double y0 = i > 0 ? value[i - 1] : 2.0 * y1 - y2;
  const double y3 = i + 2 < n ? value[i + 2] : 2.0 * y2 - y1;
  const double c1 = y2 - y0, c2 = 2.0 * y0 - 5.0 * y1 + 4.0 * y2 - y3, c3 = 3.0 * (y1 - y2) + y3 - y0;
  const double y = y1 + 0.5 * s * (c1 + s * (c2 + s * c3));
  if (p != value_of(position)) return Scalar(y);
  const double slope = 0.5 * (c1 + s * (2.0 * c2 + 3.0 * s * c3));
  return Scalar(y) + slope * (position - p);
}
template double SampledInput::at(const double&) const;
template ceres::Jet<double, 8> SampledInput::at(const ceres::Jet<double, 8>&) const;

DriveModelOptions::DriveModelOptions() {
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kSteerBias,
                               DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias})
    free[u] = true;
  start.fill(0.0);
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA})
    start[u] = kNaN;
  start[DriveUnknown::kMu] = 1.0;
  start[DriveUnknown::kShape] = 1.3;
  prior.fill(kInfinity);
  prior[DriveUnknown::kSteerBias] = kDegree;
  prior[DriveUnknown::kYawRateBias] = kDegree;
  prior[DriveUnknown::kAccelYBias] = 0.5;
  prior[DriveUnknown::kSteerScale] = 0.1;
  prior[DriveUnknown::kAccelYScale] = 0.1;
  for (const DriveUnknown u : {DriveUnknown::kSteerDelay, DriveUnknown::kYawRateDelay, DriveUnknown::kAccelYDelay})
    prior[u] = 0.1;
  prior[DriveUnknown::kShape] = 0.2;
  prior[DriveUnknown::kCurvature] = 0.5;
}

void DriveModelOptions::read_keys(const StudyTable& table) {
  const std::vector<std::string> tyres{"linear", "magic formula"};
  tyre = table.choice_or("tyre", tyres, "linear") == "linear" ? DriveTyre::kLinear : DriveTyre::kMagicFormula;
  const std::vector<std::string> names(kDriveUnknownNames.begin(), kDriveUnknownNames.end());
  if (tyre == DriveTyre::kMagicFormula) {
    free[DriveUnknown::kMu] = true;
    free[DriveUnknown::kShape] = true;
  }
  if (table.has("estimate")) {
    free.fill(false);
    for (const std::string& name : table.texts("estimate")) {
      const auto at = std::find(names.begin(), names.end(), name);
      if (at == names.end())
        table.fail("estimate", fmt::format("'{}' is not an unknown of the drive model{}", name,
                                           suggestion(name, names, names.size())));
      free[static_cast<std::size_t>(at - names.begin())] = true;
    }
  }
  if (tyre == DriveTyre::kLinear) {
    for (const DriveUnknown u : {DriveUnknown::kMu, DriveUnknown::kShape, DriveUnknown::kCurvature}) {
      if (free[u])
        table.fail("estimate", fmt::format("names {}, which linear tyres do not have (tyre = \"magic formula\")",
                                           kDriveUnknownNames[u]));
    }
  }
  if (table.has("smoothing")) {
    smoothing_Hz = table.number("smoothing", "Hz");
    if (!(smoothing_Hz >= 0.0)) table.fail("smoothing", fmt::format("= {:g} Hz must be >= 0 (0: none)", smoothing_Hz));
  }
  const StudyTable starts = table.table_or_empty("start");
  const StudyTable priors = table.table_or_empty("prior");
  for (const DriveUnknown u : kAllDriveUnknowns) {
    const std::string_view name = kDriveUnknownNames[u], unit = kDriveUnknownUnits[u];
    if (starts.has(name)) start[u] = starts.number(name, unit);
    if (!priors.has(name)) continue;
    if (priors.is_text(name) && priors.text(name) == "none")
      prior[u] = kInfinity;
    else
      prior[u] = priors.positive(name, unit);
  }
}

DriveParametricModel::DriveParametricModel(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                           const VehicleParameters<double>& start, const DriveModelOptions& options)
    : grid_(signals.grid), accel_position_(signals.accel_position), start_(start), options_(options) {
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kSpeed, DriveSignal::kYawRate}) {
    if (!signals[s].available()) {
      throw InputError(signals.source, fmt::format("has no {}, which output error is driven by or compared with",
                                                   kDriveSignalNames[s]));
    }
  }
  accel_ = signals[DriveSignal::kAccelY].available();
  lateral_velocity_ = signals[DriveSignal::kLateralVelocity].available();
  outputs_ = {{"yaw_rate", "rad/s"}};
  if (accel_) outputs_.push_back({"accel_y", "m/s^2"});
  if (lateral_velocity_) outputs_.push_back({"lateral_velocity", "m/s"});

  smoothing_Hz_ =
      options.smoothing_Hz < 0.0 ? smoothing_for(signals[DriveSignal::kSteer], grid_.rate_Hz()) : options.smoothing_Hz;
  steer_ = smoothed(signals[DriveSignal::kSteer].value, grid_.rate_Hz(), smoothing_Hz_);
  speed_ = smoothed(signals[DriveSignal::kSpeed].value, grid_.rate_Hz(), smoothing_Hz_);
  yaw_rate_ = smoothed(signals[DriveSignal::kYawRate].value, grid_.rate_Hz(), smoothing_Hz_);
  accel_y_ = smoothed(signals[DriveSignal::kAccelY].value, grid_.rate_Hz(), smoothing_Hz_);
  lateral_velocity_meas_ = smoothed(signals[DriveSignal::kLateralVelocity].value, grid_.rate_Hz(), smoothing_Hz_);

  const std::array<double, 4> of_the_vehicle{start.C_f, start.C_r, start.I_z, start.a};
  for (std::size_t i = 0; i < of_the_vehicle.size(); ++i) {
    if (!std::isfinite(options_.start[i])) options_.start[i] = of_the_vehicle[i];
  }
  for (const DriveUnknown u : kAllDriveUnknowns) parameters_.push_back(model_parameter(u, options_, start.wheelbase()));
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    if (end > begin + 1) segments_.push_back(make_segment(begin, end));
  }
}

DriveParametricModel::Segment DriveParametricModel::make_segment(std::size_t begin, std::size_t end) const {
  const double C_f = options_.start[0], C_r = options_.start[1], I_z = options_.start[2];
  const double slowest = *std::min_element(speed_.begin() + static_cast<std::ptrdiff_t>(begin),
                                           speed_.begin() + static_cast<std::ptrdiff_t>(end));
  const double rate =
      2.0 / slowest * ((C_f + C_r) / start_.mass + (start_.a * start_.a * C_f + start_.b * start_.b * C_r) / I_z);
  const double step = grid_.step;
  Segment out;
  out.begin = begin;
  out.samples = static_cast<Eigen::Index>(end - begin);
  out.substeps =
      static_cast<int>(std::clamp(std::ceil(std::max(step / kLongestStep_s, step * rate / kStepTimesRate) - 1e-9), 1.0,
                                  static_cast<double>(kMostSubsteps)));
  // Steady cornering at the measured yaw rate, averaged over a tenth of a second.
  const std::size_t few = std::min(end - begin, static_cast<std::size_t>(std::max(1.0, 0.1 / step)));
  double r0 = 0.0;
  for (std::size_t k = 0; k < few; ++k) r0 += yaw_rate_[begin + k] / static_cast<double>(few);
  const double u0 = speed_[begin];
  const double v0 = r0 * (start_.b - start_.a * start_.mass * u0 * u0 / (2.0 * C_r * start_.wheelbase()));
  out.initial = {{.name = "lateral_velocity", .unit = "m/s", .start = v0},
                 {.name = "yaw_rate", .unit = "rad/s", .start = r0}};
  return out;
}

TimeSpan DriveParametricModel::segment_span(std::size_t segment) const {
  const Segment& s = segments_[segment];
  return {grid_.at(s.begin), grid_.at(s.begin + static_cast<std::size_t>(s.samples) - 1)};
}

std::string DriveParametricModel::segment_name(std::size_t segment) const {
  const TimeSpan span = segment_span(segment);
  return fmt::format("segment {} ({:.1f} to {:.1f} s)", segment + 1, span.begin, span.end);
}

std::vector<estimation::RowMatrix> DriveParametricModel::measured() const {
  std::vector<estimation::RowMatrix> all;
  for (const Segment& s : segments_) {
    estimation::RowMatrix m(s.samples, static_cast<Eigen::Index>(outputs_.size()));
    for (Eigen::Index k = 0; k < s.samples; ++k) {
      const std::size_t at = s.begin + static_cast<std::size_t>(k);
      Eigen::Index column = 0;
      m(k, column++) = yaw_rate_[at];
      if (accel_) m(k, column++) = accel_y_[at];
      if (lateral_velocity_) m(k, column++) = lateral_velocity_meas_[at];
    }
    all.push_back(std::move(m));
  }
  return all;
}

template <typename Scalar, typename Tyre>
bool DriveParametricModel::drive(const Segment& segment, const BicycleModel<Scalar, Tyre>& model,
                                 const Parameters<Scalar>& theta, Outputs<Scalar>& output) const {
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  const std::vector<double>& steer_all = steer_;
  const std::vector<double>& speed_all = speed_;
  const std::size_t n = static_cast<std::size_t>(segment.samples);
  const double step = grid_.step;
  // The steering before and after the segment, as far as it is there, for its delay.
  const auto reach = static_cast<std::size_t>(kReach_s / step);
  std::size_t lead = 0, tail = 0;
  while (lead < reach && segment.begin > lead && std::isfinite(steer_all[segment.begin - lead - 1])) ++lead;
  while (tail < reach && segment.begin + n + tail < steer_all.size() &&
         std::isfinite(steer_all[segment.begin + n + tail]))
    ++tail;
  const SampledInput steer{std::span(steer_all).subspan(segment.begin - lead, lead + n + tail), step};
  const SampledInput speed{std::span(speed_all).subspan(segment.begin, n), step};

  const Scalar steer_gain = 1.0 / (1.0 + unknown(DriveUnknown::kSteerScale));
  const Scalar steer_lead = static_cast<double>(lead) - unknown(DriveUnknown::kSteerDelay) / step;
  struct Input {
    Scalar delta;
    Scalar u;
  };
  const auto input = [&](double position) -> Input {
    const Scalar at = steer_lead + position;
    return {(steer.at(at) - unknown(DriveUnknown::kSteerBias)) * steer_gain, Scalar(speed.at(position))};
  };
  const bool delayed = !(unknown(DriveUnknown::kYawRateDelay) == Scalar(0.0)) ||
                       !(unknown(DriveUnknown::kAccelYDelay) == Scalar(0.0)) ||
                       options_.free[DriveUnknown::kYawRateDelay] || options_.free[DriveUnknown::kAccelYDelay];
  std::vector<Scalar> yaw_rate(delayed ? n : 0), accel(delayed && accel_ ? n : 0);

  const auto [x, y, z] = accel_position_;
  static_cast<void>(z);
  const double h = step / segment.substeps;
  const auto first = static_cast<Eigen::Index>(parameters_.size());
  Scalar v = theta(first), r = theta(first + 1);
  using State = Eigen::Matrix<Scalar, 2, 1>;
  Input now = input(0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const bool plausible = v < 2.0 * now.u && -v < 2.0 * now.u && r < kLargestYawRate && -r < kLargestYawRate;
    if (!plausible) return false;
    for (int i = 0; i < segment.substeps; ++i) {
      const BicycleRates<Scalar> k1 = model.rates(v, r, now.delta, now.u);
      if (i == 0) {
        const Scalar at_sensor = k1.lateral_acceleration + x * k1.dr - y * r * r;
        Eigen::Index column = 0;
        if (delayed) {
          yaw_rate[k] = r;
          if (accel_) accel[k] = at_sensor;
        }
        output(row, column++) = r + unknown(DriveUnknown::kYawRateBias);
        if (accel_)
          output(row, column++) =
              (1.0 + unknown(DriveUnknown::kAccelYScale)) * at_sensor + unknown(DriveUnknown::kAccelYBias);
        if (lateral_velocity_) output(row, column++) = v;
        if (k + 1 == n) break;
      }
      const double at = static_cast<double>(k) + static_cast<double>(i) / segment.substeps;
      const Input middle = input(at + 0.5 / segment.substeps);
      const Input next = input(at + 1.0 / segment.substeps);
      const auto rate = [&](numerics::RungeKuttaMoment moment, const State& stage) -> State {
        const Input& there = moment == numerics::RungeKuttaMoment::kMiddle ? middle : next;
        const BicycleRates<Scalar> rates = model.rates(stage(0), stage(1), there.delta, there.u);
        return {rates.dv, rates.dr};
      };
      const State moved = numerics::runge_kutta_4_from(State(k1.dv, k1.dr), rate, State(v, r), h);
      v = moved(0);
      r = moved(1);
      now = next;
    }
  }
  if (delayed) delay_outputs(theta, yaw_rate, accel, output);
  return true;
}

template <typename Scalar>
void DriveParametricModel::delay_outputs(const Parameters<Scalar>& theta, const std::vector<Scalar>& yaw_rate,
                                         const std::vector<Scalar>& accel, Outputs<Scalar>& output) const {
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  for (std::size_t k = 0; k < yaw_rate.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Scalar at_r = static_cast<double>(k) - unknown(DriveUnknown::kYawRateDelay) / grid_.step;
    output(row, 0) = between(yaw_rate, at_r) + unknown(DriveUnknown::kYawRateBias);
    if (!accel_) continue;
    const Scalar at_a = static_cast<double>(k) - unknown(DriveUnknown::kAccelYDelay) / grid_.step;
    output(row, 1) =
        (1.0 + unknown(DriveUnknown::kAccelYScale)) * between(accel, at_a) + unknown(DriveUnknown::kAccelYBias);
  }
}

template <typename Scalar>
bool DriveParametricModel::simulate(std::size_t segment, const Parameters<Scalar>& theta,
                                    Outputs<Scalar>& output) const {
  const auto unknown = [&](DriveUnknown u) -> const Scalar& { return theta(static_cast<Eigen::Index>(u)); };
  VehicleParameters<Scalar> p = start_.cast<Scalar>();
  p.C_f = unknown(DriveUnknown::kCf);
  p.C_r = unknown(DriveUnknown::kCr);
  p.I_z = unknown(DriveUnknown::kIz);
  p.a = unknown(DriveUnknown::kA);
  p.b = start_.wheelbase() - p.a;
  if (options_.tyre == DriveTyre::kLinear) {
    const BicycleModel<Scalar, LinearTyre<Scalar>> model{
        .parameters = p, .front = {.stiffness = p.C_f}, .rear = {.stiffness = p.C_r}, .gravity = options_.gravity};
    return drive(segments_[segment], model, theta, output);
  }
  const PerWheel<Scalar> load = static_loads(p, options_.gravity);
  const auto tyre = [&](const Scalar& stiffness, const Scalar& nominal) {
    SimpleMagicFormulaTyre<Scalar> t;
    t.stiffness = stiffness;
    t.mu = unknown(DriveUnknown::kMu);
    t.C = unknown(DriveUnknown::kShape);
    t.E = unknown(DriveUnknown::kCurvature);
    t.nominal_load = nominal;
    return t;
  };
  const BicycleModel<Scalar, SimpleMagicFormulaTyre<Scalar>> model{.parameters = p,
                                                                   .front = tyre(p.C_f, load[kFrontLeft]),
                                                                   .rear = tyre(p.C_r, load[kRearLeft]),
                                                                   .gravity = options_.gravity};
  return drive(segments_[segment], model, theta, output);
}

template bool DriveParametricModel::simulate(std::size_t, const Parameters<double>&, Outputs<double>&) const;
template bool DriveParametricModel::simulate(std::size_t, const Parameters<ceres::Jet<double, 8>>&,
                                             Outputs<ceres::Jet<double, 8>>&) const;

}  // namespace veridyn::vehicle
