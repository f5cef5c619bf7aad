#pragma once

#include <Eigen/Core>
#include <optional>
#include <type_traits>

#include "veridyn/aircraft/reconstruction/model_based_filter.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"
#include "veridyn/numerics/rotation.hpp"

/// Inside of the aircraft's filters: what a sensor's sample means to a filter.
namespace veridyn::aircraft::internal {

/// What stands between a sample and the state, at the sample's time.
struct MeasurementContext {
  double t = 0.0;                 ///< [s]
  bool pitot_is_pressure = true;  ///< else true airspeed
  double air_density = 1.225;     ///< [kg/m^3]
  Eigen::Vector3d vane_position{0.0, 0.0, 0.0};
  bool beta_is_flank = false;
  double min_airspeed = 3.0;            ///< below it vanes and force model are not used [m/s]
  Eigen::Vector3d gyro{0.0, 0.0, 0.0};  ///< as measured [rad/s]
  double gyro_sigma = 0.0;              ///< of one sample [rad/s]
  Controls<double> controls;            ///< for the accelerometer of the model-based filter
};

/// A sample ready to be entered: its innovation, row and variance.
struct OfferedSample {
  double nu = 0.0;
  Prediction prediction;
  double variance = 0.0;
};

/// The sample `z` of a sensor with standard deviation `sigma` at state `x`; nothing where it is not to be
/// used there. The accelerometer's axes are measurements of the model-based filter only: for the other `forces` is
/// null.
[[nodiscard]] std::optional<OfferedSample> offered_sample(const AirDataMotion& motion, const ModelBasedMotion* forces,
                                                          const AirDataState<double>& x, const MeasurementContext& c,
                                                          Sensor which, double z, double sigma);

/// Enters the sample `z` of a sensor with standard deviation `sigma` into `filter`. Returns whether it was offered to
/// the filter at all; `seen` then receives its innovation.
template <class Model>
bool enter_measurement(estimation::ExtendedKalmanFilter<Model>& filter, const Model& model, const MeasurementContext& c,
                       Sensor which, double z, double sigma, estimation::InnovationMonitor& monitor,
                       estimation::SmootherTape<Model>* tape = nullptr, estimation::Innovation* seen = nullptr) {
  const ModelBasedMotion* forces = nullptr;
  if constexpr (std::is_base_of_v<ModelBasedMotion, Model>) forces = &model;
  const std::optional<OfferedSample> sample = offered_sample(model, forces, filter.state(), c, which, z, sigma);
  if (!sample) return false;
  static_cast<void>(
      filter.update(c.t, sample->nu, Model::row(sample->prediction), sample->variance, monitor, tape, seen));
  return true;
}

}  // namespace veridyn::aircraft::internal
