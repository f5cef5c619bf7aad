#include "veridyn/vehicle/identification/fit/drive_noise.hpp"

#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"

namespace veridyn::vehicle {

DriveNoise drive_noise(const LinearDrive& drive, const SteeringNoise& steering) {
  constexpr Eigen::Index kNoise = 2;
  constexpr double kButterworth = 0.5 * kPi / std::numbers::sqrt2;  // noise bandwidth over the corner frequency
  const double corner = 2.0 * kPi * 0.5 / steering.step * steering.band_share / kButterworth;
  const Eigen::Index states = drive.A.rows(), n = states + kNoise;
  Eigen::MatrixXd dynamics = Eigen::MatrixXd::Zero(n + 1, n + 1);  // the last column is of the white noise
  dynamics.topLeftCorner(states, states) = drive.A;
  dynamics.block(0, states, states, 1) = drive.B;
  dynamics(states, states + 1) = 1.0;
  dynamics(states + 1, states) = -corner * corner;
  dynamics(states + 1, states + 1) = -std::numbers::sqrt2 * corner;
  dynamics(states + 1, n) = corner * corner;
  const Eigen::MatrixXd over_step = numerics::matrix_exponential(Eigen::MatrixXd(dynamics * steering.step));
  DriveNoise out;
  out.F = over_step.topLeftCorner(n, n);
  out.G = over_step.topRightCorner(n, 1) * steering.sigma;
  out.C = Eigen::MatrixXd::Zero(drive.C.rows(), n);
  out.C.leftCols(states) = drive.C;
  out.C.col(states) = drive.D;
  return out;
}

}  // namespace veridyn::vehicle
