#include "veridyn/vehicle/identification/fit/drive_whitening.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"
#include "veridyn/numerics/linear_systems/riccati.hpp"

namespace veridyn::vehicle {

void DriveWhitening::at(double u, Filter& out) const {
  const auto above = static_cast<std::size_t>(std::upper_bound(speed.begin(), speed.end(), u) - speed.begin());
  const Filter& high = filter[std::min(above, speed.size() - 1)];
  const Filter& low = filter[above > 0 ? above - 1 : 0];
  const bool between = above > 0 && above < speed.size();
  const double share = between ? (u - speed[above - 1]) / (speed[above] - speed[above - 1]) : 1.0;
  out.transition = (1.0 - share) * low.transition + share * high.transition;
  out.gain = (1.0 - share) * low.gain + share * high.gain;
  out.output = (1.0 - share) * low.output + share * high.output;
}

DriveNoise drive_noise(const LinearDrive& drive, const SteeringNoise& steering, const Eigen::VectorXd& output_sigma) {
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
  out.R = output_sigma.cwiseAbs2().asDiagonal();
  return out;
}

DriveWhitening::Filter whitening_filter(const DriveNoise& noise) {
  // The predictor's gain is the dual of a regulator's.
  const auto regulator = numerics::discrete_linear_quadratic(noise.F.transpose(), noise.C.transpose(),
                                                             noise.G * noise.G.transpose(), noise.R);
  return {noise.F, regulator.K.transpose(), noise.C};
}

}  // namespace veridyn::vehicle
