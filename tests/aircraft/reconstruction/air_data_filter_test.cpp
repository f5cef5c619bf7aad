#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"

namespace veridyn::aircraft {
namespace {

using FullModel = AirDataModel<true>;

FullModel::State<double> full_state() {
  FullModel::State<double> x;
  x.attitude = numerics::quaternion_from_euler(0.4, -0.3, 2.0);
  x.velocity << 12.0, 9.0, -2.0;
  x.gust << 0.4, -0.8, 0.3, 0.6, 0.1;
  x.wind << 3.0, -4.0, 0.2;
  x.imu_bias << 0.01, -0.02, 0.005, 0.3, -0.1, 0.2;
  x.imu_scale << 0.02, -0.03, 0.01, 0.04, -0.02, 0.03;
  x.air_error << 0.02, -0.01, 0.2, 0.05, 4.0;
  return x;
}

FullModel some_model() {
  FullModel model;
  model.spectrum = {200.0, 200.0, 50.0, 2.12, 2.12, 1.4};
  return model;
}

TEST(AirDataModel, TransitionEqualsAutomaticDifferentiation) {
  const FullModel model = some_model();
  for (const double scale : {0.0, 1.0, 30.0}) {  // at rest, turning, tumbling
    const FullModel::Input u{
        .gyro = Eigen::Vector3d(0.5, -0.3, 0.2) * scale, .specific_force = {1.0, -0.5, -11.0}, .airspeed = 15.0};
    FullModel::State<double> after, after_automatic;
    const auto F = model.transition_rows(full_state(), u, 0.02, after);
    const auto J = estimation::automatic_transition(model, full_state(), u, 0.02, after_automatic);
    EXPECT_LT((F - J).cwiseAbs().maxCoeff(), 1e-12) << "scale " << scale;
  }
}

TEST(AirDataModel, TransitionEqualsFiniteDifferences) {
  const FullModel model = some_model();
  const FullModel::Input u{.gyro = {0.5, -0.3, 0.2}, .specific_force = {1.0, -0.5, -11.0}, .airspeed = 15.0};
  FullModel::State<double> after;
  const auto F = model.transition_rows(full_state(), u, 0.02, after);
  constexpr double h = 1e-6;
  for (int j = 0; j < FullModel::kStates; ++j) {
    FullModel::Vector e = FullModel::Vector::Zero();
    e(j) = h;
    const auto plus = model.propagate<double>(FullModel::retract<double>(full_state(), e), u, 0.02);
    const auto minus =
        model.propagate<double>(FullModel::retract<double>(full_state(), FullModel::Vector(-e)), u, 0.02);
    const FullModel::Vector column =
        (FullModel::local<double>(after, plus) - FullModel::local<double>(after, minus)) / (2.0 * h);
    EXPECT_LT((F.col(j) - column.head<FullModel::kDynamic>()).cwiseAbs().maxCoeff(), 1e-8) << "error component " << j;
  }
}

TEST(AirDataModel, MeasurementRowsEqualFiniteDifferences) {
  const FullModel model = some_model();
  const Eigen::Vector3d arm(0.2, -0.1, 0.4);
  using FullState = FullModel::State<double>;
  const std::vector<std::function<Prediction(const FullState&)>> sensors{
      [&](const FullState& x) { return predict_ground_velocity(x, 1); },
      [&](const FullState& x) { return predict_euler_angle(x, 0).value(); },
      [&](const FullState& x) { return predict_euler_angle(x, 1).value(); },
      [&](const FullState& x) { return predict_euler_angle(x, 2).value(); },
      [&](const FullState& x) { return predict_dynamic_pressure(model, x, 1.1); },
      [&](const FullState& x) { return predict_airspeed(model, x); },
      [&](const FullState& x) { return predict_alpha(model, x, arm); },
      [&](const FullState& x) { return predict_beta(model, x, arm, false); },
      [&](const FullState& x) { return predict_beta(model, x, arm, true); }};
  constexpr double h = 1e-5;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const FullModel::Vector H = FullModel::row(sensors[s](full_state()));
    for (int j = 0; j < FullModel::kStates; ++j) {
      FullModel::Vector e = FullModel::Vector::Zero();
      e(j) = h;
      const double slope = (sensors[s](FullModel::retract<double>(full_state(), e)).value -
                            sensors[s](FullModel::retract<double>(full_state(), FullModel::Vector(-e))).value) /
                           (2.0 * h);
      EXPECT_NEAR(H(j), slope, 1e-6 * std::max(1.0, std::abs(slope))) << "sensor " << s << ", component " << j;
    }
  }
}

TEST(AirDataModel, HasNoEulerAnglesAtTheZenith) {
  FullModel::State<double> x = full_state();
  x.attitude = numerics::quaternion_from_euler(0.1, 88.0 * kDegree, 0.2);
  for (int axis = 0; axis < 3; ++axis) EXPECT_FALSE(predict_euler_angle(x, axis).has_value()) << axis;
}

// The filter without errors of inertial sensors is the other one with these held at zero: the same step to the last
// bit.
TEST(AirDataModel, StepsAlikeWithAndWithoutErrorsOfInertialSensors) {
  AirDataModel<false> small;
  small.spectrum = some_model().spectrum;
  const FullModel full = some_model();
  AirDataState<double> x = full_state();
  x.imu_bias.setZero();
  x.imu_scale.setZero();
  const AirDataInput u{.gyro = {0.5, -0.3, 0.2}, .specific_force = {1.0, -0.5, -11.0}, .airspeed = 15.0};
  AirDataState<double> after_small, after_full;
  const auto F = small.transition_rows(x, u, 0.02, after_small);
  const auto G = full.transition_rows(x, u, 0.02, after_full);
  EXPECT_EQ((F - G.leftCols<AirDataMotion::kCore>()).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(after_small.velocity, after_full.velocity);
  EXPECT_EQ(after_small.attitude.coeffs(), after_full.attitude.coeffs());
}

TEST(AirDataModel, KeepsTheGustsStationaryForAnyStep) {
  FullModel model = some_model();
  for (const double dt : {1e-3, 0.01, 0.7, 100.0}) {
    const FullModel::Input u{.airspeed = 22.0};
    FullModel::State<double> after;
    const auto F = model.transition_rows(full_state(), u, dt, after);
    const Eigen::Matrix<double, 5, 5> G = F.block<5, 5>(FullModel::kGust, FullModel::kGust);
    FullModel::Covariance Q = FullModel::Covariance::Zero();
    model.add_process_noise(full_state(), u, dt, Q);
    const Eigen::Matrix<double, 5, 5> Pi = FullModel::stationary_gust_covariance();
    const Eigen::Matrix<double, 5, 5> next = G * Pi * G.transpose() + Q.block<5, 5>(6, 6);
    EXPECT_LT((next - Pi).cwiseAbs().maxCoeff(), 1e-14) << dt;
  }
}

// The specification's equations of section 5, with the gusts frozen: u_r' = ax - q w_r + r v_r - g sin(theta), ...
TEST(AirDataModel, ObeysTheSpecificationsEquationsOfMotion) {
  const AirDataModel<false> model;
  AirDataState<double> x;
  const double phi = 0.4, theta = -0.3, dt = 1e-5;
  x.attitude = numerics::quaternion_from_euler(phi, theta, 2.0);
  x.velocity << 12.0, 9.0, -2.0;
  x.wind << 3.0, -4.0, 0.2;
  const Eigen::Vector3d omega(0.5, -0.3, 0.2), a(1.0, -0.5, -11.0), v = model.air_velocity(x);
  const auto next = model.propagate<double>(x, {.gyro = omega, .specific_force = a, .airspeed = 15.0}, dt);
  const Eigen::Vector3d rate = (model.air_velocity(next) - v) / dt;
  const double g = 9.80665, p = omega(0), q = omega(1), r = omega(2);
  EXPECT_NEAR(rate(0), a(0) - q * v(2) + r * v(1) - g * std::sin(theta), 1e-3);
  EXPECT_NEAR(rate(1), a(1) - r * v(0) + p * v(2) + g * std::cos(theta) * std::sin(phi), 1e-3);
  EXPECT_NEAR(rate(2), a(2) - p * v(1) + q * v(0) + g * std::cos(theta) * std::cos(phi), 1e-3);
}

}  // namespace
}  // namespace veridyn::aircraft
