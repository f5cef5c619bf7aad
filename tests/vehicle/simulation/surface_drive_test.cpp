#include "veridyn/vehicle/simulation/surface_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/vehicle/road/circuit.hpp"

namespace veridyn::vehicle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Even, uphill along x.
struct Incline final : RoadSurface {
  explicit Incline(double angle) : slope(std::tan(angle)) {}
  [[nodiscard]] Point at(const Vector2d& p) const override { return {slope * p.x(), {slope, 0.0}}; }
  double slope;
};

/// A curve to the left about (0, radius), banked everywhere.
struct Cone final : RoadSurface {
  Cone(double around, double angle) : centre(0.0, around), radius(around), slope(std::tan(angle)) {}
  [[nodiscard]] Point at(const Vector2d& p) const override {
    const Vector2d out = p - centre;
    return {slope * (out.norm() - radius), slope * out.normalized()};
  }
  Vector2d centre;
  double radius, slope;
};

/// A hill of one cosine along x from 5 m on.
struct Hill final : RoadSurface {
  Hill(double top, double whole) : height(top), length(whole) {}
  [[nodiscard]] Point at(const Vector2d& p) const override {
    const double t = 2.0 * kPi * (p.x() - 5.0) / length;
    if (t <= 0.0 || t >= 2.0 * kPi) return {};
    return {0.5 * height * (1.0 - std::cos(t)), {kPi * height / length * std::sin(t), 0.0}};
  }
  double height, length;
};

/// The published 1:5 car on springs, driven on both axles, without losses.
Vehicle scaled_car() {
  const Study study = Study::parse(
      "kind = 'vehicle'\nbuiltin = 'reference_1to5'\nmu = 0.9\nK_s = 8000\nC_s = 60\nK_t = 20000\n"
      "[longitudinal]\nwheel_radius = 0.06\nwheel_inertia = 3.2e-4\ndrag_area = 0\nrolling_resistance = 0\n"
      "front_drive_share = 0.3\n",
      "car.toml");
  return read_vehicle(study.root(), VehicleNeeds::kFourWheel);
}

std::unique_ptr<SteppedVehicle> on(std::shared_ptr<const RoadSurface> surface) {
  const Vehicle car = scaled_car();
  return surface_vehicle(car, four_wheel_options(car), std::move(surface), 4.0);
}

Vector3d world_force(const SteppedVehicle& car) {
  const recording::MotionSample m = car.motion(Vector3d::Zero());
  return m.attitude * m.force;
}

// Gravity is all that a car feels that stands, or drives at even speed: along its axes g sin, g cos of its own
// attitude. The loads of its axles are those of a beam on the incline: m (g b cos - g c sin)/L in front.
TEST(SurfaceDrive, FeelsGravityAloneOnAnIncline) {
  const Vehicle vehicle = scaled_car();
  const VehicleParameters<double>& p = vehicle.parameters;
  for (const double angle : {7.0 * kDegree, 30.0 * kDegree, -30.0 * kDegree}) {
    const auto car = on(std::make_shared<Incline>(angle));
    for (int k = 0; k < 3000; ++k) car->step({.brake_torque = 20.0}, 1e-3);
    EXPECT_LT((world_force(*car) - Vector3d(0, 0, kGravity)).norm(), 2e-3) << angle;
    const recording::MotionSample m = car->motion(Vector3d::Zero());
    const double pitch = -numerics::euler_from_quaternion(m.attitude).theta;  // nose up, flu
    EXPECT_NEAR(m.force.x(), kGravity * std::sin(pitch), 2e-3);
    EXPECT_NEAR(pitch, angle, 1.0 * kDegree);  // the springs give way by less
    EXPECT_LT(car->world().velocity.norm(), 1e-3);
    const double front = p.mass * kGravity * (p.b * std::cos(angle) - p.cg_height * std::sin(angle)) / p.wheelbase();
    EXPECT_NEAR(car->loads()[0] + car->loads()[1], front, 0.02 * front) << angle;
    EXPECT_NEAR(car->loads().sum(), p.mass * kGravity * std::cos(angle), 1e-2);
  }
}

TEST(SurfaceDrive, ClimbsAsNewtonSays) {
  // From rest, with the force F at the wheels: (m + 4 I/R^2) a = F - m g sin.
  const Vehicle vehicle = scaled_car();
  const double angle = 7.0 * kDegree, force = 20.0, mass = vehicle.parameters.mass;
  const auto car = on(std::make_shared<Incline>(angle));
  for (int k = 0; k < 3000; ++k) car->step({.brake_torque = 20.0}, 1e-3);
  for (int k = 0; k < 1000; ++k) car->step({.drive_torque = force * 0.06}, 1e-3);
  const double a = (force - mass * kGravity * std::sin(angle)) / (mass + 4.0 * 3.2e-4 / (0.06 * 0.06));
  EXPECT_NEAR(car->world().velocity.norm(), a, 0.01 * a);
  EXPECT_NEAR(car->world().velocity.z() / car->world().velocity.x(), std::tan(angle), 2e-3);
  // What it feels is not gravity alone: its own acceleration comes to it, along the road.
  const Vector3d beyond = world_force(*car) - Vector3d(0, 0, kGravity);
  EXPECT_NEAR(beyond.x(), a * std::cos(angle), 0.02 * a);
  EXPECT_NEAR(beyond.z(), a * std::sin(angle), 0.02 * a);
}

// On a banked curve of constant radius at constant speed the world sees a rotation about the vertical with v/R, and
// v^2/R inward; the road, m (g cos + v^2/R sin) square to it.
TEST(SurfaceDrive, FeelsWhatAConstantBankedCurveAsksFor) {
  constexpr double kSpeed = 3.0, kRadius = 6.0;
  const Vehicle vehicle = scaled_car();
  for (const double angle : {0.0, 8.0 * kDegree, 20.0 * kDegree}) {
    const auto cone = std::make_shared<Cone>(kRadius, angle);
    const auto car = on(cone);
    car->reset(kSpeed);
    double steer = 0.06, held = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const FourWheelState<double>& s = car->state().vehicle;
      const Vector2d out = Vector2d(s(kX), s(kY)) - cone->centre;
      const double drift = car->world().velocity.head<2>().dot(out.normalized());
      held += 1e-3 * (out.norm() - kRadius);
      steer = 0.06 + 0.5 * (out.norm() - kRadius) + 0.2 * drift + 0.3 * held;
      car->step({.steer = steer, .drive_torque = 2.0 * (kSpeed - s(kU)) + 0.05}, 1e-3);
    }
    const Vector2d out = car->world().position.head<2>() - cone->centre;
    const double v = car->world().velocity.norm(), radius = out.norm();
    ASSERT_NEAR(v, kSpeed, 0.1);
    ASSERT_NEAR(radius, kRadius, 0.05);
    const recording::MotionSample m = car->motion(Vector3d::Zero());
    const Vector3d rate = m.attitude * m.rate;
    EXPECT_LT((rate - Vector3d(0, 0, v / radius)).norm(), 2e-3) << angle;
    const double inward = v * v / radius;
    const Vector3d force = m.attitude * m.force;
    const Vector2d to_centre = -out.normalized();
    EXPECT_NEAR(force.head<2>().dot(to_centre), inward, 0.005 * inward) << angle;
    EXPECT_NEAR(force.z(), kGravity, 5e-3) << angle;
    const double load = vehicle.parameters.mass * (kGravity * std::cos(angle) + inward * std::sin(angle));
    EXPECT_NEAR(car->loads().sum(), load, 2e-3 * load) << angle;
  }
}

// Without losses a car that coasts over a hill has there v^2 - 2 g h m/(m + 4 I/R^2), and behind it what it had.
TEST(SurfaceDrive, TradesSpeedForHeight) {
  const Vehicle vehicle = scaled_car();
  const double mass = vehicle.parameters.mass, share = mass / (mass + 4.0 * 3.2e-4 / (0.06 * 0.06));
  const auto car = on(std::make_shared<Hill>(0.5, 20.0));
  car->reset(4.0);
  double slowest = 10.0;
  for (int k = 0; k < 9000; ++k) {
    car->step({}, 1e-3);
    slowest = std::min(slowest, car->state().vehicle(kU));
  }
  ASSERT_GT(car->state().vehicle(kX), 25.0);
  EXPECT_NEAR(slowest, std::sqrt(16.0 - 2.0 * kGravity * 0.5 * share), 5e-3);
  EXPECT_NEAR(car->state().vehicle(kU), 4.0, 5e-3);
}

/// Drives along the middle line at an even speed, and hands each millisecond's motion over.
template <typename See>
void lap(SteppedVehicle& car, const Circuit& circuit, double speed, int steps, const See& see) {
  double integral = 0.0;
  for (int k = 0; k < steps; ++k) {
    const FourWheelState<double>& s = car.state().vehicle;
    const Vector2d place(s(kX), s(kY));
    const Circuit::Located at = circuit.locate(place);
    const Vector2d to = circuit.middle(at.distance + 0.8) - place;
    const double bearing = std::remainder(std::atan2(to.y(), to.x()) - s(kYaw), 2.0 * kPi);
    const double missing = speed - s(kU);
    integral = std::clamp(integral + 4e-3 * missing, -3.0, 3.0);
    const double torque = 3.0 * missing + integral;
    car.step({.steer = std::atan(2.0 * 0.45 * std::sin(bearing) / to.norm()),
              .drive_torque = std::max(torque, 0.0),
              .brake_torque = std::max(-torque, 0.0)},
             1e-3);
    see(k);
  }
}

// Whatever the road does: position, velocity, attitude, rates and specific force are of one motion.
TEST(SurfaceDrive, SaysOneMotionInAllItsChannelsAroundTheCircuit) {
  CircuitOptions smooth;
  smooth.rough.clear();  // differences over 2 ms say nothing of what shakes faster
  smooth.bumps.clear();
  const auto circuit = std::make_shared<Circuit>(smooth);
  const auto car = on(circuit);
  std::vector<recording::MotionSample> motions;
  std::vector<WorldMotion> places;
  double farthest = 0.0, lowest_load = 1e9;
  lap(*car, *circuit, 1.8, 26000, [&](int) {
    motions.push_back(car->motion(Vector3d::Zero()));
    places.push_back(car->world());
    const Circuit::Located on = circuit->locate(places.back().position.head<2>());
    farthest = std::max(farthest, std::abs(on.offset));
    lowest_load = std::min(lowest_load, car->loads().minCoeff());
  });
  EXPECT_LT(farthest, 0.3);
  EXPECT_GT(places.size(), 0U);
  double along = 0.0, force = 0.0, rate = 0.0, squares = 0.0;
  Vector3d most = Vector3d::Zero();
  for (std::size_t k = 2001; k + 1 < places.size(); ++k) {
    const Vector3d v = (places[k + 1].position - places[k - 1].position) / 2e-3;
    const Vector3d a = (places[k + 1].velocity - places[k - 1].velocity) / 2e-3;
    const Eigen::Quaterniond turn = motions[k - 1].attitude.conjugate() * motions[k + 1].attitude;
    const Vector3d w = 2.0 * turn.vec() / turn.w() / 2e-3;
    along = std::max(along, (v - places[k].velocity).norm());
    const double missed = (motions[k].attitude * motions[k].force - Vector3d(0, 0, kGravity) - a).norm();
    force = std::max(force, missed);
    squares += missed * missed;
    rate = std::max(rate, (w - motions[k].rate).norm());
    most = most.cwiseMax(motions[k].rate.cwiseAbs());
  }
  EXPECT_GT(most.y(), 0.5) << "ramps turn it";
  EXPECT_LT(along, 0.005);
  EXPECT_LT(rate, 0.005);
  // Differences over 2 ms, where tyres come to the limit of their friction within less.
  EXPECT_LT(force, 0.2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(places.size())), 0.01);
}

TEST(SurfaceDrive, DrivesTheCircuitOfRampsBanksBumpsAndRoughnessBothWaysFromRest) {
  const auto circuit = std::make_shared<Circuit>();
  const auto car = on(circuit);
  double steepest = 0.0, banked = 0.0, highest = 0.0, farthest = 0.0;
  double rough = 0.0, smooth = 0.0;  // what shakes it up and down there and on asphalt
  int in_rough = 0, in_smooth = 0;
  lap(*car, *circuit, 1.8, 26000, [&](int) {
    const recording::MotionSample m = car->motion(Vector3d::Zero());
    const auto angles = numerics::euler_from_quaternion(m.attitude);
    steepest = std::max(steepest, std::abs(angles.theta));
    banked = std::max(banked, std::abs(angles.phi));
    highest = std::max(highest, car->world().position.z());
    const Circuit::Located on = circuit->locate(m.position);
    farthest = std::max(farthest, std::abs(on.offset));
    if (on.distance > 29.0 && on.distance < 31.5) rough += std::pow(m.force.z() - kGravity, 2), ++in_rough;
    if (on.distance > 14.0 && on.distance < 20.0) smooth += std::pow(m.force.z() - kGravity, 2), ++in_smooth;
  });
  EXPECT_GT(car->state().vehicle(kDistance), circuit->length());
  EXPECT_LT(farthest, 0.3);
  EXPECT_NEAR(steepest, 30.0 * kDegree, 2.5 * kDegree);
  EXPECT_NEAR(banked, 8.0 * kDegree, 2.0 * kDegree);
  EXPECT_NEAR(highest, 0.6, 0.01);
  ASSERT_GT(in_rough * in_smooth, 0);
  EXPECT_GT(std::sqrt(rough / in_rough), 2.0 * std::sqrt(smooth / in_smooth));
}

TEST(SurfaceDrive, GoesOnFromACopyAsTheOriginal) {
  const auto circuit = std::make_shared<Circuit>();
  const auto car = on(circuit);
  lap(*car, *circuit, 1.8, 3000, [](int) {});
  const auto copy = car->clone();
  for (int k = 0; k < 500; ++k) {
    car->step({.steer = 0.05, .drive_torque = 0.5}, 1e-3);
    copy->step({.steer = 0.05, .drive_torque = 0.5}, 1e-3);
  }
  EXPECT_LT((car->state().vehicle - copy->state().vehicle).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SurfaceDrive, RefusesWhatCannotClimb) {
  const Vehicle car = scaled_car();
  FourWheelOptions options = four_wheel_options(car);
  const auto surface = std::make_shared<Incline>(0.1);
  EXPECT_NE(why([&] { static_cast<void>(surface_vehicle(car, options, nullptr)); }).find("there is none"),
            std::string::npos);
  options.longitudinal->grade = 0.1;
  EXPECT_NE(why([&] { static_cast<void>(surface_vehicle(car, options, surface)); }).find("grade"), std::string::npos);
  options.longitudinal.reset();
  EXPECT_NE(why([&] { static_cast<void>(surface_vehicle(car, options, surface)); }).find("longitudinal dynamics"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
