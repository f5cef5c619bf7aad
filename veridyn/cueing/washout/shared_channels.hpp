#pragma once

#include <array>

#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/washout/washout_channels.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// Knobs of what most algorithms do alike: the vehicle's turns and its heave.
struct SharedKnobs {
  std::array<double, 3> force_gain = {0.6, 0.6, 0.5};  ///< surge, sway, heave
  std::array<double, 3> rate_gain = {0.6, 0.6, 0.6};   ///< roll, pitch, yaw
  std::array<double, 3> turn = {1.0, 0.8, 1.0};        ///< high-pass of the rates, second order [rad/s]
  double heave_onset = 1.0;                            ///< high-pass of heave, second order [rad/s]
  double heave_recentre = 0.2;                         ///< a further first-order one [rad/s]; 0: none
  double tilt_rate = 3.0 * kDegree;                    ///< greatest rate of tilt coordination [rad/s]
  double zeta = 1.0;                                   ///< damping ratio of all second-order filters

  void add_to(std::vector<Knob>& knobs);
};

/// Turns and heave of the classical algorithm, for algorithms that treat surge and sway in a way of their own.
class SharedChannels {
 public:
  explicit SharedChannels(const SharedKnobs& knobs);
  /// Sets heave and adds the turns to the command's angles. @param a acceleration, forward, right, down [m/s^2]
  void add_to(PlatformCommand& command, const Eigen::Vector3d& a, const Eigen::Vector3d& rate, SampleStep step);

 private:
  double heave_gain_;
  std::array<double, 3> rate_gain_;
  ShiftChannel heave_;
  std::array<TurnChannel, 3> turn_;
};

/// What a pair of axes renders: the force that tilt can stand for and the acceleration that shift can stand for
/// [m/s^2]. Pairs are surge with pitch, and sway with roll; both are written as if the force pointed forward: of sway
/// and roll everything is to the left.
using PairedInput = Eigen::Vector2d;
/// What a pair of axes is to do, written like its input.
struct PairedOutput {
  double shift = 0.0, acceleration = 0.0;  ///< [m], [m/s^2]
  double tilt = 0.0, tilt_rate = 0.0;      ///< [rad], [rad/s]
};
/// 0: sway and roll; 1: surge and pitch. @param a acceleration, forward, right, down [m/s^2]
[[nodiscard]] PairedInput paired_input(const Eigen::Vector3d& force, const Eigen::Vector3d& a, Eigen::Index pair);
/// Adds it to the command's angle and sets its shift.
void add_paired(PlatformCommand& command, const PairedOutput& output, Eigen::Index pair);
/// The axis of the pair that shifts.
[[nodiscard]] constexpr PlatformAxis shift_axis(Eigen::Index pair) {
  return pair == 0 ? PlatformAxis::kSway : PlatformAxis::kSurge;
}
/// The axis of the pair that turns.
[[nodiscard]] constexpr PlatformAxis tilt_axis(Eigen::Index pair) {
  return pair == 0 ? PlatformAxis::kRoll : PlatformAxis::kPitch;
}

}  // namespace veridyn::cueing
