#pragma once

#include <Eigen/Core>

#include "veridyn/live/telemetry/even_motion.hpp"
#include "veridyn/live/telemetry/packet_intake.hpp"

namespace veridyn::live {

/// When the signs of the telemetry are checked.
enum class SignCheck {
  kBefore,  ///< the platform stays parked until they are seen to be right
  kWhile,   ///< it starts at once and parks where they are seen to be wrong
  kOff,
};

/// How a rig runs.
struct RigOptions {
  double rate = 100.0;             ///< of orders to the platform [Hz]
  double soft_start = 3.0;         ///< until the platform follows the whole motion [s]
  double hold = 0.5;               ///< how long the last command stands without telemetry [s]
  double fade = 3.0;               ///< on the way to park [s]
  double lost_after = 0.25;        ///< without an accepted packet [s]
  double frozen_after = 1.0;       ///< with packets that say the same motion of a vehicle that moves [s]
  bool answers = true;             ///< whether the platform answers orders
  double unanswered_after = 0.25;  ///< the platform counts as lost [s]
  double slowest_packets = 20.0;   ///< fewer are no motion to follow [Hz]
  double spikes = 500.0;           ///< most change of a specific force, above that it is a crash or a landing [m/s^3]
  SignCheck signs = SignCheck::kBefore;
  IntakeOptions intake;
  EvenMotionOptions even;
  Eigen::Vector3d sensor =
      Eigen::Vector3d::Zero();  ///< where the motion is measured, from the centre of gravity, flu [m]
  Eigen::Vector3d driver = Eigen::Vector3d::Zero();  ///< the driver's head [m]
};

}  // namespace veridyn::live
