#include "veridyn/vehicle/tracking/axle_rows.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/filtered_noise.hpp"

namespace veridyn::vehicle {
namespace {

using numerics::FirKernel;

/// Of what a lean adds to the accelerometer at once, least share that is left to tell it by; a sensor so far above the
/// centre of gravity is taken for one at its height.
constexpr double kLeastPerLean = 0.3;
/// Time constants after which a beginning is forgotten to 2 %.
constexpr double kForgotten = 4.0;

/// What the ring keeps of every sample.
enum Column : std::size_t {
  kSteer,
  kCurvature,
  kSpeedSteer,
  kSlipYawRate,
  kContactRate,
  kAccel,
  kSpeedAccel,
  kSpeedYaw,
  kYawRate,
  kSpeed,
  kShifted
};

/// Sensors whose noise enters, by their place in the array of their sigmas.
constexpr std::size_t kSteerNoise = 0, kYawNoise = 2, kAccelNoise = 3;

}  // namespace

BodyFollower::BodyFollower(const KnownBody& body, const LeaningSensor& sensor, double step_s)
    : body_(body), sensor_(sensor), step_(step_s) {
  const double square = body_.roll.frequency * body_.roll.frequency;
  if (1.0 - square * body_.roll.gradient * sensor_.height < kLeastPerLean) sensor_.height = 0.0;
  per_lean_ = 1.0 - square * body_.roll.gradient * sensor_.height;
}

double BodyFollower::settling_s() const {
  const BodyRoll<double>& roll = body_.roll;
  constexpr double kSlow = 5.0;  // [m/s]; below it tyres that lag are forgotten a little later
  const double tyres = body_.relaxation_length / kSlow;
  if (roll.gradient == 0.0) return kForgotten * tyres;
  const double slowest = std::max(0.0, roll.damping * roll.damping - 1.0);
  const double decay = roll.frequency * (roll.damping - std::sqrt(slowest)) / per_lean_;
  return kForgotten * std::max(tyres, 1.0 / decay);
}

/// phi'' = w^2 (G a_y - phi) - 2 zeta w phi' with a_y = measured - g phi + z phi''.
double BodyFollower::lean_acceleration(double measured, double lean, double rate) const {
  const BodyRoll<double>& roll = body_.roll;
  const double w = roll.frequency;
  return (w * w * (roll.gradient * (measured - sensor_.gravity * lean) - lean) - 2.0 * roll.damping * w * rate) /
         per_lean_;
}

double BodyFollower::lateral(double measured) const {
  return measured - sensor_.gravity * lean_ + sensor_.height * lean_acceleration_;
}

BodyFollower::Slips BodyFollower::slips(const DriveSample& s) const {
  return {s.steer, s.yaw_rate / s.speed, s.speed * s.steer, s.yaw_rate,
          lateral(s.accel_y) - s.speed * s.yaw_rate + body_.roll.arm * lean_acceleration_};
}

BicycleSample BodyFollower::corrected(const DriveSample& s) const {
  const BodyRoll<double>& roll = body_.roll;
  return {.accel_y = lateral(s.accel_y),
          .shifted = lean_ + 2.0 * roll.damping / roll.frequency * lean_rate_,
          .steer = slip_[0],
          .curvature = slip_[1],
          .speed_steer = slip_[2],
          .yaw_rate = slip_[3],
          .contact_rate = slip_[4]};
}

BicycleSample BodyFollower::begin(const DriveSample& s) {
  const double G = body_.roll.gradient;
  lean_ = G * s.accel_y / (1.0 + sensor_.gravity * G);
  lean_rate_ = lean_acceleration_ = 0.0;
  speed_ = s.speed;
  input_ = slip_ = slips(s);
  return corrected(s);
}

BicycleSample BodyFollower::next(const DriveSample& s) {
  const double half = 0.5 * step_;
  if (body_.roll.gradient != 0.0) {
    // phi_1 = phi + half (p + p_1), p_1 = p + half (f + f_1): f is linear, so p_1 follows from its value without p_1.
    const double w = body_.roll.frequency;
    const double stiffness = w * w * (1.0 + body_.roll.gradient * sensor_.gravity) / per_lean_;
    const double damping = 2.0 * body_.roll.damping * w / per_lean_;
    const double without = lean_acceleration(s.accel_y, lean_ + half * lean_rate_, 0.0);
    const double rate =
        (lean_rate_ + half * (lean_acceleration_ + without)) / (1.0 + half * damping + half * half * stiffness);
    lean_ += half * (lean_rate_ + rate);
    lean_rate_ = rate;
    lean_acceleration_ = lean_acceleration(s.accel_y, lean_, lean_rate_);
  }
  const Slips now = slips(s);
  if (body_.relaxation_length > 0.0) {
    const double c = half * 0.5 * (speed_ + s.speed) / body_.relaxation_length;
    for (std::size_t i = 0; i < kLagging; ++i) slip_[i] = ((1.0 - c) * slip_[i] + c * (input_[i] + now[i])) / (1.0 + c);
  } else {
    slip_ = now;
  }
  input_ = now;
  speed_ = s.speed;
  return corrected(s);
}

AxleRows::AxleRows(const VehicleParameters<double>& vehicle, const KnownBody& body, const LeaningSensor& sensor,
                   double rate_Hz, double pass_Hz)
    : vehicle_(vehicle),
      tyres_(body.tyres),
      accel_scale_(body.accel_scale),
      steer_scale_(body.steer_scale),
      rate_Hz_(rate_Hz),
      kernel_(numerics::modulating_kernel(rate_Hz, pass_Hz)),
      follower_(body, sensor, 1.0 / rate_Hz),
      ring_(kernel_.smooth.taps.size()),
      settling_(static_cast<std::size_t>(std::ceil(follower_.settling_s() * rate_Hz))) {}

double AxleRows::latency_s() const { return static_cast<double>(kernel_.smooth.half_width()) / rate_Hz_; }

double AxleRows::understeer_scale() const {
  return 0.5 * vehicle_.mass / vehicle_.wheelbase() * (vehicle_.b / vehicle_.C_f + vehicle_.a / vehicle_.C_r);
}

double AxleRows::lag_scale() const {
  return 0.5 * vehicle_.I_z / vehicle_.wheelbase() * (1.0 / vehicle_.C_f + 1.0 / vehicle_.C_r);
}

void AxleRows::empty() { since_hole_ = 0; }

bool AxleRows::append(const DriveSample& given) {
  DriveSample s = given;
  s.accel_y /= 1.0 + accel_scale_;
  s.steer /= 1.0 + steer_scale_;
  const bool hole = s.time - last_ > 1.5 / rate_Hz_;
  const bool whole =
      std::isfinite(s.steer) && std::isfinite(s.speed) && std::isfinite(s.yaw_rate) && std::isfinite(s.accel_y);
  last_ = s.time;
  if (hole || !whole) empty();
  if (!whole) return false;
  const BicycleSample c = since_hole_ == 0 ? follower_.begin(s) : follower_.next(s);
  ring_[next_] = {c.steer,   c.curvature,         c.speed_steer,        c.yaw_rate, c.contact_rate,
                  c.accel_y, s.speed * c.accel_y, s.speed * s.yaw_rate, s.yaw_rate, s.speed,
                  c.shifted};
  next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
  since_hole_ = std::min(since_hole_ + 1, ring_.size() + settling_);
  return since_hole_ == ring_.size() + settling_;
}

double AxleRows::filtered(std::size_t column, const FirKernel& kernel) const {
  double sum = 0.0;
  const std::size_t n = ring_.size();
  std::size_t from = next_;  // the oldest
  for (std::size_t j = 0; j < n; ++j) {
    sum += kernel.taps[j] * ring_[from][column];
    if (++from == n) from = 0;
  }
  return sum;
}

double AxleRows::speed() const { return filtered(kSpeed, kernel_.smooth); }

AxleRows::Forces AxleRows::forces() const {
  const FirKernel &h = kernel_.smooth, &d = kernel_.first, &dd = kernel_.second;
  const VehicleParameters<double>& p = vehicle_;
  const double k = p.I_z / p.mass, gain = 0.5 * p.mass / p.wheelbase();
  const double a_y = filtered(kAccel, h), dr = filtered(kYawRate, d), u = speed(), du = filtered(kSpeed, d);
  // u r' = (u r)' - u' r, with the rate of the speed taken as constant over the kernel.
  const double d_ur = filtered(kSpeedYaw, dd) - du * dr, d_ua = filtered(kSpeedAccel, d);
  Forces out{.force = {gain * (p.b * a_y + k * dr), gain * (p.a * a_y - k * dr)},
             .speed_rate = {gain * (p.b * d_ua + k * d_ur), gain * (p.a * d_ua - k * d_ur)}};
  out.unlimited = out.force;
  if (is_linear(tyres_)) return out;
  const double shifted = filtered(kShifted, h), d_shifted = filtered(kShifted, d);
  // The smoothed force is taken through the curve, which bends little within a kernel's length.
  constexpr double kMoment = 0.02;  // [s]
  const auto unlimited = [&](double after) {
    std::array<double, 2> there{};
    for (std::size_t i = 0; i < 2; ++i)
      there[i] = (out.force[i] + after * (out.speed_rate[i] - du * out.force[i]) / u) / grip_[i];
    there = forces_without_limit(tyres_, there, shifted + after * d_shifted);
    return std::array{grip_[0] * there[0], grip_[1] * there[1]};
  };
  const std::array<double, 2> before = unlimited(-kMoment), after = unlimited(kMoment);
  out.unlimited = unlimited(0.0);
  for (std::size_t i = 0; i < 2; ++i)
    out.speed_rate[i] = du * out.unlimited[i] + u * (after[i] - before[i]) / (2.0 * kMoment);
  return out;
}

AxleRowSet AxleRows::rows() const {
  const FirKernel &h = kernel_.smooth, &d = kernel_.first;
  const VehicleParameters<double>& p = vehicle_;
  const double L = p.wheelbase(), u = speed(), contact = filtered(kContactRate, h),
               slip_yaw = filtered(kSlipYawRate, d);
  const Forces f = forces();
  AxleRowSet out;
  out.time = last_ - latency_s();
  out.force = f.force;
  for (std::size_t i = 0; i < 2; ++i)
    if (f.force[i] != 0.0) out.saturation[i] = f.unlimited[i] / f.force[i] - 1.0;
  out.front = {{f.speed_rate[0] / (u * p.C_f), 1.0}, (filtered(kSpeedSteer, d) - contact - p.a * slip_yaw) / u};
  out.rear = {{f.speed_rate[1] / (u * p.C_r), 1.0}, (p.b * slip_yaw - contact) / u};
  // What saturation adds to the difference of the slips is no understeer of the tyres' stiffnesses.
  const std::array<double, 2> C = stiffnesses_of(tyres_);
  double added = 0.0;
  if (!is_linear(tyres_))
    added = (f.unlimited[0] - f.force[0]) / (grip_[0] * C[0]) - (f.unlimited[1] - f.force[1]) / (grip_[1] * C[1]);
  out.understeer = {{filtered(kAccel, h) * understeer_scale(), filtered(kYawRate, d) * lag_scale(), 1.0},
                    filtered(kSteer, h) - L * filtered(kCurvature, h) - added};
  return out;
}

Eigen::MatrixXd AxleRows::noise_covariance(TrackedAxle axle, const std::array<double, 4>& noise, double u) const {
  const FirKernel &h = kernel_.smooth, &d = kernel_.first, &dd = kernel_.second;
  const VehicleParameters<double>& p = vehicle_;
  const double k = p.I_z / p.mass, gain = 0.5 * p.mass / p.wheelbase();
  std::array<double, 4> variances{};
  for (std::size_t i = 0; i < noise.size(); ++i) variances[i] = noise[i] * noise[i];
  numerics::FilteredNoise row(axle == TrackedAxle::kUndersteer ? 4 : 3, variances, h.taps.size());
  const auto with_rounding = [&row] {  // which is left without noise
    Eigen::MatrixXd W = row.covariance();
    W(W.rows() - 1, W.cols() - 1) += 1e-16;
    return W;
  };
  if (axle == TrackedAxle::kUndersteer) {
    row.add(0, kAccelNoise, understeer_scale(), h);
    row.add(1, kYawNoise, lag_scale(), d);
    row.add(3, kSteerNoise, 1.0, h);
    row.add(3, kYawNoise, -p.wheelbase() / u, h);
    return with_rounding();
  }
  const bool front = axle == TrackedAxle::kFront;
  row.add(0, kAccelNoise, front ? gain * p.b / p.C_f : gain * p.a / p.C_r, d);
  row.add(0, kYawNoise, front ? gain * k / p.C_f : -gain * k / p.C_r, dd);
  if (front) row.add(2, kSteerNoise, 1.0, d);
  row.add(2, kAccelNoise, -1.0 / u, h);
  row.add(2, kYawNoise, 1.0, h);
  row.add(2, kYawNoise, front ? -p.a / u : p.b / u, d);
  return with_rounding();
}

}  // namespace veridyn::vehicle
