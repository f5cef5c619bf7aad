#include "veridyn/aircraft/reconstruction/air_data_measurement.hpp"

namespace veridyn::aircraft::internal {

std::optional<OfferedSample> offered_sample(const AirDataMotion& motion, const ModelBasedMotion* forces,
                                            const AirDataState<double>& x, const MeasurementContext& c, Sensor which,
                                            double z, double sigma) {
  std::optional<OfferedSample> sample(std::in_place);
  Prediction& p = sample->prediction;
  sample->variance = sigma * sigma;
  bool angle = false;
  switch (which) {
    case kRoll:
    case kPitch:
    case kYaw: {
      const std::optional<Prediction> euler = predict_euler_angle(x, which - kRoll);
      if (!euler) return std::nullopt;
      p = *euler;
      angle = true;
      break;
    }
    case kVelNorth:
    case kVelEast:
    case kVelDown:
      p = predict_ground_velocity(x, which - kVelNorth);
      break;
    case kPitot:
      p = c.pitot_is_pressure ? predict_dynamic_pressure(motion, x, c.air_density) : predict_airspeed(motion, x);
      break;
    case kAlpha:
    case kBeta: {
      if (motion.air_velocity(x).norm() < c.min_airspeed) return std::nullopt;
      const Eigen::Vector3d arm = AirDataMotion::rates<double>(x, c.gyro).cross(c.vane_position);
      p = which == kAlpha ? predict_alpha(motion, x, arm) : predict_beta(motion, x, arm, c.beta_is_flank);
      angle = true;
      break;
    }
    case kAccelX:
    case kAccelY:
    case kAccelZ: {
      if (forces == nullptr || motion.air_velocity(x).norm() < c.min_airspeed) return std::nullopt;
      AirDataInput u;
      u.gyro = c.gyro;
      u.controls = c.controls;
      u.air_density = c.air_density;
      double gyro_noise = 0.0;
      p = predict_specific_force(*forces, x, u, which - kAccelX, c.gyro_sigma, gyro_noise);
      sample->variance += gyro_noise;
      break;
    }
  }
  sample->nu = angle ? numerics::wrap_angle(z - p.value) : z - p.value;
  return sample;
}

}  // namespace veridyn::aircraft::internal
