#pragma once

#include <Eigen/Core>

namespace veridyn::vehicle {

/// A drive about going straight ahead at one speed: x' = A x + B delta, y = C x + D delta.
struct LinearDrive {
  Eigen::MatrixXd A, C;
  Eigen::VectorXd B, D;
};

/// White noise of the recorded steering of which a share of the band is left, over a step of the grid.
struct SteeringNoise {
  double sigma = 0.0;       ///< of the recorded steering [rad]
  double band_share = 0.0;  ///< of the frequencies up to half of the rate; 0: nothing is left of it
  double step = 0.01;       ///< [s]
};

/// By which noise of the steering comes to the outputs: x_next = F x + G w, y = C x with white w of variance one. The
/// noise of the steering that is left is white noise through two poles of its bandwidth (Butterworth), whose states
/// follow those of the vehicle.
struct DriveNoise {
  Eigen::MatrixXd F, C;
  Eigen::VectorXd G;
};
[[nodiscard]] DriveNoise drive_noise(const LinearDrive& drive, const SteeringNoise& steering);

}  // namespace veridyn::vehicle
