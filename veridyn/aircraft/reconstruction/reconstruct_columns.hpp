#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"
#include "veridyn/core/recording.hpp"

/// Inside of reconstruct.cpp: from states and covariances to channels.
namespace veridyn::aircraft::internal {

/// A result's name, unit and whether the study asked for it.
struct ColumnName {
  const char* name;
  const char* unit;
};

/// In the order of `ResultColumns::write`; the sensor errors and those of the model last.
inline constexpr std::array<ColumnName, 38> kColumns{{{"airspeed", "m/s"},
                                                      {"alpha", "rad"},
                                                      {"beta", "rad"},
                                                      {"air_velocity_x", "m/s"},
                                                      {"air_velocity_y", "m/s"},
                                                      {"air_velocity_z", "m/s"},
                                                      {"wind_north", "m/s"},
                                                      {"wind_east", "m/s"},
                                                      {"wind_down", "m/s"},
                                                      {"wind_total_north", "m/s"},
                                                      {"wind_total_east", "m/s"},
                                                      {"wind_total_down", "m/s"},
                                                      {"roll", "rad"},
                                                      {"pitch", "rad"},
                                                      {"yaw", "rad"},
                                                      {"vel_north", "m/s"},
                                                      {"vel_east", "m/s"},
                                                      {"vel_down", "m/s"},
                                                      {"gyro_bias_x", "rad/s"},
                                                      {"gyro_bias_y", "rad/s"},
                                                      {"gyro_bias_z", "rad/s"},
                                                      {"accel_bias_x", "m/s^2"},
                                                      {"accel_bias_y", "m/s^2"},
                                                      {"accel_bias_z", "m/s^2"},
                                                      {"gyro_scale_x", "1"},
                                                      {"gyro_scale_y", "1"},
                                                      {"gyro_scale_z", "1"},
                                                      {"accel_scale_x", "1"},
                                                      {"accel_scale_y", "1"},
                                                      {"accel_scale_z", "1"},
                                                      {"alpha_bias", "rad"},
                                                      {"beta_bias", "rad"},
                                                      {"alpha_scale", "1"},
                                                      {"pitot_scale", "1"},
                                                      {"pitot_bias", "Pa"},
                                                      {"CL_error", "1"},
                                                      {"CD_error", "1"},
                                                      {"CY_error", "1"}}};
inline constexpr std::size_t kFirstImuBias = 18;
inline constexpr std::size_t kFirstImuScale = 24;
inline constexpr std::size_t kFirstAirDataError = 30;
inline constexpr std::size_t kFirstCoefficientError = 35;

/// Values and standard deviations of all results at all stamps.
class ResultColumns {
 public:
  /// Room for `size` samples of the columns that are `wanted`.
  ResultColumns(std::size_t size, const std::array<bool, kColumns.size()>& wanted) : size_(size) {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (!wanted[c]) continue;
      value_[c].resize(size);
      sigma_[c].resize(size);
    }
    for (auto& g : gust_) g.resize(size);
    if (size > 0) density_.resize(size);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool has(std::size_t column) const { return !value_[column].empty(); }
  [[nodiscard]] const std::vector<double>& value(std::size_t column) const { return value_[column]; }
  [[nodiscard]] const std::vector<double>& sigma(std::size_t column) const { return sigma_[column]; }

  /// Sample `i` from state `x` with error covariance `P`; derived quantities by first-order propagation.
  template <class Model>
  void write(std::size_t i, const Model& model, const typename Model::template State<double>& x,
             const typename Model::Covariance& P, double density) {
    const Eigen::Vector3d v = model.air_velocity(x);
    const Eigen::Vector3d gust = model.gust_velocity(x);
    const Eigen::Matrix3d R = x.attitude.toRotationMatrix();
    using Rows = Eigen::Matrix<double, 3, Model::kStates>;
    const Rows J = model.air_velocity_jacobian(x);
    const Eigen::Matrix<double, Model::kStates, 3> PJ = P.lazyProduct(J.transpose());
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
      put(6 + static_cast<std::size_t>(k), i, x.wind(k), P(Model::kWind + k, Model::kWind + k));
    }

    // Total wind W + R gust.
    const Eigen::Vector3d total = x.wind + R * gust;
    Rows T = Rows::Zero();
    Eigen::Matrix3d cross;
    cross << 0.0, -gust.z(), gust.y(), gust.z(), 0.0, -gust.x(), -gust.y(), gust.x(), 0.0;
    T.template middleCols<3>(Model::kAttitude) = -R * cross;
    T.template middleCols<5>(Model::kGust) = -R * J.template middleCols<5>(Model::kGust);
    T.template middleCols<3>(Model::kWind).setIdentity();
    const Eigen::Matrix<double, Model::kStates, 3> PT = P.lazyProduct(T.transpose());
    for (int k = 0; k < 3; ++k) put(9 + static_cast<std::size_t>(k), i, total(k), PT.col(k).dot(T.row(k)));

    const auto euler = numerics::euler_from_quaternion(x.attitude);
    const double cf = std::cos(euler.phi), sf = std::sin(euler.phi);
    const double ct = std::max(std::cos(euler.theta), 1e-3), tt = std::sin(euler.theta) / ct;
    Eigen::Matrix3d E;
    E << 1.0, sf * tt, cf * tt, 0.0, cf, -sf, 0.0, sf / ct, cf / ct;
    const Eigen::Matrix3d A = E * P.template topLeftCorner<3, 3>() * E.transpose();
    put(12, i, euler.phi, A(0, 0));
    put(13, i, euler.theta, A(1, 1));
    put(14, i, euler.psi, A(2, 2));
    for (int k = 0; k < 3; ++k) {
      put(15 + static_cast<std::size_t>(k), i, x.velocity(k), P(Model::kVelocity + k, Model::kVelocity + k));
    }
    if constexpr (Model::kHasImuBiases) {
      for (int k = 0; k < 6; ++k) {
        put(kFirstImuBias + static_cast<std::size_t>(k), i, x.imu_bias(k), P(Model::kImuBias + k, Model::kImuBias + k));
      }
    }
    if constexpr (Model::kHasImuScales) {
      for (int k = 0; k < 6; ++k) {
        put(kFirstImuScale + static_cast<std::size_t>(k), i, x.imu_scale(k),
            P(Model::kImuScale + k, Model::kImuScale + k));
      }
    }
    if constexpr (Model::kHasAerodynamics) {
      for (int k = 0; k < 3; ++k) {
        put(kFirstCoefficientError + static_cast<std::size_t>(k), i, x.coefficient_error(k),
            P(Model::kCoefficientError + k, Model::kCoefficientError + k));
      }
    }
    for (std::size_t k = 0; k < 3; ++k) gust_[k][i] = gust(static_cast<Eigen::Index>(k));
    density_[i] = density;
  }

  /// The same value and sigma at all samples.
  void fill(std::size_t column, double value, double sigma) {
    std::fill(value_[column].begin(), value_[column].end(), value);
    std::fill(sigma_[column].begin(), sigma_[column].end(), sigma);
  }

  /// Adds to all variances what constants of the given correlation contribute: `shifted[k]` are the results with
  /// constant k moved by one sigma.
  void widen(std::size_t count, const std::vector<ResultColumns>& shifted, const Eigen::MatrixXd& correlation) {
    Eigen::VectorXd d(static_cast<Eigen::Index>(shifted.size()));
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (value_[c].empty() || (c >= kFirstAirDataError && c < kFirstCoefficientError)) continue;
      const bool angle = std::string_view(kColumns[c].unit) == "rad";
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < shifted.size(); ++k) {
          const double change = shifted[k].value_[c][i] - value_[c][i];
          d(static_cast<Eigen::Index>(k)) = angle ? numerics::wrap_angle(change) : change;
        }
        sigma_[c][i] = std::sqrt(sigma_[c][i] * sigma_[c][i] + std::max(0.0, d.dot(correlation * d)));
      }
    }
  }

  /// Takes columns `first` and behind of sample `i` from another set of results.
  void copy_errors(std::size_t i, const ResultColumns& from, std::size_t first = kFirstImuBias) {
    for (std::size_t c = first; c < kColumns.size(); ++c) {
      if (value_[c].empty() || from.value_[c].empty()) continue;
      value_[c][i] = from.value_[c][i];
      sigma_[c][i] = from.sigma_[c][i];
    }
  }
  /// Takes sample `i` from another set of results.
  void copy_sample(std::size_t i, const ResultColumns& from) {
    copy_errors(i, from, 0);
    for (std::size_t k = 0; k < 3; ++k) gust_[k][i] = from.gust_[k][i];
    density_[i] = from.density_[i];
  }

  /// Moves the first `count` samples into a recording.
  void move_into(Recording& recording, const TimeBase& time, std::size_t count) {
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

 private:
  void put(std::size_t column, std::size_t i, double value, double variance) {
    if (value_[column].empty()) return;
    value_[column][i] = value;
    sigma_[column][i] = std::sqrt(std::max(variance, 0.0));
  }

  std::size_t size_;
  std::array<std::vector<double>, kColumns.size()> value_;
  std::array<std::vector<double>, kColumns.size()> sigma_;
  std::array<std::vector<double>, 3> gust_;
  std::vector<double> density_;
};

}  // namespace veridyn::aircraft::internal
