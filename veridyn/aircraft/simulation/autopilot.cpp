#include "veridyn/aircraft/simulation/autopilot.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

namespace {

/// 1/b, or 0 for a control without effect.
double inverse(double b) { return std::abs(b) > 1e-3 ? 1.0 / b : 0.0; }

}  // namespace

Autopilot::Autopilot(const Subject& s, const Trim& trim, const LinearModel& model, double height, double heading,
                     double excitation_gain)
    : trim_(trim),
      model_(model),
      limits_{{s.elevator, s.aileron, s.rudder, s.throttle}},
      down_(-height),
      heading_(heading),
      excitation_gain_(excitation_gain),
      airspeed_(trim.condition.airspeed) {}

PerSurface<double> Autopilot::command(double t, double step, const TruthSample& x, const Excitation& excitation) {
  const double Va = trim_.condition.airspeed;
  const double g = trim_.condition.gravity;
  const PerSurface<bool> excited = excitation.excited(t);
  const double longitudinal = excited[0] ? excitation_gain_ : 1.0;
  const double lateral = excited[1] || excited[2] ? excitation_gain_ : 1.0;
  const double engine = excited[3] ? excitation_gain_ : 1.0;
  const double phi = x[Truth::kRoll], theta = x[Truth::kPitch];

  // Bank: that of the turn, otherwise back to the heading; after a turn the new heading is kept.
  const double bank = excitation.bank(t);
  double phi_desired = 0.0;
  if (std::isfinite(bank)) {
    phi_desired = bank;
    turning_ = true;
  } else {
    if (turning_) heading_ = x[Truth::kYaw];
    turning_ = false;
    const double error = std::remainder(heading_ - x[Truth::kYaw], kFullTurn);
    phi_desired = std::clamp(0.8 * error, -25 * kDegree, 25 * kDegree);
  }
  const double p_desired = std::clamp(1.5 * (phi_desired - phi), -40 * kDegree, 40 * kDegree);
  const double p_effect = inverse(model_.B(3, 1));
  const double da =
      trim_.controls.da + lateral * p_effect * (-model_.A(3, 3) * p_desired + 2.0 * (p_desired - x[Truth::kGyroX]));
  const double turn_rate = g / Va * std::sin(phi) * std::cos(theta);
  const double dr = trim_.controls.dr +
                    lateral * inverse(model_.B(5, 2)) * (-model_.A(5, 5) * turn_rate - (x[Truth::kGyroZ] - turn_rate));

  // Height.
  const double climb = -x[Truth::kVelDown];
  const double climb_desired = std::clamp(0.2 * (x[Truth::kPosDown] - down_), -2.0, 2.0);
  const double path_error = (climb_desired - climb) / Va;
  pitch_integral_ = std::clamp(pitch_integral_ + 0.2 * longitudinal * path_error * step, -10 * kDegree, 10 * kDegree);
  const double load = 1.0 / std::max(0.5, std::cos(phi));
  const double theta_desired =
      std::clamp(trim_.theta + pitch_integral_ + 0.8 * path_error + (load - 1.0) * std::max(0.0, trim_.alpha + 0.1),
                 trim_.theta - 15 * kDegree, trim_.theta + 15 * kDegree);
  const double q_turn = turn_rate * std::tan(phi);
  const double q_desired = std::clamp(1.5 * (theta_desired - theta), -20 * kDegree, 20 * kDegree) + q_turn;
  const double de = trim_.controls.de + longitudinal * inverse(model_.B(4, 0)) *
                                            (4.0 * (q_desired - x[Truth::kGyroY]) - model_.A(4, 4) * q_turn);

  // Speed, through a filter of one second so that gusts do not move the throttle.
  airspeed_ += std::min(1.0, step) * (x[Truth::kAirspeed] - airspeed_);
  const double thrust_effect = inverse(model_.B(0, 3));
  const double speed_error = Va - airspeed_;
  throttle_integral_ = std::clamp(throttle_integral_ + 0.08 * engine * thrust_effect * speed_error * step, -0.5, 0.5);
  const double throttle = trim_.controls.throttle + throttle_integral_ + 0.5 * engine * thrust_effect * speed_error;

  PerSurface<double> out{{de, da, dr, throttle}};
  const PerSurface<double> extra = excitation.at(t);
  for (const Surface s : enumerators<Surface, kSurfaces>())
    out[s] = std::clamp(out[s] + extra[s], limits_[s].lower, limits_[s].upper);
  return out;
}

}  // namespace veridyn::aircraft
