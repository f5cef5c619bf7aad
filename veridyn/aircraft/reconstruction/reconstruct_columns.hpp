#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"
#include "veridyn/core/recording.hpp"

/// Inside of reconstruct.cpp: from states and covariances to channels.
namespace veridyn::aircraft::internal {

/// A result's name and unit, and whether the study has it.
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
/// Which of them there are.
using ColumnSet = std::array<bool, kColumns.size()>;
inline constexpr std::size_t kFirstImuBias = 18;
inline constexpr std::size_t kFirstImuScale = 24;
inline constexpr std::size_t kFirstAirDataError = 30;
inline constexpr std::size_t kFirstCoefficientError = 35;

/// Covariance of a filter's error vector and where in it the errors of the inertial sensors and of the force model are,
/// -1 where they are not. View of the filter's covariance.
struct CovarianceView {
  Eigen::Map<const Eigen::MatrixXd> matrix;
  int imu_error = -1;
  int coefficient_error = -1;

  /// Index in the error vector of a column of sensor errors; -1 where the filter does not estimate it.
  [[nodiscard]] int state_of_column(std::size_t column) const;
  /// Covariance of columns of sensor errors, 0 where the filter does not estimate them.
  [[nodiscard]] Eigen::MatrixXd of_columns(std::span<const std::size_t> columns) const;
};

/// Values and standard deviations of all results at all stamps.
class ResultColumns {
 public:
  /// Space for `size` samples of the columns that are `present`.
  ResultColumns(std::size_t size, const ColumnSet& present) : size_(size) {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      if (!present[c]) continue;
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

  /// Sample `i` from state `x` with covariance `P`; derived quantities by first-order propagation.
  void write(std::size_t i, const AirDataMotion& motion, const AirDataState<double>& x, const CovarianceView& P,
             double density);

  /// The same value and sigma at all samples.
  void fill(std::size_t column, double value, double sigma);

  /// Adds to all variances what constants of the given correlation contribute: `shifted[k]` are the results with
  /// constant k moved by one sigma.
  void widen(std::size_t count, const std::vector<ResultColumns>& shifted, const Eigen::MatrixXd& correlation);

  /// Takes the columns from `first` to before `last` of sample `i` from another set of results, where both have them.
  void copy_columns(std::size_t i, const ResultColumns& from, std::size_t first, std::size_t last);
  /// Takes sample `i` from another set of results, of the columns those before `last`.
  void copy_sample(std::size_t i, const ResultColumns& from, std::size_t last = kColumns.size());

  /// Moves the first `count` samples into a recording.
  void move_into(Recording& recording, const TimeBase& time, std::size_t count);

 private:
  void put(std::size_t column, std::size_t i, double value, double variance);

  std::size_t size_;
  std::array<std::vector<double>, kColumns.size()> value_;
  std::array<std::vector<double>, kColumns.size()> sigma_;
  std::array<std::vector<double>, 3> gust_;
  std::vector<double> density_;
};

}  // namespace veridyn::aircraft::internal
