#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "veridyn/aircraft/reconstruction/air_data_measurement.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"

/// Inside of reconstruct.cpp: the filter going through one segment, event by event.
namespace veridyn::aircraft::internal {

/// What is known of the innovations of all sensors.
using Monitors = EnumArray<Sensor, estimation::InnovationMonitor, kSensors>;

/// Of attitude, ground velocity and pitot tube, which alone correct what they measure, the one that no longer corrects
/// it. Vanes are not among them: without one the gust model bounds its angle.
[[nodiscard]] inline std::optional<Sensor> lost_sensor(const Monitors& monitors) {
  for (const Sensor which : {kRoll, kPitch, kYaw, kVelNorth, kVelEast, kVelDown, kPitot})
    if (monitors[which].lost()) return which;
  return std::nullopt;
}

/// The innovation of a sensor's sample.
struct SensorInnovation : estimation::Innovation {
  Sensor sensor{};
  bool offered = false;  ///< else it is not to be used where it is (a vane at rest)
};

/// View of what does not change along a run: streams, options and stamps must outlive it.
struct RunSetting {
  const FlightStreams* streams;
  const ReconstructOptions* options;
  ModelBasedMotion motion;              ///< of which the model-free filter takes the kinematics
  const std::vector<double>* output_t;  ///< stamps of results over all segments
  /// Errors of the air data that are taken as known (see AirDataErrorVector).
  Eigen::Matrix<double, 5, 1> air_error = Eigen::Matrix<double, 5, 1>::Zero();
};

/// The state at the first output of a segment, before any measurement but those that start it.
struct Start {
  AirDataState<double> x;
  /// Of the error vector that all filters share; that of the gusts is `AirDataMotion::stationary_gust_covariance`.
  Eigen::Matrix<double, AirDataErrorVector::kFull, 1> variance =
      Eigen::Matrix<double, AirDataErrorVector::kFull, 1>::Zero();
  /// Covariance of the attitude's error, in place of `variance`, where its angles are not known alike.
  std::optional<Eigen::Matrix3d> attitude = {};
};
/// From the first attitude, ground velocity and air data of the segment; see `reconstruct`.
[[nodiscard]] Start start_of(const RunSetting& setting, const Segment& segment);

/// Median of the samples in [from, from + window]; NaN when there are none.
[[nodiscard]] double median_within(const Stream& s, double from, double window);

/// View of the samples of all sensors in the order of their stamps: the streams and stamps must outlive it.
class EventCursor {
 public:
  /// `first_output` is the index in `output_t` of the first stamp of the segment.
  EventCursor(const FlightStreams& streams, const std::vector<double>& output_t, const Segment& segment,
              std::size_t first_output);

  /// Time of the next event; NaN at the end of the segment.
  [[nodiscard]] double next_time() const;

  /// Inertial measurements, and controls where `with_controls`, from here to `time`.
  void fill(AirDataInput& u, double time, bool with_controls);

  /// What a sample at the present time means. The gyro is the one of the last step's middle.
  [[nodiscard]] MeasurementContext context(const ReconstructOptions& o, bool with_controls);

  /// To `time`; calls `sample(sensor, value, sigma)` for each that is due, the attitude first.
  template <class OnSample>
  void step_to(double time, OnSample&& sample) {
    t_ = time;
    const FlightStreams& s = *streams_;
    while (next_gyro_ < s.gyro.t.size() && s.gyro.t[next_gyro_] <= t_) ++next_gyro_;
    while (next_accel_ < s.accel.t.size() && s.accel.t[next_accel_] <= t_) ++next_accel_;
    for (const Sensor which : enumerators<Sensor, kSensors>()) {
      const Stream& stream = s.sensors[which];
      std::size_t& next = next_[which];
      for (; next < stream.t.size() && stream.t[next] <= t_; ++next) sample(which, stream.v[next], stream.sigma);
    }
    at_output_ = next_output_ < output_t_->size() && (*output_t_)[next_output_] <= t_;
    if (at_output_) ++next_output_;
  }

  /// Whether the last step reached an output stamp, and which.
  [[nodiscard]] bool at_output() const { return at_output_; }
  [[nodiscard]] std::size_t output() const { return next_output_ - 1; }
  [[nodiscard]] double time() const { return t_; }

 private:
  const FlightStreams* streams_;
  const std::vector<double>* output_t_;
  double end_;
  double t_;
  EnumArray<Sensor, std::size_t, kSensors> next_{};
  std::size_t next_gyro_ = 0, next_accel_ = 0, next_output_ = 0;
  std::size_t gyro_cursor_ = 0, accel_cursor_ = 0, density_cursor_ = 0;
  ControlStreams::Cursor control_cursor_;
  bool at_output_ = false;
};

/// The covariance at the start of a filter of one kind.
template <class Model>
[[nodiscard]] typename Model::Covariance start_covariance(const Start& start) {
  Prediction diagonal{.core = start.variance.head<Model::kCore>(),
                      .further = start.variance.tail<Model::kFull - Model::kCore>(),
                      .by_sensor_errors = true};
  typename Model::Covariance P = Model::row(diagonal).asDiagonal();
  if (start.attitude) P.template block<3, 3>(Model::kAttitude, Model::kAttitude) = *start.attitude;
  P.template block<5, 5>(Model::kGust, Model::kGust) = Model::stationary_gust_covariance();
  return P;
}

/// The system of a filter of one kind; the model-free one takes the kinematics only.
template <class Model>
[[nodiscard]] Model system_of(const ModelBasedMotion& motion) {
  Model model;
  if constexpr (std::is_base_of_v<ModelBasedMotion, Model>) {
    static_cast<ModelBasedMotion&>(model) = motion;
  } else {
    static_cast<AirDataMotion&>(model) = motion;
  }
  return model;
}

/// View of a RunSetting in which one filter goes through one segment; copyable, so that the smoother can repeat
/// stretches of it.
template <class Model>
class FlightRun {
 public:
  using Tape = estimation::SmootherTape<Model>;
  static constexpr bool kForces = std::is_base_of_v<ModelBasedMotion, Model>;
  using Filter = estimation::ExtendedKalmanFilter<Model>;

  FlightRun(const RunSetting& setting, const Segment& segment, const Start& start, const Monitors& monitors,
            std::size_t first_output)
      : setting_(&setting),
        model_(system_of<Model>(setting.motion)),
        cursor_(*setting.streams, *setting.output_t, segment, first_output),
        filter_(start.x, start_covariance<Model>(start)),
        monitors_(monitors) {
    for (auto& monitor : monitors_) monitor.restart();
  }

  /// To the next event; false at the end of the segment.
  bool advance(Tape* tape) {
    const double time = cursor_.next_time();
    if (!std::isfinite(time)) return false;
    propagate_to(time, tape);
    if (keep_innovations_) innovations_.clear();
    bool known = false;
    MeasurementContext context;
    cursor_.step_to(time, [&](Sensor which, double z, double sigma) {
      if (!known) context = cursor_.context(*setting_->options, kForces);
      known = true;
      estimation::Innovation seen;
      const bool offered =
          enter_measurement<Model>(filter_, model_, context, which, z, sigma, monitors_[which], tape, &seen);
      if (keep_innovations_) {
        seen.accepted = seen.accepted && offered;
        innovations_.push_back({seen, which, offered});
      }
    });
    if (cursor_.at_output()) filter_.mark(cursor_.output(), tape);
    return true;
  }

  [[nodiscard]] bool at_output() const { return cursor_.at_output(); }
  [[nodiscard]] std::size_t output() const { return cursor_.output(); }
  [[nodiscard]] double time() const { return cursor_.time(); }
  /// The samples of the last event, where `keep_innovations` was called.
  [[nodiscard]] const std::vector<SensorInnovation>& innovations() const { return innovations_; }
  void keep_innovations() { keep_innovations_ = true; }
  [[nodiscard]] const Filter& filter() const { return filter_; }
  [[nodiscard]] const Monitors& monitors() const { return monitors_; }

 private:
  void propagate_to(double time, Tape* tape) {
    const double dt = time - cursor_.time();
    if (!(dt > 0.0)) return;
    AirDataInput u;
    cursor_.fill(u, time, kForces);
    u.airspeed = model_.air_velocity(filter_.state()).norm();
    filter_.propagate(model_, u, dt, tape);
  }

  const RunSetting* setting_;
  Model model_;
  EventCursor cursor_;
  Filter filter_;
  Monitors monitors_;
  std::vector<SensorInnovation> innovations_;
  bool keep_innovations_ = false;
};

}  // namespace veridyn::aircraft::internal
