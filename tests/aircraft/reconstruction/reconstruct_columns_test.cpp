#include "veridyn/aircraft/reconstruction/reconstruct_columns.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace veridyn::aircraft::internal {
namespace {

ColumnSet every_column() {
  ColumnSet all;
  all.fill(true);
  return all;
}

/// Level, 20 m/s forward and 2 m/s down over ground, in a wind of (3, -1, 0) m/s that the filter knows to 0.3 m/s; the
/// velocity to 0.2 m/s, all else exactly.
struct LevelFlight {
  LevelFlight() {
    x.velocity = Eigen::Vector3d(23.0, -1.0, 2.0);
    x.wind = Eigen::Vector3d(3.0, -1.0, 0.0);
    for (int i = 0; i < 3; ++i) {
      P(AirDataMotion::kVelocity + i, AirDataMotion::kVelocity + i) = 0.04;
      P(AirDataMotion::kWind + i, AirDataMotion::kWind + i) = 0.09;
    }
  }
  [[nodiscard]] CovarianceView view() const {
    return {Eigen::Map<const Eigen::MatrixXd>(P.data(), P.rows(), P.cols())};
  }
  AirDataState<double> x;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(AirDataMotion::kCore, AirDataMotion::kCore);
};

// The velocity relative to the air is (20, 0, 2) m/s, each component to sqrt(0.04 + 0.09) m/s.
TEST(ResultColumns, HoldAirspeedAndAnglesWithTheirFirstOrderSigmas) {
  const LevelFlight flight;
  ResultColumns columns(1, every_column());
  columns.write(0, AirDataMotion{}, flight.x, flight.view(), 1.2);
  const double speed = std::hypot(20.0, 2.0), sigma = std::sqrt(0.13);
  EXPECT_DOUBLE_EQ(columns.value(0)[0], speed);
  EXPECT_DOUBLE_EQ(columns.value(1)[0], std::atan2(2.0, 20.0));
  EXPECT_EQ(columns.value(2)[0], 0.0);
  EXPECT_NEAR(columns.sigma(0)[0], sigma, 1e-12);
  EXPECT_NEAR(columns.sigma(1)[0], sigma / speed, 1e-12);
  EXPECT_NEAR(columns.sigma(2)[0], sigma / speed, 1e-12);
  // The wind and the velocity over ground as they are in the state.
  EXPECT_EQ(columns.value(6)[0], 3.0);
  EXPECT_NEAR(columns.sigma(6)[0], 0.3, 1e-12);
  EXPECT_EQ(columns.value(15)[0], 23.0);
  EXPECT_NEAR(columns.sigma(15)[0], 0.2, 1e-12);
}

TEST(ResultColumns, WidenByWhatConstantsLeaveUncertain) {
  const LevelFlight flight;
  ResultColumns columns(1, every_column()), shifted(1, every_column());
  columns.write(0, AirDataMotion{}, flight.x, flight.view(), 1.2);
  LevelFlight other = flight;
  other.x.velocity.x() += 0.5;
  shifted.write(0, AirDataMotion{}, other.x, other.view(), 1.2);
  const double before = columns.sigma(15)[0];
  columns.widen(1, {shifted}, Eigen::MatrixXd::Identity(1, 1));
  EXPECT_NEAR(columns.sigma(15)[0], std::hypot(before, 0.5), 1e-12);
  EXPECT_NEAR(columns.sigma(16)[0], 0.2, 1e-12) << "the east velocity is not moved";
  EXPECT_EQ(columns.value(15)[0], 23.0) << "values stay";
}

// A heading of 179 deg moved to -179 deg has moved by 2 deg.
TEST(ResultColumns, WidenAnglesTheShortWayRound) {
  const auto heading = [](double degrees) {
    LevelFlight flight;
    flight.x.attitude = numerics::quaternion_from_euler(0.0, 0.0, degrees * kDegree);
    ResultColumns columns(1, every_column());
    columns.write(0, AirDataMotion{}, flight.x, flight.view(), 1.2);
    return columns;
  };
  ResultColumns columns = heading(179.0);
  columns.widen(1, {heading(-179.0)}, Eigen::MatrixXd::Identity(1, 1));
  EXPECT_NEAR(columns.sigma(14)[0], 2.0 * kDegree, 1e-12);
}

TEST(ResultColumns, AreTakenFromOthersWhereBothHaveThem) {
  const LevelFlight flight;
  LevelFlight other;
  other.x.velocity.x() = 40.0;
  ColumnSet some = every_column();
  some[0] = false;
  ResultColumns columns(2, every_column()), from(2, some);
  for (std::size_t i = 0; i < 2; ++i) {
    columns.write(i, AirDataMotion{}, flight.x, flight.view(), 1.2);
    from.write(i, AirDataMotion{}, other.x, other.view(), 1.1);
  }
  columns.copy_sample(0, from);
  EXPECT_EQ(columns.value(15)[0], 40.0);
  EXPECT_EQ(columns.value(15)[1], 23.0) << "the other sample stays";
  EXPECT_DOUBLE_EQ(columns.value(0)[0], std::hypot(20.0, 2.0)) << "a column that they do not have stays";
  columns.copy_columns(1, from, 3, 15);
  EXPECT_EQ(columns.value(3)[1], 37.0);
  EXPECT_EQ(columns.value(15)[1], 23.0) << "behind the last column";
}

TEST(ResultColumns, BecomeChannelsOfThatManySamples) {
  const LevelFlight flight;
  ColumnSet some{};
  some[0] = some[14] = true;
  ResultColumns columns(3, some);
  for (std::size_t i = 0; i < 3; ++i) columns.write(i, AirDataMotion{}, flight.x, flight.view(), 1.2);
  Recording recording;
  columns.move_into(recording, make_time_base({0.0, 0.1}), 2);
  EXPECT_EQ(recording.names(), (std::vector<std::string>{"airspeed", "sigma_airspeed", "yaw", "sigma_yaw", "gust_x",
                                                         "gust_y", "gust_z", "air_density"}));
  EXPECT_EQ(recording.at("airspeed").value.size(), 2U);
  EXPECT_EQ(recording.at("air_density").value.front(), 1.2);
}

TEST(CovarianceView, FindsSensorErrorsWhereTheFilterHasThem) {
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(29, 29);
  P(14, 14) = 2.0;
  P(14, 27) = P(27, 14) = 0.5;
  P(27, 27) = 3.0;
  const CovarianceView with{Eigen::Map<const Eigen::MatrixXd>(P.data(), 29, 29), 14, 26};
  EXPECT_EQ(with.state_of_column(kFirstImuBias), 14);
  EXPECT_EQ(with.state_of_column(kFirstImuScale), 20);
  EXPECT_EQ(with.state_of_column(kFirstAirDataError), -1) << "those are no states";
  EXPECT_EQ(with.state_of_column(kFirstCoefficientError + 1), 27);
  EXPECT_EQ(with.state_of_column(0), -1);
  const std::array columns{kFirstImuBias, kFirstAirDataError, kFirstCoefficientError + 1};
  Eigen::Matrix3d expected;
  expected << 2.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 3.0;
  EXPECT_EQ(with.of_columns(columns), expected);
  const CovarianceView without{Eigen::Map<const Eigen::MatrixXd>(P.data(), 29, 29)};
  EXPECT_EQ(without.of_columns(columns), Eigen::MatrixXd::Zero(3, 3));
}

}  // namespace
}  // namespace veridyn::aircraft::internal
