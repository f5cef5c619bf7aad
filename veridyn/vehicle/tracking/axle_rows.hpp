#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tracking/known_body.hpp"

namespace veridyn::vehicle {

/// What is followed.
enum class TrackedAxle : std::size_t {
  kFront,      ///< compliance of the front axle: C_f
  kRear,       ///< of the rear axle: C_r
  kUndersteer  ///< understeer gradient, from quasi-steady cornering too
};
/// How many quantities are followed.
inline constexpr std::size_t kTrackedAxles = 3;
/// All of them, in order.
inline constexpr auto kAllTrackedAxles = enumerators<TrackedAxle, kTrackedAxles>();

/// One sample of a drive, all at one moment; NaN where missing.
struct DriveSample {
  double time = 0.0;
  /// SI, ISO 8855; accel_y at the centre of gravity, but for what a leaning body adds to it (`LeaningSensor`).
  double steer = 0.0, speed = 0.0, yaw_rate = 0.0, accel_y = 0.0;
};

/// What an accelerometer that is fixed to a leaning body shows beside the lateral acceleration: g phi - z phi''.
struct LeaningSensor {
  double gravity = 0.0;  ///< g; 0 where gravity's share was taken off [m/s^2]
  double height = 0.0;   ///< z of the sensor above the centre of gravity [m]
};

/// A sample with what lean and lagging tyres do to it taken off, so that the equations of a bicycle hold.
struct BicycleSample {
  double accel_y = 0.0;  ///< of the centre of gravity, v' + r u [m/s^2]
  double shifted = 0.0;  ///< load, as `forces_without_limit` has it [rad]
  /// What makes slip angles, as late as the tyres are: steering, yaw rate over speed, steering times speed, yaw rate,
  /// and the rate at which the contact points move sideways, v' + h phi''.
  double steer = 0.0, curvature = 0.0, speed_steer = 0.0, yaw_rate = 0.0, contact_rate = 0.0;
};

/// Follows body and tyres sample by sample, by the trapezoidal rule: in a pass band of 2 Hz at 100 Hz that is 0.13 % of
/// the phase off.
class BodyFollower {
 public:
  BodyFollower(const KnownBody& body, const LeaningSensor& sensor, double step_s);
  /// At rest in the lean of this sample, slips as they are.
  BicycleSample begin(const DriveSample& sample);
  /// A step after the last sample.
  BicycleSample next(const DriveSample& sample);
  /// After which a beginning that was not at rest is forgotten to 2 % [s].
  [[nodiscard]] double settling_s() const;

 private:
  static constexpr std::size_t kLagging = 5;
  using Slips = std::array<double, kLagging>;
  [[nodiscard]] double lean_acceleration(double accel_y, double lean, double lean_rate) const;
  [[nodiscard]] double lateral(double accel_y) const;
  [[nodiscard]] Slips slips(const DriveSample& sample) const;
  [[nodiscard]] BicycleSample corrected(const DriveSample& sample) const;

  KnownBody body_;
  LeaningSensor sensor_;
  double step_;
  double per_lean_ = 1.0;  ///< 1 - frequency^2 gradient z
  double lean_ = 0.0, lean_rate_ = 0.0, lean_acceleration_ = 0.0;
  double speed_ = 0.0;
  Slips input_{}, slip_{};
};

/// A row [x, z] of one regression.
template <std::size_t kColumns>
struct AxleRow {
  std::array<double, kColumns> x{};
  double z = 0.0;
};
/// The rows of one moment; the last column of each is 1, for a constant.
struct AxleRowSet {
  double time = 0.0;
  std::array<double, 2> force{};       ///< of one tyre, front and rear [N]
  std::array<double, 2> saturation{};  ///< share by which its slip is larger than without a limit
  AxleRow<2> front, rear;
  AxleRow<3> understeer;
};

/// Rows of the axles' regressions from modulating kernels over the past; see `DriveTracker` for the equations. The rows
/// are those of the moment `latency_s` before the last sample. Nothing is allocated after the construction.
class AxleRows {
 public:
  /// @param vehicle mass, a, b, I_z; its C_f and C_r are the units of the compliances
  AxleRows(const VehicleParameters<double>& vehicle, const KnownBody& body, const LeaningSensor& sensor, double rate_Hz,
           double pass_Hz);

  /// Takes the next sample; one with a NaN counts as a hole.
  /// @return whether there are rows
  bool append(const DriveSample& sample);
  /// Front and rear, times what the body was known with: the tyres' curves are as much higher at every slip, as they
  /// are where grip changes. 1 at first.
  void set_grip(const std::array<double, 2>& grip) { grip_ = grip; }
  /// Forgets all samples: what follows does not adjoin.
  void empty();
  [[nodiscard]] AxleRowSet rows() const;
  /// Covariance of what white noise of steer, speed, yaw_rate and accel_y (standard deviations of a sample) does to a
  /// row [x, z] at a speed. What body and tyres do to the noise within the pass band is neglected: near the frequency
  /// of roll it changes the accelerometer's part by some ten per cent.
  [[nodiscard]] Eigen::MatrixXd noise_covariance(TrackedAxle axle, const std::array<double, 4>& noise,
                                                 double speed) const;
  [[nodiscard]] double speed() const;  ///< smoothed, of the rows' moment [m/s]
  [[nodiscard]] double latency_s() const;
  /// m/(2 L) (b/C_f + a/C_r): the understeer gradient is followed in units of it [rad/(m/s^2)].
  [[nodiscard]] double understeer_scale() const;
  /// I_z/(2 L) (1/C_f + 1/C_r): the unit of the lag of the yaw rate [s^2].
  [[nodiscard]] double lag_scale() const;

 private:
  static constexpr std::size_t kColumns = 11;
  /// Of one tyre of each axle, and what those without a limit would push with; at the rows' moment, and the rates.
  struct Forces {
    std::array<double, 2> force{}, unlimited{}, speed_rate{};  ///< [N], [N], d/dt(u unlimited)
  };
  [[nodiscard]] Forces forces() const;
  [[nodiscard]] double filtered(std::size_t column, const numerics::FirKernel& kernel) const;

  VehicleParameters<double> vehicle_;
  AnyRollingBicycle tyres_;
  std::array<double, 2> grip_{1.0, 1.0};
  double accel_scale_, steer_scale_;
  double rate_Hz_;
  numerics::ModulatingKernel kernel_;
  BodyFollower follower_;
  std::vector<std::array<double, kColumns>> ring_;
  std::size_t settling_ = 0;  ///< samples after a hole that are not used
  std::size_t since_hole_ = 0;
  std::size_t next_ = 0;
  double last_ = -kInfinity;
};

}  // namespace veridyn::vehicle
