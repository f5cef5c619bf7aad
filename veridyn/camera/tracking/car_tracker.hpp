#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/camera/tracking/car_motion_model.hpp"
#include "veridyn/camera/tracking/marker_pose.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"

namespace veridyn::camera {

/// How a car is followed from frame to frame.
struct TrackerOptions {
  BlobOptions blobs{};
  MarkerLayout layout{};
  CarMotionModel motion{};
  /// A pose counts as the car's where its squared distance from the prediction, in its covariance, is below this: the
  /// chi-square quantile of 99.9 % with three degrees of freedom, and that of the markers' distances likewise.
  double gate_probability = 0.999;
  double lost_after_s = 2.0;    ///< without a measurement: the car is looked for everywhere again
  double lost_sigma_m = 1.0;    ///< of the predicted place: the same
  double longest_step_s = 1.0;  ///< between frames: a longer one is a break, after which the car is looked for again
  /// Heading within 90 degrees at the start [rad]; needed with two markers, which look the same from both ends.
  std::optional<double> first_heading{};

  /// @throws InputError naming the option
  void validate() const;
  [[nodiscard]] static const KeyTable<TrackerOptions>& keys();
};

/// How a pose came about.
enum class TrackStatus {
  kLost,       ///< the car was not seen yet, or not for too long: the pose is unknown
  kPredicted,  ///< not recognised in this frame: the pose is the prediction
  kMeasured,   ///< recognised in this frame
};

/// What is known of the car at a frame.
struct TrackedPose {
  double time = 0.0;  ///< [s], middle of the exposure
  TrackStatus status = TrackStatus::kLost;
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();        ///< x, y [m], heading [rad], filtered
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of it, with that of the map
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();    ///< forward, left [m/s], yaw rate [rad/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
  std::optional<PoseMeasurement> measured{};  ///< from this frame alone
};

/// Follows a car by its bright markers, frame by frame.
///
/// In each frame the spots that can be its markers are taken together: sets whose distances are those of the layout and
/// whose pose agrees with the prediction, three markers before two, and of two sets that agree equally well none. A
/// first pose needs all markers and must be the only one. A frame without a set leaves the prediction, whose covariance
/// grows. Two of three markers are taken only where the prediction is closer than the markers are apart.
///
/// The covariance of a measured pose is that of its pixels times a factor from the misfit of all three markers in the
/// frames so far, (n0 + sum chi-square) / (n0 + sum of degrees of freedom) with n0 = 30: what the noise of the dark
/// pixels does not know shows there. Does not allocate once it has seen the largest picture.
class CarTracker {
 public:
  /// @throws InputError as the options, and where the calibration does not know its error
  CarTracker(const Calibration& calibration, const TrackerOptions& options);

  /// The frame exposed around `time` [s], which must be after the one before.
  /// @throws InputError("frame", ...) where the time is not
  TrackedPose add(double time, const GreyView& frame);
  /// The same from spots that were found elsewhere.
  TrackedPose add(double time, std::span<const Blob> blobs);
  /// The same from poses that the car may have in the frame, of which one is right at most (SilhouetteFinder): the one
  /// that agrees with the prediction; at the start the one whose heading is within 90 degrees of `first_heading`, or
  /// the only one.
  TrackedPose add(double time, std::span<const PoseMeasurement> candidates);

  /// The factor on the covariance of the pixels.
  [[nodiscard]] double variance_factor() const noexcept { return (kPrior + misfit_) / (kPrior + freedom_); }

 private:
  using Filter = estimation::ExtendedKalmanFilter<CarMotionModel>;

  /// To the time of a frame.
  void begin(double time);
  /// The outcome of a frame, with what was measured.
  [[nodiscard]] TrackedPose finish(double time, std::optional<PoseMeasurement> measured);
  [[nodiscard]] std::optional<PoseMeasurement> recognise(std::size_t markers, bool predicted);
  [[nodiscard]] std::optional<PoseMeasurement> found_again(double time, std::span<const PoseMeasurement> candidates);
  /// Squared distance of a pose from the prediction.
  [[nodiscard]] double distance(const PoseMeasurement& pose, double factor) const;
  void start(const PoseMeasurement& measured);
  [[nodiscard]] bool close() const noexcept;
  void scale(PoseMeasurement& measured);
  void correct(double time, const PoseMeasurement& measured);

  Calibration calibration_;
  TrackerOptions options_;
  BlobFinder finder_;
  std::vector<Spot> spots_;
  Filter filter_;
  std::array<estimation::InnovationMonitor, 3> monitors_{};
  std::array<double, 4> fit_gate_{};  ///< by the number of markers
  static constexpr double kPrior = 30.0;
  double pose_gate_ = 0.0, misfit_ = 0.0, freedom_ = 0.0;
  Eigen::Matrix3d map_ = Eigen::Matrix3d::Zero();
  double time_ = 0.0, seen_ = 0.0;
  Eigen::Vector2d lost_place_ = Eigen::Vector2d::Zero();  ///< of a candidate since the car was lost
  double lost_time_ = -1e9;
  bool begun_ = false, following_ = false, followed_ = false;
};

}  // namespace veridyn::camera
