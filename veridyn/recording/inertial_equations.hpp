#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/sensor_matrix.hpp"

/// Inside of the consistency of inertial sensors: gain and bias of a sensor of three axes from windows of time.
namespace veridyn::recording::internal {

using Vector3 = numerics::Vector3<double>;
using Matrix3 = numerics::Matrix3<double>;

/// Unknowns: nine elements of the inverse gain, row by row, then three offsets.
inline constexpr Eigen::Index kUnknowns = 12;
/// What may be unknown too: delays of the specific force, of north and east, and of down, and the error of the heading,
/// its zero A and what iron on board makes of it, B sin psi + C cos psi (the coefficients of a compass's deviation as
/// mariners name them: Bowditch, American Practical Navigator).
inline constexpr Eigen::Index kDelays = 6;
inline constexpr Eigen::Index kHeading = kUnknowns + 3;
inline constexpr Eigen::Index kAllUnknowns = kUnknowns + kDelays;

/// Regressors of truth = T (N reading - N b): T's columns times the reading, then T itself.
[[nodiscard]] Eigen::Matrix<double, 3, kUnknowns> regressors(const Matrix3& T, const Vector3& reading);

/// A sensor's gain and bias with the delays that were found with them.
struct Solved {
  SensorMatrix matrix;
  Eigen::Vector3d delay = Eigen::Vector3d::Zero(), delay_sigma = Eigen::Vector3d::Zero();
};

/// Rows of three axes as they come.
class Equations {
 public:
  using Delays = Eigen::Matrix<double, 3, kDelays>;

  /// @param reference_noise  variance of the white noise in what the sensor is compared with, mean of the axes
  explicit Equations(double reference_noise) : reference_noise_(reference_noise) {}

  void add(const Eigen::Matrix<double, 3, kUnknowns>& X, const Vector3& z, const Delays& delays = Delays::Zero()) {
    if (!X.allFinite() || !z.allFinite() || !delays.allFinite()) return;
    Row row{{}, z};
    row.X << X, delays;
    rows_.push_back(row);
  }
  /// @param delays  whether they, and the error of the heading, are unknown too
  /// @param moved   axes whose gain is not taken as 1 from the start
  [[nodiscard]] std::optional<Solved> solve(bool delays, std::array<bool, 3> moved = {true, true, true}) const;

 private:
  struct Row {
    Eigen::Matrix<double, 3, kAllUnknowns> X;
    Vector3 z;
  };
  using Moved = std::array<bool, 3>;
  /// All unknowns in their order, and how well the gain of each axis is known.
  struct Estimate {
    bool known = false;
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(kAllUnknowns);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kAllUnknowns, kAllUnknowns);
    Vector3 relative_sigma = Vector3::Zero();
    Vector3 attenuation = Vector3::Zero();
    double residual_rms = 0.0;
    bool contradicted = false;  ///< see kContradicted
  };
  /// With the gain of an axis that did not move taken as 1.
  [[nodiscard]] estimation::RegressionData data(const Moved& moved, bool delays) const;
  [[nodiscard]] Estimate estimate(const Moved& moved, bool delays) const;
  [[nodiscard]] double power(std::size_t axis) const;
  [[nodiscard]] Eigen::Index heading_unknowns() const;
  [[nodiscard]] std::vector<Eigen::Index> unknowns(const Moved& moved, bool delays) const;
  [[nodiscard]] double signal_rms() const;

  double reference_noise_;
  std::vector<Row> rows_;
};

}  // namespace veridyn::recording::internal
