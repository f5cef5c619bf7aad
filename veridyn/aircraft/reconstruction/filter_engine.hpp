#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct_columns.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"

/// Inside of reconstruct.cpp: the filters behind one interface, so that only the engines' source files, one for the
/// model-free and one for the model-based, instantiate the filter for its sizes of state.
namespace veridyn::aircraft::internal {

/// A filter that is driven from outside: on board or in a replay. None of the functions allocates.
class AirDataEstimator {
 public:
  virtual ~AirDataEstimator() = default;
  /// Over `dt` > 0 [s] with inertial measurements and controls `u`; its airspeed is filled in.
  virtual void propagate(AirDataInput u, double dt) = 0;
  /// A sample `z` of a sensor with standard deviation `sigma`. Returns whether it was offered to the filter at all;
  /// `seen` then receives its innovation.
  virtual bool measure(const MeasurementContext& context, Sensor which, double z, double sigma,
                       estimation::InnovationMonitor& monitor, estimation::Innovation* seen) = 0;
  /// Takes state and covariance of a model-free filter with the same errors of inertial sensors; the errors of CL, CD
  /// and CY start at zero.
  virtual void restart_from(const AirDataEstimator& model_free) = 0;
  /// Another force model from now on; nothing for the model-free filter.
  virtual void set_forces(const Subject* subject, const ModelError& error) = 0;
  [[nodiscard]] virtual const AirDataState<double>& state() const = 0;
  [[nodiscard]] virtual CovarianceView covariance() const = 0;
  [[nodiscard]] virtual const AirDataMotion& motion() const = 0;
};

/// A filter going through a segment, for the sake of its innovations.
class InnovationRun {
 public:
  virtual ~InnovationRun() = default;
  /// To the next event; false at the end of the segment.
  virtual bool advance() = 0;
  /// The samples of the last event.
  [[nodiscard]] virtual const std::vector<SensorInnovation>& innovations() const = 0;
  [[nodiscard]] virtual const Monitors& monitors() const = 0;
};

/// How the forward pass over a segment ended.
struct PassEnd {
  Monitors monitors;
  /// Covariance of the sensor errors' columns at the end, 0 where the filter does not estimate them.
  Eigen::MatrixXd error_covariance;
};

/// One kind of filter.
class FilterEngine {
 public:
  /// An estimate of the forward pass at an output stamp; false stops there.
  using OnFiltered =
      std::function<bool(std::size_t output, double time, const AirDataState<double>& x, const CovarianceView& P)>;
  /// Called for each stamp once, with more than one thread in no order and by two of them at a time.
  using OnSmoothed = std::function<void(std::size_t output, const AirDataState<double>& x, const CovarianceView& P)>;
  /// A sample of the forward pass; empty: none is wanted.
  using OnInnovation = std::function<void(double time, const SensorInnovation& innovation)>;

  virtual ~FilterEngine() = default;
  [[nodiscard]] virtual bool has_forces() const = 0;
  /// Filter and smoother over a segment (see estimation::smooth_in_blocks).
  [[nodiscard]] virtual PassEnd smooth(const RunSetting& setting, const Segment& segment, const Monitors& monitors,
                                       std::size_t first_output, std::span<const std::size_t> error_columns,
                                       int threads, const OnFiltered& filtered, const OnSmoothed& smoothed,
                                       const OnInnovation& seen) const = 0;
  [[nodiscard]] virtual std::unique_ptr<InnovationRun> innovation_run(const RunSetting& setting, const Segment& segment,
                                                                      const Monitors& monitors) const = 0;
  [[nodiscard]] virtual std::unique_ptr<AirDataEstimator> estimator(const ModelBasedMotion& motion,
                                                                    const Start& start) const = 0;
};

/// `imu_errors`: errors of gyro and accelerometer are states, those that the options do not estimate held by a variance
/// of zero.
[[nodiscard]] std::unique_ptr<FilterEngine> model_free_engine(bool imu_errors);
/// As `model_free_engine`, with the subject's force coefficients.
[[nodiscard]] std::unique_ptr<FilterEngine> model_based_engine(bool imu_errors);

}  // namespace veridyn::aircraft::internal
