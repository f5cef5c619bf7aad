#pragma once

#include <memory>
#include <optional>
#include <string>

#include "veridyn/cueing/platform/platform_command.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing {

/// Time since the last sample [s]; nothing: the beginning.
using SampleStep = std::optional<double>;

/// View of a sample: what an algorithm knows of the vehicle, at the driver's head in axes forward, right, down.
struct VehicleMotion {
  Eigen::Vector3d force;         ///< specific force [m/s^2]
  Eigen::Vector3d acceleration;  ///< [m/s^2]; without a recorded attitude the vehicle is taken for level
  Eigen::Vector3d rate;          ///< angular rate [rad/s]
  /// The sample that they were taken from, its values finite.
  const recording::MotionSample* sample;
};

/// A washout algorithm: motion of the vehicle at the driver's head in, motion of the platform out, one sample at a
/// time. It knows nothing of clocks and files; after construction nothing is allocated or thrown.
class Washout {
 public:
  virtual ~Washout() = default;

  /// Begins at the platform's neutral position, in whatever motion: what the vehicle does at this moment is led in
  /// over the first two seconds, so that nothing jumps.
  PlatformCommand reset(const recording::MotionSample& sample);
  /// Values that are not finite stand for those of the sample before; forces and rates beyond what a vehicle can do
  /// (1000 m/s^2, 100 rad/s) for these.
  /// @param step since the last sample [s]; below zero or not finite: none; beyond 10 s: 10 s
  PlatformCommand step(const recording::MotionSample& sample, double step);
  /// A copy with its state.
  [[nodiscard]] virtual std::unique_ptr<Washout> clone() const = 0;
  /// How its own work went since the beginning, in words; nothing of most.
  [[nodiscard]] virtual std::string account() const { return {}; }

 protected:
  Washout() = default;
  Washout(const Washout&) = default;
  Washout& operator=(const Washout&) = default;

 private:
  /// @param motion all values finite; at the beginning that of a vehicle that stands on level ground
  virtual PlatformCommand next(const VehicleMotion& motion, SampleStep step) = 0;
  /// Takes the sample, its values made usable, for the last one.
  void take(const recording::MotionSample& sample);
  [[nodiscard]] VehicleMotion led_in() const;

  recording::MotionSample last_;
  VehicleMotion at_reset_ = {};  ///< less that of a vehicle that stands
  double since_reset_ = 0.0;     ///< [s]
};

}  // namespace veridyn::cueing
