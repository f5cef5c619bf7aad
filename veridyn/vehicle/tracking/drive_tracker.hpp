#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/estimation/recursive/regression_tracker.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tracking/axle_rows.hpp"
#include "veridyn/vehicle/tracking/known_body.hpp"

namespace veridyn::vehicle {

/// How a vehicle is followed on line. Study table `[track]`: the keys of estimation::TrackerOptions and these.
struct DriveTrackOptions : estimation::TrackerOptions {
  double pass_Hz = 2.0;
  std::filesystem::path estimate_file;  ///< to start from; without it the subject's C_f and C_r
  double start_sigma = 0.3;             ///< relative, of the subject's stiffnesses
  double learning_s = 60.0;             ///< 0: a body that does not lean, with the I_z of the subject
  DriveTrackOptions();
  [[nodiscard]] static const KeyTable<DriveTrackOptions>& keys();
};

/// Their names, in the order of the enum.
inline constexpr EnumArray<TrackedAxle, std::string_view, kTrackedAxles> kTrackedAxleNames{"C_f", "C_r",
                                                                                           "understeer_gradient"};
/// Their units, in the same order.
inline constexpr EnumArray<TrackedAxle, std::string_view, kTrackedAxles> kTrackedAxleUnits{"N/rad", "N/rad",
                                                                                           "rad s^2/m"};

/// A change that one of the regressions revealed.
struct DriveChange {
  TrackedAxle axle = TrackedAxle::kFront;
  estimation::Change change;
};

/// History of the tracked parameters, in their units (the regressions' histories are those of compliances).
struct DriveTrackHistory {
  std::vector<double> time;
  std::vector<double> value, sigma;  ///< sigma infinite before it is usable
  std::vector<bool> held;            ///< not excited now: stays where it was
  std::vector<double> suspicion;     ///< of the change detector: 1 is an alarm
};

/// Where tracking begins.
struct DriveTrackStart {
  /// Mass, a and b as given; stiffnesses begin at its C_f and C_r.
  VehicleParameters<double> vehicle = {};
  KnownBody body = {};  ///< kNone: I_z is the vehicle's
  LeaningSensor sensor = {};
  const estimation::Estimate* estimate = nullptr;  ///< where C_f and C_r begin instead, with their error bars
};

/// Cornering stiffnesses tracked sample by sample.
///
/// The axles' equations with the lateral velocity eliminated by differentiation and the yaw inertia known (k = I_z/m):
///     d/dt(u delta) - a_y + r u - h phi'' - a r' = 1/C_f [m/(2L) d/dt(u (b a_y + k r'))] + const          (front)
///     r u - a_y - h phi'' + b r'                 = 1/C_r [m/(2L) d/dt(u (a a_y - k r'))] + const          (rear)
///     delta - L r/u = K a_y + T r' + const (understeer)
/// (the first two divided by the speed, so that their noise hardly depends on it), each a recursive regression with
/// forgetting, held where it is not excited (steady cornering excites only the last, straight driving none), watched
/// for changes. The constants are noise-free columns.
///
/// What the body does is followed beside (`BodyFollower`): its lean phi from the accelerometer, whose share of it,
/// g phi, is taken off a_y; and the left sides are delayed as the tyres' forces are. Of a car that leans by 5 deg per g
/// the equations without that gave stiffnesses 10 to 35 % low in lively driving, and too large a residual to see a
/// change in. Rows come from modulating kernels over the past: the estimate at time t is that of about `latency_s`
/// earlier, and no later sample enters. Work and memory per sample are bounded (but for the history). A hole of missing
/// or unusable samples (slower than `min_speed`) empties the filters; estimates stay.
class DriveTracker {
 public:
  /// @param noise standard deviation of one sample's white noise of steer, speed, yaw_rate, accel_y
  DriveTracker(const DriveTrackStart& start, const DriveTrackOptions& options, double min_speed_mps, double rate_Hz,
               const std::array<double, 4>& noise);

  /// Whether there is a row. Before it the values are those of the start.
  [[nodiscard]] bool started() const { return !trackers_.empty(); }

  /// Takes the next sample, `1/rate` after the last one (a larger step is a hole).
  /// @return the changes that it reveals
  std::vector<DriveChange> append(const DriveSample& sample);

  /// By how much the estimates lag behind the last sample [s].
  [[nodiscard]] double latency_s() const;
  [[nodiscard]] double rate_Hz() const { return rate_Hz_; }
  /// Of the regressions' rows, which are fewer than the samples.
  [[nodiscard]] double row_rate_Hz() const { return rate_Hz_ / static_cast<double>(stride_); }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] double last_time() const { return last_; }  ///< of the last sample; -infinity before
  /// Of C_f0/C_f, C_r0/C_r or the understeer gradient over K_0 = m/(2L) (b/C_f0 + a/C_r0), where 0 is the start.
  /// Only when started.
  [[nodiscard]] const estimation::RegressionTracker& regression(TrackedAxle axle) const;
  [[nodiscard]] const DriveTrackHistory& history(TrackedAxle axle) const;
  /// All that were found, by time.
  [[nodiscard]] const std::vector<DriveChange>& changes() const { return changes_; }
  /// Latest value and standard deviation, in the units of the history; those of the start before the first
  /// row.
  [[nodiscard]] double value(TrackedAxle axle) const;
  [[nodiscard]] double sigma(TrackedAxle axle) const;
  [[nodiscard]] const VehicleParameters<double>& start() const { return start_; }
  [[nodiscard]] const KnownBody& body() const { return body_; }
  /// The latest estimates, for estimate.json, judged by their rows and those of the recording.
  [[nodiscard]] estimation::Estimate estimate(const std::string& subject,
                                              std::span<const estimation::Evidence> recording = {}) const;

 private:
  void take_rows(std::vector<DriveChange>& found);
  void follow_grip();
  void weigh_saturation(const AxleRowSet& rows);
  void begin(double speed);
  void remember(double time);

  [[nodiscard]] double scale(TrackedAxle axle) const;
  [[nodiscard]] double begin_value(TrackedAxle axle) const;
  [[nodiscard]] double begin_sigma(TrackedAxle axle) const;
  /// Of the regression, with the body taken as known exactly.
  [[nodiscard]] double followed_sigma(TrackedAxle axle) const;
  /// What is not known of the body adds.
  [[nodiscard]] double body_sigma(TrackedAxle axle) const;

  VehicleParameters<double> start_;
  KnownBody body_;
  DriveTrackOptions options_;
  double min_speed_;
  double rate_Hz_;
  std::array<double, 4> noise_;
  double sigma_f_, sigma_r_;  // relative, at the start
  std::string begin_text_;
  AxleRows axle_rows_;
  std::array<double, 2> grip_{1.0, 1.0};
  /// Sums over the memory of the squares of forces, and of saturation weighed by them.
  std::array<double, 2> force_power_{}, saturated_power_{};
  std::size_t stride_ = 1;
  std::size_t since_row_ = 0;
  std::size_t rows_ = 0;
  double last_ = -kInfinity;
  double next_history_ = -kInfinity;
  std::vector<estimation::RegressionTracker> trackers_;
  EnumArray<TrackedAxle, DriveTrackHistory, kTrackedAxles> history_;
  std::vector<DriveChange> changes_;
};

}  // namespace veridyn::vehicle
