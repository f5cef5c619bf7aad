#include "veridyn/aircraft/simulation/flight_replay.hpp"

#include <cmath>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

/// Controls between two samples.
Controls<double> blended(const Controls<double>& a, const Controls<double>& b, double share) {
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  return {between(a.de, b.de), between(a.da, b.da), between(a.dr, b.dr), between(a.throttle, b.throttle),
          between(a.rotor_speed, b.rotor_speed)};
}

}  // namespace

FlightReplay::FlightReplay(const Recording& truth, double gravity) : gravity_(gravity) {
  const std::span<const double> times = truth.at(kTruthChannels.front().name).times();
  time_.assign(times.begin(), times.end());
  for (std::size_t i = 0; i < kTruthCount; ++i) {
    // What a flight does not have is not in its truth.
    const Channel* channel = truth.find(kTruthChannels[i].name);
    value_[i] = channel != nullptr ? channel->value : std::vector<double>(time_.size(), 0.0);
  }
}

std::vector<double> FlightReplay::flown(std::size_t signal) const { return value_[kReplaySignals[signal]]; }

Eigen::Vector3d FlightReplay::vector(Truth first, std::size_t sample) const {
  const auto i = static_cast<std::size_t>(first);
  return {value_[i][sample], value_[i + 1][sample], value_[i + 2][sample]};
}

RigidBodyState<double> FlightReplay::state(std::size_t sample) const {
  RigidBodyState<double> x;
  x.head<3>() = vector(Truth::kPosNorth, sample);
  x.segment<3>(3) = vector(Truth::kVelNorth, sample);
  x.segment<4>(6) = numerics::quaternion_from_euler(value(Truth::kRoll, sample), value(Truth::kPitch, sample),
                                                    value(Truth::kYaw, sample))
                        .coeffs();
  x.tail<3>() = vector(Truth::kGyroX, sample);
  return x;
}

Controls<double> FlightReplay::controls(std::size_t sample) const {
  return {value(Truth::kElevator, sample), value(Truth::kAileron, sample), value(Truth::kRudder, sample),
          value(Truth::kThrottle, sample), value(Truth::kEngineSpeed, sample)};
}

bool FlightReplay::fly(const Subject& subject, std::size_t begin, std::size_t end, Eigen::MatrixXd& signals) const {
  const MassProperties body(subject.mass, subject.inertia->matrix());
  signals.resize(signed_index(kReplaySignals.size()), signed_index(end - begin));
  RigidBodyState<double> x = state(begin);
  double lag = value(Truth::kDownwashLag, begin);
  for (std::size_t k = begin; k < end; ++k) {
    const double rho = standard_atmosphere(-x(2)).density;
    const Controls<double> now = controls(k);
    const Eigen::Vector3d wind = vector(Truth::kMeanWindNorth, k), gust = vector(Truth::kGustX, k);
    const Eigen::Vector3d omega = x.tail<3>();
    const Eigen::Vector3d v_r = R_body_from_ned(x) * (x.segment<3>(3) - wind) - gust;
    const Eigen::Vector3d turn = vector(Truth::kGustRateX, k);
    const AeroLoads<double> loads = aero_loads<double>(subject, v_r, omega + turn, now, rho, lag);
    const bool flies = x.allFinite() && std::abs(loads.air.alpha) <= 0.5 * kPi && omega.norm() <= 50.0;
    if (!flies) return false;
    const Eigen::Vector3d accel = loads.force / subject.mass;
    signals.col(signed_index(k - begin)) << omega, loads.air.alpha, loads.air.beta, loads.air.Va, accel;
    if (k + 1 == end) break;
    const Controls<double> next = controls(k + 1);
    const Eigen::Vector3d next_wind = vector(Truth::kMeanWindNorth, k + 1), next_gust = vector(Truth::kGustX, k + 1);
    const Eigen::Vector3d next_turn = vector(Truth::kGustRateX, k + 1);
    const double step = time_[k + 1] - time_[k];
    UnsteadyAir<double> air{.alpha = loads.air.alpha, .downwash_lag = lag};
    const auto rate = [&](double t, const RigidBodyState<double>& y) {
      const double share = (t - time_[k]) / step;
      const Eigen::Vector3d w = wind + share * (next_wind - wind), g = gust + share * (next_gust - gust);
      air.gust_rates = turn + share * (next_turn - turn);
      air.elapsed = t - time_[k];
      return aircraft_rate<double>(subject, body, y, blended(now, next, share), w, g, rho, gravity_, air);
    };
    x = numerics::runge_kutta_4_step(rate, time_[k], x, step);
    normalise_attitude(x);
    air.elapsed = step;
    lag = air.lag(subject.downwash, air_data<double>(R_body_from_ned(x) * (x.segment<3>(3) - next_wind) - next_gust));
  }
  return true;
}

}  // namespace veridyn::aircraft
