#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

/// A flight made of formulas, for the tests and benchmarks of reconstruction: attitude and ground velocity are analytic
/// functions of time, so gyro and accelerometer are exact; the air is a constant wind plus Dryden gusts; the sensors
/// are the reference set. It knows nothing of aerodynamics and shares no code with the filter.
namespace veridyn::aircraft::testing {

struct FlightCase {
  double speed = 15.0;
  double duration = 120.0;
  std::uint64_t seed = 1;
  DrydenSettings spectrum{200.0, 200.0, 50.0, 2.12, 2.12, 1.4};
  Eigen::Vector3d wind{4.0, -3.0, 0.0};
  bool noise = true;
};

struct MadeFlight {
  Recording recording;
  std::vector<double> t, airspeed, alpha, beta, wind_north, wind_east, wind_down;
};

/// Gusts by the transfer functions themselves, in controllable canonical form with fine Euler-Maruyama steps: another
/// realisation and another discretisation than the filter's.
class MadeGusts {
 public:
  MadeGusts(const DrydenSettings& s, std::uint64_t seed) : s_(s), random_(seed, "gusts") {}
  Eigen::Vector3d step(double V, double dt) {
    constexpr int kSub = 10;
    const double h = dt / kSub;
    for (int i = 0; i < kSub; ++i) {
      const double au = V / s_.Lu;
      u_ += -au * u_ * h + s_.sigma_u * std::sqrt(2.0 * au * h) * random_.normal();
      canonical(v_, V / s_.Lv, h);
      canonical(w_, V / s_.Lw, h);
    }
    // y = sigma sqrt(3 a) (s + a / sqrt 3) / (s + a)^2
    const auto out = [](const Eigen::Vector2d& x, double a, double sigma) {
      return sigma * std::sqrt(3.0 * a) * (x(1) + a / std::sqrt(3.0) * x(0));
    };
    return {u_, out(v_, V / s_.Lv, s_.sigma_v), out(w_, V / s_.Lw, s_.sigma_w)};
  }
  void settle(double V) {
    for (int i = 0; i < 4000; ++i) static_cast<void>(step(V, 0.02));
  }

 private:
  void canonical(Eigen::Vector2d& x, double a, double h) {
    const Eigen::Vector2d rate(x(1), -a * a * x(0) - 2.0 * a * x(1));
    x += h * rate;
    x(1) += std::sqrt(h) * random_.normal();
  }
  DrydenSettings s_;
  numerics::RandomStream random_;
  double u_ = 0.0;
  Eigen::Vector2d v_ = Eigen::Vector2d::Zero(), w_ = Eigen::Vector2d::Zero();
};

inline MadeFlight make_flight(const FlightCase& c) {
  constexpr double kDt = 0.01, kDeg = M_PI / 180.0, kRho = 1.2;
  using Eigen::Vector3d;
  const auto attitude = [&](double t) {  // turns both ways, rolls and pitches
    return numerics::EulerAngles<double>{0.5 * std::sin(0.35 * t), 0.05 + 0.08 * std::sin(0.8 * t + 1.0),
                                         0.3 + 1.6 * std::sin(0.11 * t)};
  };
  const auto velocity = [&](double t) -> Vector3d {
    const auto e = attitude(t);
    const Eigen::Matrix3d R = numerics::R_body_from_ned(e.phi, e.theta, e.psi).transpose();
    const double a = 0.04 + 0.02 * std::sin(0.9 * t);
    const double V = c.speed + 1.5 * std::sin(0.2 * t);
    return R * Vector3d(V * std::cos(a), 0.3 * std::sin(0.5 * t), V * std::sin(a)) + c.wind;
  };
  MadeGusts gusts(c.spectrum, c.seed);
  gusts.settle(c.speed);
  MadeFlight f;
  const auto n = static_cast<std::size_t>(std::lround(c.duration / kDt)) + 1;
  std::vector<std::string> names{"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z",
                                 "roll",    "pitch",   "yaw",     "alpha",  "beta",   "dynamic_pressure"};
  std::vector<std::string> units{"m/s^2", "m/s^2", "m/s^2", "rad/s", "rad/s", "rad/s",
                                 "rad",   "rad",   "rad",   "rad",   "rad",   "Pa"};
  std::vector<double> sigma{0.05,        0.05,        0.05,        0.35 * kDeg, 0.35 * kDeg, 0.35 * kDeg,
                            0.75 * kDeg, 0.75 * kDeg, 0.75 * kDeg, 0.6 * kDeg,  0.6 * kDeg,  10.0};
  std::vector<std::vector<double>> y(names.size());
  std::vector<double> gps_t, gps[3];
  std::vector<numerics::RandomStream> random;
  for (const auto& name : names) random.emplace_back(c.seed, name);
  numerics::RandomStream gps_random(c.seed, "gps");
  for (std::size_t i = 0; i < n; ++i) {
    const double t = kDt * static_cast<double>(i);
    const auto e = attitude(t);
    const Eigen::Matrix3d R_BN = numerics::R_body_from_ned(e.phi, e.theta, e.psi);
    const Vector3d v = velocity(t);
    constexpr double h = 1e-4;
    const Vector3d acceleration =
        (velocity(t - 2 * h) - 8.0 * velocity(t - h) + 8.0 * velocity(t + h) - velocity(t + 2 * h)) / (12.0 * h);
    const Vector3d force = R_BN * (acceleration - Vector3d(0.0, 0.0, 9.80665));
    const auto em = attitude(t - h), ep = attitude(t + h);
    const Vector3d omega = numerics::body_rates(
        e.phi, e.theta, Vector3d(Vector3d(ep.phi - em.phi, ep.theta - em.theta, ep.psi - em.psi) / (2.0 * h)));
    const Vector3d still = R_BN * (v - c.wind);
    const Vector3d gust = i == 0 ? gusts.step(still.norm(), 1e-6) : gusts.step(still.norm(), kDt);
    const Vector3d air = still - gust;
    const double V = air.norm();
    const Vector3d total = v - R_BN.transpose() * air;
    f.t.push_back(t);
    f.airspeed.push_back(V);
    f.alpha.push_back(std::atan2(air.z(), air.x()));
    f.beta.push_back(std::asin(air.y() / V));
    f.wind_north.push_back(total.x());
    f.wind_east.push_back(total.y());
    f.wind_down.push_back(total.z());
    const double truth[] = {force.x(), force.y(), force.z(), omega.x(),      omega.y(),     omega.z(),
                            e.phi,     e.theta,   e.psi,     f.alpha.back(), f.beta.back(), 0.5 * kRho * V * V};
    for (std::size_t k = 0; k < y.size(); ++k) {
      y[k].push_back(truth[k] + (c.noise ? sigma[k] * random[k].normal() : 0.0));
    }
    if (i % 5 == 0) {
      gps_t.push_back(t);
      for (int k = 0; k < 3; ++k) {
        gps[k].push_back(v(k) + (c.noise ? (k < 2 ? 0.05 : 0.1) * gps_random.normal() : 0.0));
      }
    }
  }
  const TimeBase time = make_time_base(f.t);
  f.recording.source = "made flight";
  f.recording.frame = Frame::kFrd;
  for (std::size_t k = 0; k < names.size(); ++k) f.recording.add(make_channel(names[k], units[k], time, y[k]));
  const TimeBase gps_time = make_time_base(gps_t);
  const char* gps_names[] = {"vel_north", "vel_east", "vel_down"};
  for (int k = 0; k < 3; ++k) f.recording.add(make_channel(gps_names[k], "m/s", gps_time, gps[k]));
  f.recording.add(make_channel("air_density", "kg/m^3", make_time_base({0.0}), {kRho}));
  return f;
}

/// Errors of one channel against the truth after the first `settle` seconds.
struct ErrorStatistics {
  double rms = 0.0, bias = 0.0, covered95 = 0.0;
  std::size_t count = 0;
};
inline ErrorStatistics errors_of(const Recording& estimate, const std::string& name, const std::vector<double>& truth,
                                 double settle = 20.0, double end_off = 0.0) {
  const Channel& value = estimate.at(name);
  const Channel& sigma = estimate.at("sigma_" + name);
  ErrorStatistics s;
  const auto t = value.times();
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (t[i] < settle || t[i] > t.back() - end_off) continue;
    const double e = value.value[i] - truth[static_cast<std::size_t>(std::lround(t[i] / 0.01))];
    s.rms += e * e;
    s.bias += e;
    s.covered95 += std::abs(e) < 1.96 * sigma.value[i] ? 1.0 : 0.0;
    ++s.count;
  }
  const double n = static_cast<double>(s.count);
  s.rms = std::sqrt(s.rms / n);
  s.bias /= n;
  s.covered95 /= n;
  return s;
}

}  // namespace veridyn::aircraft::testing
