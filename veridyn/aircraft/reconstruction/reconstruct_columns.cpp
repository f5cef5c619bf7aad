#include "veridyn/aircraft/reconstruction/reconstruct_columns.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"

namespace veridyn::aircraft::internal {

int CovarianceView::state_of_column(std::size_t column) const {
  if (column >= kFirstCoefficientError) {
    return coefficient_error < 0 ? -1 : coefficient_error + static_cast<int>(column - kFirstCoefficientError);
  }
  if (column < kFirstImuBias || column >= kFirstAirDataError || imu_error < 0) return -1;
  return imu_error + static_cast<int>(column - kFirstImuBias);
}

Eigen::MatrixXd CovarianceView::of_columns(std::span<const std::size_t> columns) const {
  const auto n = signed_index(columns.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      const int row = state_of_column(columns[a]);
      const int column = state_of_column(columns[b]);
      if (row >= 0 && column >= 0) out(a, b) = matrix(row, column);
    }
  }
  return out;
}

void ResultColumns::write(std::size_t i, const AirDataMotion& motion, const AirDataState<double>& x,
                          const CovarianceView& P, double density) {
  constexpr int kCore = AirDataMotion::kCore;
  const Eigen::Matrix<double, kCore, kCore> core = P.matrix.topLeftCorner<kCore, kCore>();
  const Eigen::Vector3d v = motion.air_velocity(x);
  const Eigen::Vector3d gust = motion.gust_velocity(x);
  const Eigen::Matrix3d R = x.attitude.toRotationMatrix();
  using Rows = Eigen::Matrix<double, 3, kCore>;
  const Rows J = motion.air_velocity_jacobian(x);
  const Eigen::Matrix<double, kCore, 3> PJ = core.lazyProduct(J.transpose());
  const Eigen::Matrix3d C = J.lazyProduct(PJ);

  const double speed = std::max(v.norm(), 1e-6);
  const double plane = std::max(std::hypot(v.x(), v.z()), 1e-6);
  const Eigen::Vector3d along = v / speed;
  const Eigen::Vector3d d_alpha = Eigen::Vector3d(-v.z(), 0.0, v.x()) / (plane * plane);
  const Eigen::Vector3d d_beta =
      Eigen::Vector3d(-v.x() * v.y() / plane, plane, -v.z() * v.y() / plane) / (speed * speed);
  put(0, i, speed, along.dot(C * along));
  put(1, i, std::atan2(v.z(), v.x()), d_alpha.dot(C * d_alpha));
  put(2, i, std::atan2(v.y(), plane), d_beta.dot(C * d_beta));
  for (int k = 0; k < 3; ++k) put(3 + static_cast<std::size_t>(k), i, v(k), C(k, k));
  for (int k = 0; k < 3; ++k) {
    put(6 + static_cast<std::size_t>(k), i, x.wind(k), core(AirDataMotion::kWind + k, AirDataMotion::kWind + k));
  }

  // Total wind W + R gust.
  const Eigen::Vector3d total = x.wind + R * gust;
  Rows T = Rows::Zero();
  Eigen::Matrix3d cross;
  cross << 0.0, -gust.z(), gust.y(), gust.z(), 0.0, -gust.x(), -gust.y(), gust.x(), 0.0;
  T.middleCols<3>(AirDataMotion::kAttitude) = -R * cross;
  T.middleCols<5>(AirDataMotion::kGust) = -R * J.middleCols<5>(AirDataMotion::kGust);
  T.middleCols<3>(AirDataMotion::kWind).setIdentity();
  const Eigen::Matrix<double, kCore, 3> PT = core.lazyProduct(T.transpose());
  for (int k = 0; k < 3; ++k) put(9 + static_cast<std::size_t>(k), i, total(k), PT.col(k).dot(T.row(k)));

  const auto euler = numerics::euler_from_quaternion(x.attitude);
  const double cf = std::cos(euler.phi), sf = std::sin(euler.phi);
  const double ct = std::max(std::cos(euler.theta), 1e-3), tt = std::sin(euler.theta) / ct;
  Eigen::Matrix3d E;
  E << 1.0, sf * tt, cf * tt, 0.0, cf, -sf, 0.0, sf / ct, cf / ct;
  const Eigen::Matrix3d A = E * core.topLeftCorner<3, 3>() * E.transpose();
  put(12, i, euler.phi, A(0, 0));
  put(13, i, euler.theta, A(1, 1));
  put(14, i, euler.psi, A(2, 2));
  for (int k = 0; k < 3; ++k) {
    put(15 + static_cast<std::size_t>(k), i, x.velocity(k),
        core(AirDataMotion::kVelocity + k, AirDataMotion::kVelocity + k));
  }
  const auto variance = [&P](int state) { return P.matrix(state, state); };
  if (P.imu_error >= 0) {
    for (int k = 0; k < 6; ++k) {
      put(kFirstImuBias + static_cast<std::size_t>(k), i, x.imu_bias(k), variance(P.imu_error + k));
      put(kFirstImuScale + static_cast<std::size_t>(k), i, x.imu_scale(k), variance(P.imu_error + 6 + k));
    }
  }
  if (P.coefficient_error >= 0) {
    for (int k = 0; k < 3; ++k) {
      put(kFirstCoefficientError + static_cast<std::size_t>(k), i, x.coefficient_error(k),
          variance(P.coefficient_error + k));
    }
  }
  for (std::size_t k = 0; k < 3; ++k) gust_[k][i] = gust(k);
  density_[i] = density;
}

void ResultColumns::fill(std::size_t column, double value, double sigma) {
  std::fill(value_[column].begin(), value_[column].end(), value);
  std::fill(sigma_[column].begin(), sigma_[column].end(), sigma);
}

void ResultColumns::widen(std::size_t count, const std::vector<ResultColumns>& shifted,
                          const Eigen::MatrixXd& correlation) {
  Eigen::VectorXd d(shifted.size());
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    if (value_[c].empty() || (c >= kFirstAirDataError && c < kFirstCoefficientError)) continue;
    const bool angle = std::string_view(kColumns[c].unit) == "rad";
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < shifted.size(); ++k) {
        const double change = shifted[k].value_[c][i] - value_[c][i];
        d(k) = angle ? numerics::wrap_angle(change) : change;
      }
      sigma_[c][i] = std::sqrt(sigma_[c][i] * sigma_[c][i] + std::max(0.0, d.dot(correlation * d)));
    }
  }
}

void ResultColumns::copy_columns(std::size_t i, const ResultColumns& from, std::size_t first, std::size_t last) {
  for (std::size_t c = first; c < last; ++c) {
    if (value_[c].empty() || from.value_[c].empty()) continue;
    value_[c][i] = from.value_[c][i];
    sigma_[c][i] = from.sigma_[c][i];
  }
}

void ResultColumns::copy_sample(std::size_t i, const ResultColumns& from, std::size_t last) {
  copy_columns(i, from, 0, last);
  for (std::size_t k = 0; k < 3; ++k) gust_[k][i] = from.gust_[k][i];
  density_[i] = from.density_[i];
}

void ResultColumns::move_into(Recording& recording, const TimeBase& time, std::size_t count) {
  const auto add = [&](std::string name, const char* unit, std::vector<double>& values) {
    values.resize(count);
    recording.add(make_channel(std::move(name), unit, time, std::move(values)));
  };
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    if (!has(c)) continue;
    add(kColumns[c].name, kColumns[c].unit, value_[c]);
    add(std::string("sigma_") + kColumns[c].name, kColumns[c].unit, sigma_[c]);
  }
  for (std::size_t k = 0; k < 3; ++k) add(std::string("gust_") + "xyz"[k], "m/s", gust_[k]);
  add("air_density", "kg/m^3", density_);
}

void ResultColumns::put(std::size_t column, std::size_t i, double value, double variance) {
  if (value_[column].empty()) return;
  value_[column][i] = value;
  sigma_[column][i] = std::sqrt(std::max(variance, 0.0));
}

}  // namespace veridyn::aircraft::internal
