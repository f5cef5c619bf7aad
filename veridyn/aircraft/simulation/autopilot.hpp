#pragma once

#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/aircraft/sensors/flight_truth.hpp"
#include "veridyn/aircraft/simulation/flight_plan.hpp"

namespace veridyn::aircraft {

/// A pilot made of simple loops on the true state, to keep the simulated aircraft where it should be.
///
/// Height error -> climb rate -> pitch -> pitch rate -> elevator; airspeed -> throttle; heading error (or the bank of a
/// turn) -> bank -> roll rate -> aileron; rudder damps yaw and coordinates turns. Gains are set in terms of the motion
/// (1/s) and divided by the effectiveness of each control in the linear model, so that they hold for any aircraft and
/// sign convention. While a surface is excited, its feedback is multiplied by `excitation_gain`.
class Autopilot {
 public:
  Autopilot(const Subject& subject, const Trim& trim, const LinearModel& model, double height, double heading,
            double excitation_gain);

  /// Commands in the order of Surface, to be held over `step` seconds.
  [[nodiscard]] PerSurface<double> command(double t, double step, const TruthSample& truth,
                                           const Excitation& excitation);

 private:
  Trim trim_;
  LinearModel model_;
  PerSurface<Actuator> limits_;
  double down_;  ///< desired position [m]
  double heading_;
  double excitation_gain_;
  bool turning_ = false;
  double pitch_integral_ = 0.0;
  double throttle_integral_ = 0.0;
  double airspeed_;
};

}  // namespace veridyn::aircraft
