#include "veridyn/vehicle/tracking/axle_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;

constexpr double kStep = 0.01;

KnownBody leaning_body() {
  KnownBody body{.source = BodySource::kEstimate, .I_z = family_car().I_z};
  body.roll = {.gradient = 0.01, .frequency = 9.0, .damping = 0.25, .arm = 0.4};
  body.relaxation_length = 0.4;
  return body;
}

/// What a sensor 0.2 m above the centre of gravity of a rolling bicycle shows, by RK4 at 1 ms.
template <int kStates, typename Tyre>
std::vector<DriveSample> driven(const RollingBicycle<double, Tyre>& car, const std::function<double(double)>& steer,
                                double speed, double duration) {
  using State = Eigen::Matrix<double, kStates, 1>;
  constexpr double h = 1e-3, height = 0.2;
  State x = State::Zero();
  std::vector<DriveSample> samples;
  const auto steps = static_cast<int>(duration / h);
  for (int k = 0; k <= steps; ++k) {
    const double t = k * h;
    const auto at = [&](const State& state, double when) { return car.rates(state, steer(when), speed); };
    const auto k1 = at(x, t);
    if (k % 10 == 0) {
      double accel = k1.lateral_acceleration;
      if constexpr (kStates > 2) accel += kGravity * x(2) - height * k1.derivative(3);
      samples.push_back({.time = t, .steer = steer(t), .speed = speed, .yaw_rate = x(1), .accel_y = accel});
    }
    const State d2 = at(x + 0.5 * h * k1.derivative, t + 0.5 * h).derivative;
    const State d3 = at(x + 0.5 * h * d2, t + 0.5 * h).derivative;
    const State d4 = at(x + h * d3, t + h).derivative;
    x += h / 6.0 * (k1.derivative + 2.0 * (d2 + d3) + d4);
  }
  return samples;
}

template <typename Tyre>
RollingBicycle<double, Tyre> car_with(const Tyre& front, const Tyre& rear, const KnownBody& body) {
  return {
      .bicycle = {.parameters = family_car(), .front = front, .rear = rear, .geometry = BicycleGeometry::kSmallAngles},
      .roll = body.roll,
      .relaxation_length = body.relaxation_length};
}

/// Slopes of z over x of the rows, front and rear: 1 where the equations hold.
std::array<double, 2> slopes(const std::vector<DriveSample>& samples, const KnownBody& body) {
  AxleRows rows(family_car(), body, {.gravity = kGravity, .height = 0.2}, 1.0 / kStep, 2.0);
  double fx = 0.0, fz = 0.0, rx = 0.0, rz = 0.0;
  for (const DriveSample& s : samples) {
    if (!rows.append(s) || s.time < 5.0) continue;
    const AxleRowSet set = rows.rows();
    fx += set.front.x[0] * set.front.x[0];
    fz += set.front.x[0] * set.front.z;
    rx += set.rear.x[0] * set.rear.x[0];
    rz += set.rear.x[0] * set.rear.z;
  }
  return {fz / fx, rz / rx};
}

const std::function<double(double)> kLively = [](double t) {
  return 0.015 * std::sin(2.0 * kPi * 0.9 * t) + 0.02 * std::sin(2.0 * kPi * 0.23 * t + 1.0);
};

// The rolling bicycle on linear tyres, simulated apart: every equation holds for it but for what the trapezoidal rule
// and the kernels are off. Without the body compliances are a tenth off.
TEST(AxleRows, HoldForACarThatLeansOnTyresThatLag) {
  const VehicleParameters<double> p = family_car();
  const KnownBody body = leaning_body();
  const auto car = car_with(LinearTyre<double>{.stiffness = p.C_f}, {.stiffness = p.C_r}, body);
  const std::vector<DriveSample> samples = driven<6>(car, kLively, 20.0, 30.0);
  const std::array<double, 2> known = slopes(samples, body);
  EXPECT_NEAR(known[0], 1.0, 3e-3);
  EXPECT_NEAR(known[1], 1.0, 3e-3);
  const std::array<double, 2> unknown = slopes(samples, {.I_z = p.I_z});
  EXPECT_GT(std::abs(unknown[0] - 1.0), 0.08);
}

TEST(AxleRows, UndersteerIsThatOfTheStiffnesses) {
  const VehicleParameters<double> p = family_car();
  const KnownBody body = leaning_body();
  const auto car = car_with(LinearTyre<double>{.stiffness = p.C_f}, {.stiffness = p.C_r}, body);
  AxleRows rows(p, body, {.gravity = kGravity, .height = 0.2}, 1.0 / kStep, 2.0);
  const double K = 0.5 * p.mass / p.wheelbase() * (p.b / p.C_f - p.a / p.C_r);
  const double lag = 0.5 * p.I_z / p.wheelbase() * (1.0 / p.C_f + 1.0 / p.C_r);
  EXPECT_NEAR(rows.lag_scale(), lag, 1e-12);
  for (const DriveSample& s : driven<6>(car, kLively, 20.0, 20.0)) {
    if (!rows.append(s) || s.time < 5.0) continue;
    const AxleRow<3> row = rows.rows().understeer;
    EXPECT_NEAR(row.z, K / rows.understeer_scale() * row.x[0] + row.x[1], 1e-5) << s.time;
  }
}

// Brush tyres driven to a third of their limit: 12 % of the stiffness is lost there, and comes back.
TEST(AxleRows, TakeSaturationOff) {
  const VehicleParameters<double> p = family_car();
  KnownBody body = leaning_body();
  const FialaTyre<double> front{.stiffness = p.C_f, .mu = 1.0}, rear{.stiffness = p.C_r, .mu = 1.0};
  const auto car = car_with(front, rear, body);
  const std::function<double(double)> hard = [](double t) { return 1.5 * kLively(t); };
  const std::vector<DriveSample> samples = driven<6>(car, hard, 20.0, 30.0);
  const std::array<double, 2> linear = slopes(samples, body);
  body.tyres = car;
  const std::array<double, 2> known = slopes(samples, body);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_GT(linear[i], 1.08);
    EXPECT_NEAR(known[i], 1.0, 0.02);
  }
}

TEST(AxleRows, ScaleTheCurveWithGrip) {
  const VehicleParameters<double> p = family_car();
  KnownBody body = leaning_body();
  const auto car = [&](double grip) {
    return car_with(FialaTyre<double>{.stiffness = grip * p.C_f, .mu = grip}, {.stiffness = grip * p.C_r, .mu = grip},
                    body);
  };
  body.tyres = car(1.0);
  AxleRows rows(p, body, {.gravity = kGravity, .height = 0.2}, 1.0 / kStep, 2.0);
  rows.set_grip({0.6, 0.6});
  double x = 0.0, z = 0.0;
  for (const DriveSample& s : driven<6>(car(0.6), kLively, 20.0, 30.0)) {
    if (!rows.append(s) || s.time < 5.0) continue;
    const AxleRow<2> row = rows.rows().front;
    x += row.x[0] * row.x[0];
    z += row.x[0] * row.z;
  }
  EXPECT_NEAR(z / x * 0.6, 1.0, 0.02);
}

// White noise of the sensors alone, at rest in straight driving: rows scatter as their covariance says.
TEST(AxleRows, ScatterAsTheirCovarianceSays) {
  const std::array<double, 4> noise{2e-3, 0.0, 2e-3, 0.05};
  AxleRows rows(family_car(), {.I_z = family_car().I_z}, {}, 1.0 / kStep, 2.0);
  numerics::RandomStream random(1, "rows");
  Eigen::Matrix3d front = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (int k = 0; k < 200000; ++k) {
    const DriveSample s{k * kStep, noise[0] * random.normal(), 20.0, noise[2] * random.normal(),
                        noise[3] * random.normal()};
    if (!rows.append(s) || k % 13 != 0) continue;
    const AxleRow<2> row = rows.rows().front;
    const Eigen::Vector3d v(row.x[0], 0.0, row.z);
    front += v * v.transpose();
    count += 1.0;
  }
  front /= count;
  const Eigen::MatrixXd stated = rows.noise_covariance(TrackedAxle::kFront, noise, 20.0);
  EXPECT_NEAR(front(0, 0), stated(0, 0), 0.05 * stated(0, 0));
  EXPECT_NEAR(front(2, 2), stated(2, 2), 0.05 * stated(2, 2));
  EXPECT_NEAR(front(0, 2), stated(0, 2), 0.05 * std::sqrt(stated(0, 0) * stated(2, 2)));
}

TEST(AxleRows, BeginAgainAfterAHole) {
  const KnownBody body = leaning_body();
  AxleRows rows(family_car(), body, {.gravity = kGravity}, 1.0 / kStep, 2.0);
  const auto sample = [](double t) { return DriveSample{t, 0.01, 20.0, 0.1, 2.0}; };
  int first = 0;
  while (!rows.append(sample(first * kStep))) ++first;
  // The kernel's length and what a beginning needs to be forgotten.
  const BodyFollower follower(body, {}, kStep);
  EXPECT_NEAR(first * kStep, 2.0 * rows.latency_s() + follower.settling_s(), 0.02);
  EXPECT_TRUE(rows.append(sample((first + 1) * kStep)));
  EXPECT_FALSE(rows.append(sample((first + 10) * kStep))) << "a step of 90 ms";
  EXPECT_FALSE(rows.append({(first + 11) * kStep, 0.01, 20.0, std::nan(""), 2.0}));
}

// In steady cornering the accelerometer shows a_y + g phi with phi = G a_y.
TEST(BodyFollower, TakesTheLeanOffTheAccelerometer) {
  const KnownBody body = leaning_body();
  BodyFollower follower(body, {.gravity = kGravity}, kStep);
  const DriveSample steady{0.0, 0.01, 20.0, 0.1, 2.0 * (1.0 + kGravity * body.roll.gradient)};
  EXPECT_NEAR(follower.begin(steady).accel_y, 2.0, 1e-12);
  BicycleSample last;
  for (int k = 0; k < 300; ++k) last = follower.next(steady);
  EXPECT_NEAR(last.accel_y, 2.0, 1e-9);
  EXPECT_NEAR(last.shifted, 2.0 * body.roll.gradient, 1e-9);
  EXPECT_NEAR(last.contact_rate, 2.0 - 20.0 * 0.1, 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
