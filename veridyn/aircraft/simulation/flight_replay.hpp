#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/sensors/flight_truth.hpp"
#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// What a replay gives: body rates, flow angles, airspeed, specific force at the centre of gravity.
inline constexpr std::array<Truth, 9> kReplaySignals = {Truth::kGyroX,  Truth::kGyroY,  Truth::kGyroZ,
                                                        Truth::kAlpha,  Truth::kBeta,   Truth::kAirspeed,
                                                        Truth::kAccelX, Truth::kAccelY, Truth::kAccelZ};
/// Their names in results, in the same order.
inline constexpr std::array<std::string_view, kReplaySignals.size()> kReplayNames = {
    "p", "q", "r", "alpha", "beta", "airspeed", "accel_x", "accel_y", "accel_z"};

/// A simulated flight that another aircraft can fly again, open loop: from a state of the flight on with the same
/// deflections, throttle and rotor speed, through the same wind and gusts as functions of time. No pilot corrects it,
/// so that what differs is the aircraft; it diverges from the flight the longer it lasts.
class FlightReplay {
 public:
  /// @param truth  of `simulate`, which has every channel of kTruthChannels on one time base
  FlightReplay(const Recording& truth, double gravity);

  [[nodiscard]] std::size_t samples() const { return time_.size(); }
  [[nodiscard]] double time(std::size_t sample) const { return time_[sample]; }
  /// Signals of kReplaySignals in the flight itself.
  [[nodiscard]] std::vector<double> flown(std::size_t signal) const;

  /// A row a signal of kReplaySignals, a column a sample of the flight from `begin` to before `end`, by the
  /// fourth-order Runge-Kutta method over the flight's samples, controls and gusts linear in between. False where the
  /// aircraft departs: angle of attack beyond 90 deg, rates beyond 50 rad/s, or not finite.
  /// @param subject  with inertia and a value of every parameter
  [[nodiscard]] bool fly(const Subject& subject, std::size_t begin, std::size_t end, Eigen::MatrixXd& signals) const;

 private:
  [[nodiscard]] RigidBodyState<double> state(std::size_t sample) const;
  [[nodiscard]] Controls<double> controls(std::size_t sample) const;
  [[nodiscard]] Eigen::Vector3d vector(Truth first, std::size_t sample) const;
  [[nodiscard]] double value(Truth t, std::size_t sample) const { return value_[t][sample]; }

  std::vector<double> time_;
  EnumArray<Truth, std::vector<double>, kTruthCount> value_;
  double gravity_;
};

}  // namespace veridyn::aircraft
