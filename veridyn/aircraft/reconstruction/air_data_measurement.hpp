#pragma once

#include <Eigen/Core>

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
  double min_airspeed = 3.0;            ///< below it vanes and force model are not believed [m/s]
  Eigen::Vector3d gyro{0.0, 0.0, 0.0};  ///< as measured [rad/s]
  double gyro_sigma = 0.0;              ///< of one sample [rad/s]
  Controls<double> controls;            ///< for the accelerometer of the model-based filter
};

/// Enters the sample `z` of a sensor with standard deviation `sigma` into `filter`. Returns whether it was offered to
/// the filter at all; `seen` then receives its innovation.
template <class Model>
bool enter_measurement(estimation::ExtendedKalmanFilter<Model>& filter, const Model& model, const MeasurementContext& c,
                       Sensor which, double z, double sigma, estimation::InnovationMonitor& monitor,
                       estimation::SmootherTape<Model>* tape = nullptr, estimation::Innovation* seen = nullptr) {
  const auto& x = filter.state();
  Prediction<Model> p;
  double variance = sigma * sigma;
  bool angle = false;
  switch (which) {
    case kRoll:
    case kPitch:
    case kYaw: {
      bool usable = false;
      p = predict_euler_angle<Model>(x, which - kRoll, usable);
      if (!usable) return false;
      angle = true;
      break;
    }
    case kVelNorth:
    case kVelEast:
    case kVelDown:
      p = predict_ground_velocity<Model>(x, which - kVelNorth);
      break;
    case kPitot:
      p = c.pitot_is_pressure ? predict_dynamic_pressure(model, x, c.air_density) : predict_airspeed(model, x);
      break;
    case kAlpha:
    case kBeta: {
      if (model.air_velocity(x).norm() < c.min_airspeed) return false;
      const Eigen::Vector3d arm = Model::template rates<double>(x, c.gyro).cross(c.vane_position);
      p = which == kAlpha ? predict_alpha(model, x, arm) : predict_beta(model, x, arm, c.beta_is_flank);
      angle = true;
      break;
    }
    case kAccelX:
    case kAccelY:
    case kAccelZ:
      if constexpr (Model::kHasAerodynamics) {
        if (model.air_velocity(x).norm() < c.min_airspeed) return false;
        typename Model::Input u;
        u.gyro = c.gyro;
        u.controls = c.controls;
        u.air_density = c.air_density;
        double gyro_noise = 0.0;
        p = predict_specific_force(model, x, u, which - kAccelX, c.gyro_sigma, gyro_noise);
        variance += gyro_noise;
        break;
      } else {
        return false;
      }
  }
  const double nu = angle ? numerics::wrap_angle(z - p.value) : z - p.value;
  static_cast<void>(filter.update(c.t, nu, p.H, variance, monitor, tape, seen));
  return true;
}

}  // namespace veridyn::aircraft::internal
