#include "veridyn/vehicle/manoeuvre/driver_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/manoeuvre/lane_change.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"
#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

BicycleModel<double, LinearTyre<double>> linear_car() {
  const VehicleParameters<double> p;
  return {p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, 9.80665, BicycleGeometry::kSmallAngles};
}

BicycleModel<double, FialaTyre<double>> car_with_friction(double mu) {
  const VehicleParameters<double> p;
  return {p, {.stiffness = p.C_f, .mu = mu}, {.stiffness = p.C_r, .mu = mu}};
}

template <typename Model>
VehicleTrajectory drive(const Model& model, Driver& driver, double speed, double duration) {
  Progress silent;
  return simulate(model, driver, {.duration = duration, .speed = speed}, silent);
}

/// Distance from the path at the end of a drive.
double final_error(const VehicleTrajectory& t, const Path& path) {
  const double s = path.nearest(t.x.back(), t.y.back());
  const PathPoint q = path.at(s);
  return std::hypot(t.x.back() - q.x, t.y.back() - q.y);
}

// On a circle a constant steer keeps the predicted motion on the path only if it is the right one.
TEST(DriverModel, FollowsACircleWithoutErrorWhereItsModelIsPerfect) {
  const auto path = std::make_shared<const Path>(Path::circle(60.0));
  const auto car = linear_car();
  PreviewDriver driver(linearise(car, 15.0), path);
  const VehicleTrajectory t = drive(car, driver, 15.0, 60.0);
  ASSERT_EQ(t.end, DriveEnd::kCompleted);
  // What is left comes from the sideslip angle squared: the way goes on with sqrt(u^2 + v^2), the driver counts on u.
  EXPECT_LT(final_error(t, *path), 1e-4);
  EXPECT_NEAR(t.r.back(), 15.0 / 60.0, 1e-3);
  const BicycleCharacteristics<double> c = characteristics(linearise(car, 15.0));
  EXPECT_NEAR(t.steer.back(), 1.0 / (60.0 * c.curvature_gain), 1e-3 / (60.0 * c.curvature_gain));
}

TEST(DriverModel, TurnsLeftAndRightEqually) {
  const auto car = linear_car();
  PreviewDriver left(linearise(car, 15.0), std::make_shared<const Path>(Path::circle(60.0, 1)));
  PreviewDriver right(linearise(car, 15.0), std::make_shared<const Path>(Path::circle(60.0, -1)));
  const VehicleTrajectory a = drive(car, left, 15.0, 10.0), b = drive(car, right, 15.0, 10.0);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a.y[i], -b.y[i], 1e-9);
}

// A step in the path's curvature is answered a preview time ahead, and nothing happens before the delay has passed.
TEST(DriverModel, ActsAfterItsDelayAndBeforeTheBend) {
  auto path = std::make_shared<Path>();
  path->append_line(100.0).append_arc(100.0, 0.02);
  const auto car = linear_car();
  PreviewDriver driver(linearise(car, 20.0), path, {.preview_time = 1.0, .delay = 0.25});
  const VehicleTrajectory t = drive(car, driver, 20.0, 6.0);
  // The bend is at 5 s; it comes into sight at 4 s.
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t.time[i] < 4.0 + 0.25 - 0.01) {
      EXPECT_NEAR(t.steer[i], 0.0, 1e-12) << t.time[i];
    }
  }
  const auto at = [&](double when) { return t.steer[static_cast<std::size_t>(std::lround(when * 100.0))]; };
  EXPECT_GT(at(4.6), 1e-4);
}

TEST(DriverModel, KeepsItsLimits) {
  auto path = std::make_shared<Path>();
  path->append_line(20.0).append_arc(60.0, 0.1);
  const auto car = linear_car();
  PreviewDriver driver(linearise(car, 15.0), path, {.max_steer = 0.1, .max_steer_rate = 0.2});
  const VehicleTrajectory t = drive(car, driver, 15.0, 4.0);
  double most = 0.0, fastest = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    most = std::max(most, std::abs(t.steer[i]));
    fastest = std::max(fastest, std::abs(t.steer[i] - t.steer[i - 1]) / (t.time[i] - t.time[i - 1]));
  }
  EXPECT_NEAR(most, 0.1, 1e-6);
  EXPECT_NEAR(fastest, 0.2, 1e-6);
}

// Looking at an earlier time begins a new drive: the same driver drives twice in the same way.
TEST(DriverModel, DrivesTheSameWayAgain) {
  const auto car = linear_car();
  PreviewDriver driver(linearise(car, 15.0), std::make_shared<const Path>(Path::circle(60.0)));
  const VehicleTrajectory first = drive(car, driver, 15.0, 5.0), second = drive(car, driver, 15.0, 5.0);
  EXPECT_EQ(first.y, second.y);
}

// The task of the standard: 80 km/h through the lanes, with the reference car on dry road.
TEST(DriverModel, KeepsTheLanesOfTheDoubleLaneChangeAt80AndLeavesThemTooFast) {
  const auto pass = [](double speed, double mu) {
    ManoeuvreContext context;
    context.speed = speed;
    const Manoeuvre m = double_lane_change(context);
    const auto car = car_with_friction(mu);
    const VehicleTrajectory t = drive(car, *m.driver, speed, m.default_duration);
    return check_lanes(t, *m.course, m.body);
  };
  const LaneCheck good = pass(80.0 / 3.6, 1.0);
  EXPECT_TRUE(good.within) << good.margin << " m in lane " << good.lane << " at " << good.time << " s";
  EXPECT_TRUE(good.finished);
  EXPECT_FALSE(pass(140.0 / 3.6, 1.0).within);
  EXPECT_FALSE(pass(80.0 / 3.6, 0.3).within);  // on snow
}

// The same driver in the exactly similar small car on the small course: every margin one fifth.
TEST(DriverModel, DrivesTheScaledCarThroughTheScaledCourse) {
  const SimilaritySubject prototype{.parameters = {}, .speed = 80.0 / 3.6};
  const ScaledVehicle twin = scale(prototype, {.length_ratio = 0.2});
  const auto pass = [](const SimilaritySubject& subject, double size) {
    const VehicleParameters<double>& p = subject.parameters;
    const Manoeuvre m = double_lane_change({.parameters = p, .speed = subject.speed}, 0.0, size);
    const BicycleModel<double, LinearTyre<double>> car{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
    return check_lanes(drive(car, *m.driver, subject.speed, m.default_duration), *m.course, m.body);
  };
  const LaneCheck full = pass(prototype, 1.0), small = pass(twin.model, 0.2);
  EXPECT_TRUE(small.within);
  EXPECT_NEAR(5.0 * small.margin, full.margin, 1e-6);
  EXPECT_EQ(small.lane, full.lane);
}

// ISO 4138 at constant radius: the driver holds the circle while drive torque raises the speed; the understeer gradient
// measured so is that of the linear tyres. Their load does not act on linear tyres, and the drive is at the rear, whose
// torque is small.
TEST(DriverModel, MeasuresTheUndersteerGradientOnACircle) {
  VehicleParameters<double> p;
  p.K_tf = p.K_tr = 200000.0;
  const ManoeuvreContext context{.parameters = p, .speed = 10.0};
  const Manoeuvre m = constant_radius_circle(context, 80.0, 18.0, 60.0, {.delay = 0.1});
  const LinearTyre<double> front{.stiffness = p.C_f}, rear{.stiffness = p.C_r};
  const FourWheelModel<double, LinearTyre<double>> car(p, {front, front, rear, rear},
                                                       {.longitudinal = LongitudinalParameters{}});
  Progress silent;
  const VehicleTrajectory t = simulate(car, *m.driver, nullptr, {.duration = 60.0, .speed = 10.0}, silent);
  ASSERT_EQ(t.end, DriveEnd::kCompleted) << t.message();
  EXPECT_NEAR(t.u.back(), 18.0, 0.3);
  const std::vector<Metric> list = manoeuvre_metrics(t, m, p);
  const double expected =
      characteristics(LinearBicycle<double>{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, 15.0}).understeer_gradient;
  EXPECT_EQ(list[0].name, "understeer_gradient");
  EXPECT_NEAR(list[0].value, expected, 0.03 * expected);
}

TEST(DriverModel, RefusesOptionsThatMakeNoSense) {
  const auto path = std::make_shared<const Path>(Path::circle(60.0));
  const auto with = [&](PreviewDriverOptions options) { PreviewDriver(linearise(linear_car(), 15.0), path, options); };
  EXPECT_THROW(with({.preview_time = 0.0}), InputError);
  EXPECT_THROW(with({.delay = -0.1}), InputError);
  EXPECT_THROW(with({.max_steer = 2.0}), InputError);
  EXPECT_THROW(with({.max_steer_rate = std::nan("")}), InputError);
  EXPECT_THROW(with({.decision_interval = 2.0}), InputError);
}

// A point mass under the controller: a step of the desired speed is reached within its limits, and the integral takes
// up a steady resistance.
TEST(SpeedController, ReachesItsSpeedAndHoldsItAgainstDrag) {
  const SpeedControllerOptions options{.mass = 1000.0, .wheel_radius = 0.3};
  SpeedControlledDriver driver(reference_manoeuvre().driver, PiecewiseLinear(20.0), options);
  double u = 10.0, most = 0.0;
  for (int k = 0; k < 60000; ++k) {
    const double time = k * 1e-3;
    driver.look(time, {.u = u});
    const Controls c = driver.controls(time);
    EXPECT_TRUE(c.drive_torque == 0.0 || c.brake_torque == 0.0);
    const double drive = (c.drive_torque - c.brake_torque) / 0.3 / 1000.0;
    most = std::max(most, drive);
    u += 1e-3 * (drive - 0.4);  // a resistance of 0.4 m/s^2
    if (k == 14500) {
      EXPECT_NEAR(c.steer, 5.0 * std::numbers::pi / 180.0, 1e-12);
    }
  }
  EXPECT_NEAR(most, 3.0, 1e-9);
  EXPECT_NEAR(u, 20.0, 0.02);
}

}  // namespace
}  // namespace veridyn::vehicle
