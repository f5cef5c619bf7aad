#include "veridyn/vehicle/identification/fit/drive_regression.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/identification/identified_drive.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/model/rolling_bicycle.hpp"

namespace veridyn::vehicle {
namespace {

using testing::drive_bicycle;
using testing::family_car;
using testing::lively_drive;
using testing::mapped;

// The bicycle with small angles obeys both relations without error, so each coefficient is its closed form.
TEST(DriveRegression, CoefficientsAreTheirClosedForms) {
  const VehicleParameters<double> p = family_car();
  const DriveRegressions data = testing::exact_regressions(p);
  ASSERT_FALSE(data.direct);
  const Eigen::VectorXd first = data.first.regressors.colPivHouseholderQr().solve(data.first.regressand);
  const Eigen::VectorXd second = data.second.regressors.colPivHouseholderQr().solve(data.second.regressand);
  const double L = p.wheelbase();
  EXPECT_NEAR(first(0) / understeer_gradient(p), 1.0, 1e-4);
  EXPECT_NEAR(first(1) / (p.I_z / (2.0 * L) * (1.0 / p.C_f + 1.0 / p.C_r)), 1.0, 1e-4);
  EXPECT_NEAR(second(0) / (p.mass * p.a / (2.0 * L * p.C_r)), 1.0, 1e-4);
  EXPECT_NEAR(second(1) / (p.I_z / (2.0 * L * p.C_r)), 1.0, 1e-4);
  ASSERT_EQ(second.size(), 4) << "the speed varies: a bias of the gyro is a column of its own";
}

/// A rolling bicycle of small angles on linear tyres, by RK4 at 1 ms, recorded with its roll (gravity's share is in
/// accel_y) and noise of so much of that of usual sensors.
Recording recorded_roll(const VehicleParameters<double>& p, double noise) {
  using Car = RollingBicycle<double, LinearTyre<double>>;
  const BicycleModel<double, LinearTyre<double>> bicycle{.parameters = p,
                                                         .front = {.stiffness = p.C_f},
                                                         .rear = {.stiffness = p.C_r},
                                                         .geometry = BicycleGeometry::kSmallAngles};
  const Car car{.bicycle = bicycle, .roll = {.gradient = 0.009, .frequency = 9.0, .damping = 0.25, .arm = 0.5}};
  const testing::WanderingSteer steer(5, 0.015);
  constexpr double h = 1e-3, speed = 20.0;
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  std::vector<double> time;
  const std::array names{std::tuple{"steer", "rad", 1e-3},      std::tuple{"speed", "m/s", 0.05},
                         std::tuple{"yaw_rate", "rad/s", 2e-3}, std::tuple{"accel_y", "m/s^2", 0.05},
                         std::tuple{"roll", "rad", 1e-3},       std::tuple{"roll_rate", "rad/s", 2e-3}};
  std::array<std::vector<double>, names.size()> values;
  numerics::RandomStream random(11, "recorded roll");
  for (int k = 0; k <= 80000; ++k) {
    const double t = k * h;
    const auto rates = [&](const Eigen::Vector4d& state, double when) {
      return car.rates<4>(state, steer(when), speed);
    };
    const auto now = rates(x, t);
    if (k % 10 == 0) {
      time.push_back(t);
      const std::array shown{steer(t), speed, x(1), now.lateral_acceleration + kGravity * std::sin(x(2)), x(2), x(3)};
      for (std::size_t i = 0; i < names.size(); ++i)
        values[i].push_back(shown[i] + noise * std::get<2>(names[i]) * random.normal());
    }
    const Eigen::Vector4d k2 = rates(x + 0.5 * h * now.derivative, t + 0.5 * h).derivative;
    const Eigen::Vector4d k3 = rates(x + 0.5 * h * k2, t + 0.5 * h).derivative;
    const Eigen::Vector4d k4 = rates(x + h * k3, t + h).derivative;
    x += h / 6.0 * (now.derivative + 2.0 * (k2 + k3) + k4);
  }
  Recording out;
  out.source = "roll.csv";
  out.frame = Frame::kFlu;
  const TimeBase base = make_time_base(time);
  for (std::size_t i = 0; i < names.size(); ++i)
    out.add(make_channel(std::get<0>(names[i]), std::get<1>(names[i]), base, values[i]));
  return out;
}

/// Largest error of C_f, C_r and I_z by a method, a share, and whether all intervals of three sigma hold the truth.
std::pair<double, bool> error_of(const DriveSignals& signals, const VehicleParameters<double>& p,
                                 estimation::Method method) {
  const std::vector<TimeSpan> spans{{3.0, 40.0}, {40.0, 77.0}};
  const DriveRegressionResult result = equation_error(drive_regressions(signals, spans, p, 2.0), p, {});
  const AxleEstimate* axles = result.find(method);
  if (axles == nullptr || !axles->usable) return {1.0, false};
  const Eigen::Vector3d truth(p.C_f, p.C_r, p.I_z), error = axles->value - truth;
  const Eigen::Vector3d sigma = axles->covariance.diagonal().cwiseSqrt();
  return {error.cwiseQuotient(truth).cwiseAbs().maxCoeff(), (error.cwiseAbs().array() < 3.0 * sigma.array()).all()};
}

// Where roll is recorded a body that leans is no error of the equations any more.
TEST(DriveRegression, KnowsARecordedRoll) {
  const VehicleParameters<double> p = family_car();
  const DriveSignals exact = prepare_drive_signals(mapped(recorded_roll(p, 0.0)), {});
  const std::vector<TimeSpan> spans{{3.0, 77.0}};
  const DriveRegressions data = drive_regressions(exact, spans, p, 2.0);
  ASSERT_EQ(data.second.parameter_names.back(), "roll_arm");
  const Eigen::VectorXd second = data.second.regressors.colPivHouseholderQr().solve(data.second.regressand);
  EXPECT_NEAR(second(second.size() - 1), 0.5, 0.01) << "the arm";
  EXPECT_LT(error_of(exact, p, estimation::Method::kOls).first, 5e-3);
  DriveSignals without = exact;
  without[DriveSignal::kRoll] = without[DriveSignal::kRollRate] = {};
  EXPECT_GT(error_of(without, p, estimation::Method::kOls).first, 0.03);
}

TEST(DriveRegression, KnowsARollThatNoisySensorsRecorded) {
  const VehicleParameters<double> p = family_car();
  const DriveSignals noisy = prepare_drive_signals(mapped(recorded_roll(p, 1.0)), {});
  const auto [error, holds] = error_of(noisy, p, estimation::Method::kGtls);
  EXPECT_LT(error, 0.05);
  EXPECT_TRUE(holds);
}

// Of steady straight driving roll shows noise: no column of its own.
TEST(DriveRegression, HasNoColumnForARollThatIsNoise) {
  const Recording lively = recorded_roll(family_car(), 1.0);
  Recording flat = recording::without_channels(lively);
  numerics::RandomStream random(3, "flat");
  for (Channel c : lively.channels()) {
    if (c.name == "roll" || c.name == "roll_rate")
      for (double& v : c.value) v = 2e-3 * random.normal();
    flat.add(std::move(c));
  }
  const std::vector<TimeSpan> spans{{3.0, 77.0}};
  const DriveRegressions data = drive_regressions(prepare_drive_signals(mapped(flat), {}), spans, family_car(), 2.0);
  EXPECT_EQ(data.second.parameters(), 3);
}

TEST(DriveRegression, NamesTheSignalThatItLacks) {
  DriveSignals signals = prepare_drive_signals(
      mapped(record_drive(lively_drive(family_car(), 1, 0.02, 20.0), testing::perfect_sensors(), 1)), {});
  signals[DriveSignal::kAccelY] = {};
  const std::vector<TimeSpan> spans{{2.0, 18.0}};
  EXPECT_NE(why([&] { (void)drive_regressions(signals, spans, family_car(), 2.0); }).find("has no accel_y"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
