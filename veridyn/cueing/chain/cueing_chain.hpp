#pragma once

#include <bitset>
#include <memory>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/cueing/platform/platform_guard.hpp"
#include "veridyn/cueing/platform/platform_simulator.hpp"
#include "veridyn/cueing/washout/washout.hpp"

namespace veridyn::cueing {

/// What became of one sample.
struct CueingStep {
  PlatformCommand desired;                  ///< by the algorithm
  PlatformState ordered;                    ///< by the guard
  PlatformState reached;                    ///< by the platform
  std::bitset<kPlatformAxes> limited = {};  ///< axes that the guard held back
  double leg_speed = 0.0;                   ///< of the fastest leg [m/s]; 0 of a platform without
};

/// Everything between the vehicle's motion and the rider: algorithm, guard, legs and actuators, one sample at a time.
/// An algorithm that takes over from another, or begins again, joins where the platform is: the difference dies away
/// within two seconds. Nothing is allocated or thrown by `step`.
class CueingChain {
 public:
  /// @throws InputError as `Platform::validate`.
  CueingChain(std::unique_ptr<Washout> washout, const Platform& platform);
  CueingChain(const CueingChain& other);
  CueingChain(CueingChain&&) = default;
  CueingChain& operator=(CueingChain&&) = default;
  CueingChain& operator=(const CueingChain&) = delete;
  ~CueingChain() = default;

  /// The platform at rest in its neutral position.
  CueingStep reset(const recording::MotionSample& sample);
  /// @param share of the algorithm's command that the platform is given, 0 to 1: 0 leads it to its neutral position
  CueingStep step(const recording::MotionSample& sample, double step, double share = 1.0);
  /// Without a sample: the algorithm stands still and the platform follows a share of its last command.
  CueingStep hold(double step, double share);
  /// The platform stops as fast as its limits allow, and stays there.
  CueingStep brake(double step);
  /// The algorithm begins again with this sample, from where the platform is.
  void restart(const recording::MotionSample& sample, double share = 1.0);
  /// Another algorithm, which begins with this sample, from where the platform is. @param share as `step`
  /// @return the one before, so that whoever is in a hurry need not free it
  std::unique_ptr<Washout> take_over(std::unique_ptr<Washout> washout, const recording::MotionSample& sample,
                                     double share = 1.0);
  [[nodiscard]] const PlatformGuard& guard() const { return guard_; }
  [[nodiscard]] const Washout& washout() const { return *washout_; }

 private:
  /// Leads guard and platform after a share of what the algorithm wants.
  CueingStep follow(double step, double share);

  std::unique_ptr<Washout> washout_;
  PlatformGuard guard_;
  PlatformSimulator simulator_;
  /// Leads guard and platform after what the algorithm wants.
  PlatformCommand desired_;    ///< last, by the algorithm itself
  PlatformCommand joined_at_;  ///< by how much the command differed where the algorithm began
  double since_joined_ = 0.0;  ///< [s]
};

/// A drive on a platform: a value a sample of the vehicle.
struct CueingRun {
  std::string algorithm;
  std::vector<recording::MotionSample> vehicle;  ///< at the driver's head, frd
  std::vector<recording::MotionSample> rider;    ///< at the rider's head, platform's axes (frd)
  std::vector<CueingStep> steps;
  std::string account;  ///< of the algorithm's own work, see `Washout::account`
};

/// The samples of a drive through the chain. @param vehicle at the driver's head, stamps growing
/// @return up to where `progress` was interrupted
[[nodiscard]] CueingRun drive_platform(const std::vector<recording::MotionSample>& vehicle, const Washout& washout,
                                       const Platform& platform, Progress& progress);

}  // namespace veridyn::cueing
