#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "tests/vehicle/interrupting_progress.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

using testing::bumps;
using testing::car_with_bars;
using testing::drive;
using testing::hands_off;
using testing::linear_car;
using testing::reference_steer;
using testing::SignalDriver;
using testing::SignalRoad;
using testing::slalom;
using testing::with_longitudinal;

TEST(BicycleSimulation, DrivesTheReferenceManoeuvreToThePrintedDigits) {
  const VehicleParameters<double> p;
  const BicycleModel<double, LinearTyre<double>> model{
      p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, kGravity, BicycleGeometry::kSmallAngles};
  SignalDriver driver(reference_steer);
  Progress silent;
  const VehicleTrajectory out = simulate(model, driver, {}, silent);
  ASSERT_EQ(out.size(), 2001U);
  EXPECT_EQ(out.end, DriveEnd::kCompleted);
  EXPECT_NEAR(out.time[1000], 10.0, 1e-12);
  EXPECT_NEAR(out.r[1000] / kDegree, 34.9515, 5e-5);
  EXPECT_NEAR(out.v[1000], -0.01130, 5e-6);
  EXPECT_NEAR(out.Fy[kFrontRight][1000], 2982.31, 5e-3);
  EXPECT_NEAR(out.Fy[kRearLeft][1000], 3727.89, 5e-3);
  EXPECT_NEAR(out.slip_angle[kFrontLeft][1000] / kDegree, 2.84790, 5e-6);
  EXPECT_NEAR(out.slip_angle[kRearRight][1000] / kDegree, 1.77994, 5e-6);
  EXPECT_EQ(out.time.back(), 20.0);
  EXPECT_NEAR(out.yaw.back() / kDegree, 454.369, 5e-4);
  EXPECT_NEAR(out.x.back(), 77.274, 5e-4);
  EXPECT_NEAR(out.y.back(), 124.700, 5e-4);
  EXPECT_TRUE(out.roll.empty());
}

// Two programs, one car: a low and narrow four-wheel car is the bicycle, over the whole manoeuvre.
TEST(FourWheelSimulation, DrivesLikeTheBicycleInSecondOrderOfTrackAndHeight) {
  SignalDriver driver(reference_steer);
  Progress silent;
  const SimulationOptions options{.duration = 12.0, .step = 5e-4};
  const auto four = [&](double track, double height) {
    VehicleParameters<double> p;
    p.track_f = p.track_r = track;
    p.cg_height = height;
    p.K_sf = p.K_sr = p.K_tf = p.K_tr = p.K_bf = p.K_br = 200000.0;
    p.I_x = 590.0 * track * track;  // as the roll stiffness
    auto out = simulate(linear_car(p), driver, nullptr, options, silent);
    EXPECT_EQ(out.end, DriveEnd::kCompleted);
    return out.r;
  };
  const VehicleParameters<double> p;
  const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
  const std::vector<double> two = simulate(bicycle, driver, options, silent).r;
  const auto distance = [](const std::vector<double>& one, const std::vector<double>& other) {
    double worst = 0.0;
    for (std::size_t k = 0; k < one.size(); ++k) worst = std::max(worst, std::abs(one[k] - other[k]));
    return worst;
  };
  EXPECT_LT(distance(four(1e-3, 0.0), two), 1e-7);
  EXPECT_NEAR(distance(four(0.4, 0.0), two) / distance(four(0.2, 0.0), two), 4.0, 0.05);
  const std::vector<double> flat = four(0.4, 0.0);
  EXPECT_NEAR(distance(four(0.4, 0.01), flat) / distance(four(0.4, 0.005), flat), 4.0, 0.05);
}

TEST(FourWheelSimulation, MirrorsToTheLastBit) {
  const SignalRoad road(bumps);
  const SignalRoad mirrored_road([](const RoadPoint& at) {
    RoadPoint mirrored = at;
    mirrored.y = -at.y;
    mirrored.offset = -at.offset;
    return bumps(mirrored);
  });
  FourWheelOptions options;
  options.longitudinal.emplace();
  options.ackermann = 0.5;
  const auto car = linear_car(car_with_bars(), options);
  const auto left = [](double t) { return Controls{.steer = slalom(t).steer + 0.02, .drive_torque = 500.0}; };
  const auto right = [](double t) { return Controls{.steer = -slalom(t).steer - 0.02, .drive_torque = 500.0}; };
  const SimulationOptions run{.duration = 4.0};
  const auto a = drive(car, left, run, &road), b = drive(car, right, run, &mirrored_road);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(std::abs(a.y.back()), 1.0);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a.y[k], -b.y[k]);
    EXPECT_EQ(a.yaw[k], -b.yaw[k]);
    EXPECT_EQ(a.x[k], b.x[k]);
    EXPECT_EQ(a.heave[k], b.heave[k]);
    EXPECT_EQ(a.roll_rate[k], -b.roll_rate[k]);
    for (std::size_t i = 0; i < kWheels; ++i) {
      EXPECT_EQ(a.Fz[i][k], b.Fz[mirrored(i)][k]);
      EXPECT_EQ(a.Fy[i][k], -b.Fy[mirrored(i)][k]);
      EXPECT_EQ(a.wheel_speed[i][k], b.wheel_speed[mirrored(i)][k]);
    }
  }
}

// Tyres of a file pull to one side; in mirrored copies left and right the car does not.
TEST(FourWheelSimulation, MirrorsWithTheTyresOfAFile) {
  const TirFile tir = parse_tir(testing::small_tir(), "small.tir");
  const auto left = tir.on(TyreSide::kLeft), right = tir.on(TyreSide::kRight);
  using Car = FourWheelModel<double, MagicFormulaTyre<double>>;
  Progress silent;
  const auto run = [&](const Car& car, double sign) {
    SignalDriver driver([sign](double t) { return Controls{.steer = sign * slalom(t).steer, .drive_torque = 300.0}; });
    return simulate(car, driver, nullptr, {.duration = 3.0}, silent);
  };
  FourWheelOptions options;
  options.longitudinal.emplace();
  options.relaxation_length = 0.3;
  const Car even(car_with_bars(), {left, right, left, right}, options),
      uneven(car_with_bars(), {left, left, left, left}, options);
  const auto a = run(even, 1.0), b = run(even, -1.0), c = run(uneven, 1.0), d = run(uneven, -1.0);
  ASSERT_EQ(a.end, DriveEnd::kCompleted) << a.message();
  EXPECT_GT(std::abs(a.y.back()), 0.5);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a.y[k], -b.y[k]);
    EXPECT_EQ(a.Fy[0][k], -b.Fy[1][k]);
  }
  EXPECT_GT(std::abs(c.y.back() + d.y.back()), 1e-3);
}

/// The prototype's twin: lengths by `length`, masses by `mass`, time as it is: u scales as lengths, and so must g for
/// g L/u^2 to stay.
VehicleParameters<double> twin(const VehicleParameters<double>& p, double length, double mass) {
  VehicleParameters<double> out = p;
  for (double* m : {&out.mass, &out.unsprung_mass}) *m *= mass;
  for (double* l : {&out.a, &out.b, &out.track_f, &out.track_r, &out.cg_height}) *l *= length;
  for (double* I : {&out.I_x, &out.I_y, &out.I_z}) *I *= mass * length * length;
  for (double* C : {&out.C_f, &out.C_r}) *C *= mass * length;
  for (double* K : {&out.K_sf, &out.K_sr, &out.K_bf, &out.K_br, &out.K_tf, &out.K_tr, &out.C_sf, &out.C_sr}) *K *= mass;
  return out;
}

TEST(FourWheelSimulation, HasATwinAtOneFifthWithGravityScaled) {
  const VehicleParameters<double> p;
  const double length = 0.2, mass = 0.008;
  FourWheelOptions scaled;
  scaled.gravity = length * kGravity;
  const auto full = drive(linear_car(p), reference_steer, {});
  const auto model = drive(linear_car(twin(p, length, mass), scaled), reference_steer, {.speed = 4.0});
  ASSERT_EQ(full.size(), model.size());
  ASSERT_GT(*std::max_element(full.roll.begin(), full.roll.end()), 0.1);
  for (std::size_t k = 0; k < full.size(); ++k) {
    EXPECT_NEAR(model.yaw[k], full.yaw[k], 1e-9);
    EXPECT_NEAR(model.roll[k], full.roll[k], 1e-9);
    EXPECT_NEAR(model.x[k] / length, full.x[k], 1e-9 * 160.0);
    EXPECT_NEAR(model.heave[k] / length, full.heave[k], 1e-9);
    EXPECT_NEAR(model.Fz[0][k] / (mass * length), full.Fz[0][k], 1e-9 * 1e4);
  }
  // With the gravity of the Earth the same model behaves differently: its springs, soft as the mass is small, do not
  // hold the weight that is five times theirs, and it tips over in the first bend.
  const auto on_earth = drive(linear_car(twin(p, length, mass)), reference_steer, {.speed = 4.0});
  EXPECT_EQ(on_earth.end, DriveEnd::kRolledOver);
}

TEST(FourWheelSimulation, StopsWhenInterruptedAndKeepsWhatItHas) {
  testing::InterruptingProgress impatient(3);
  SignalDriver driver(hands_off);
  const auto out = simulate(linear_car(car_with_bars()), driver, nullptr, {}, impatient);
  EXPECT_EQ(out.end, DriveEnd::kInterrupted);
  EXPECT_EQ(impatient.questions(), 3);
  EXPECT_GT(out.size(), 100U);
  EXPECT_EQ(out.Fz[3].size(), out.size());
}

TEST(FourWheelSimulation, SamplesAtItsOutputStepAndAtTheEnd) {
  const auto out = drive(linear_car(car_with_bars()), hands_off, {.duration = 1.0005, .output_step = 0.25});
  ASSERT_EQ(out.size(), 6U);
  EXPECT_EQ(out.time[4], 1.0);
  EXPECT_EQ(out.time[5], 1.0005);
  EXPECT_NEAR(out.x[5], 20.0 * 1.0005, 1e-12);
}

TEST(FourWheelSimulation, ShowsTheDriverWhereItIsOnceAStep) {
  struct Passenger : Driver {
    std::vector<double> times, y;
    void look(double time, const PlanarMotion& motion) override {
      times.push_back(time);
      y.push_back(motion.y);
    }
    [[nodiscard]] Controls controls(double time) const override { return slalom(time); }
  };
  Progress silent;
  const SimulationOptions options{.duration = 0.5, .output_step = 1e-3};
  const VehicleParameters<double> p = car_with_bars();
  const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
  Passenger in_four, in_two;
  const auto four = simulate(linear_car(p), in_four, nullptr, options, silent);
  const auto two = simulate(bicycle, in_two, options, silent);
  EXPECT_EQ(in_four.times, four.time);
  EXPECT_EQ(in_four.y, four.y);
  EXPECT_EQ(in_two.times, two.time);
  EXPECT_EQ(in_two.y, two.y);
}

TEST(FourWheelSimulation, RecordsColumnsThatFitEachOther) {
  const SignalRoad road(bumps);
  FourWheelOptions options;
  options.longitudinal.emplace();
  const auto controls = [](double t) { return Controls{.steer = slalom(t).steer, .drive_torque = 400.0}; };
  const VehicleParameters<double> p = car_with_bars();
  const auto out = drive(linear_car(p, options), controls, {.duration = 1.0, .output_step = 1e-3}, &road);
  using Columns = std::vector<double>;
  const auto slope = [&](const Columns& x, std::size_t k) { return (x[k + 1] - x[k - 1]) / 2e-3; };
  const double ahead = 2.0 * p.unsprung_mass * (p.b - p.a) / (p.mass - 4.0 * p.unsprung_mass);
  for (std::size_t k = 200; k + 1 < out.size(); k += 50) {
    EXPECT_EQ(out.steer[k], slalom(out.time[k]).steer);
    EXPECT_NEAR(slope(out.yaw, k), out.r[k], 1e-4);
    EXPECT_NEAR(slope(out.r, k), out.yaw_acceleration[k], 1e-3);
    EXPECT_NEAR(slope(out.roll, k), out.roll_rate[k], 1e-4);
    EXPECT_NEAR(slope(out.pitch, k), out.pitch_rate[k], 1e-4);
    EXPECT_NEAR(slope(out.heave, k), out.heave_rate[k], 1e-4);
    EXPECT_NEAR(slope(out.v, k) + out.r[k] * out.u[k], out.lateral_acceleration[k], 1e-3);
    EXPECT_NEAR(slope(out.u, k) - out.r[k] * out.v[k], out.longitudinal_acceleration[k], 1e-3);
    for (std::size_t i = 0; i < kWheels; ++i) {
      const double x = (is_front(i) ? p.a : -p.b) - ahead, y = (is_left(i) ? 0.5 : -0.5) * p.track_f;
      const double corner = out.heave[k] + y * out.roll[k] - x * out.pitch[k] +
                            0.5 * p.cg_height * (out.roll[k] * out.roll[k] + out.pitch[k] * out.pitch[k]);
      EXPECT_NEAR(out.suspension_travel[i][k], out.wheel_height[i][k] - corner, 1e-14);
      const double pressed = static_loads(p, kGravity)[i] + p.K_tf * (out.road[i][k] - out.wheel_height[i][k]);
      EXPECT_NEAR(out.Fz[i][k], std::max(0.0, pressed), 1e-8);
      EXPECT_EQ(out.Fx[i][k], 100000.0 * out.slip_ratio[i][k]);
      EXPECT_EQ(out.Fy[i][k], (is_front(i) ? p.C_f : p.C_r) * out.slip_angle[i][k]);
    }
  }
}

TEST(FourWheelSimulation, MeasuresTheDistanceOnItsPath) {
  const SignalRoad slope([](const RoadPoint& at) { return 1e-6 * at.distance; });
  const auto out = drive(
      linear_car(car_with_bars()), [](double) { return Controls{.steer = 0.1}; },
      {.duration = 6.0, .output_step = 1e-3, .speed = 8.0}, &slope);
  double length = 0.0;
  for (std::size_t k = 1; k < out.size(); ++k) length += std::hypot(out.x[k] - out.x[k - 1], out.y[k] - out.y[k - 1]);
  EXPECT_GT(std::abs(out.v.back()), 0.2);
  EXPECT_NEAR(1e6 * out.road[kFrontRight].back(), length + 1.25, 1e-3);
  EXPECT_NEAR(1e6 * out.road[kRearLeft].back(), length - 1.00, 1e-3);
}

struct BadInput {
  const char* message;
  std::function<void()> run;
};

TEST(FourWheelSimulation, NamesBadInput) {
  const double nan = kNaN;
  const auto options = [](const SimulationOptions& o) {
    return [o] { (void)drive(linear_car(car_with_bars()), hands_off, o); };
  };
  const auto controls = [](const Controls& c, bool torques = false) {
    return [=] {
      (void)drive(linear_car(car_with_bars(), torques ? with_longitudinal({}) : FourWheelOptions{}),
                  [=](double t) { return t < 1.0 ? Controls{} : c; }, {.duration = 2.0});
    };
  };
  const auto parameters = [](double VehicleParameters<double>::*field, double value) {
    return [=] {
      VehicleParameters<double> p = car_with_bars();
      p.*field = value;
      (void)drive(linear_car(p), hands_off, {});
    };
  };
  const BadInput inputs[] = {
      {"drive: speed is 0 m/s; must be > 0", options({.speed = 0.0})},
      {"drive: speed is -3 m/s; must be > 0", options({.speed = -3.0})},
      {"drive: speed is nan m/s; must be > 0", options({.speed = nan})},
      {"drive: duration is nan s; must be > 0", options({.duration = nan})},
      {"drive: step is -0.001 s; must be > 0", options({.step = -1e-3})},
      {"drive: step is 30 s; must not be longer than the duration of 20 s", options({.step = 30.0})},
      {"drive: step is 1e-12 s; 20 s would take more than 1e9 steps", options({.step = 1e-12})},
      {"drive: output_step is 0.0015 s; must be a multiple of the step of 0.001 s", options({.output_step = 1.5e-3})},
      {"drive: output_step is nan s; must be a multiple of the step of 0.001 s", options({.output_step = nan})},
      {"drive: step is 0.05 s; this vehicle's fastest motion (", options({.step = 0.05, .output_step = 0.1})},
      {"drive: steer is 95 deg at 1.000 s; must be within -90 and 90 deg", controls({.steer = 95.0 * kDegree})},
      {"drive: steer is -90 deg at 1.000 s; must be within -90 and 90 deg", controls({.steer = -90.0 * kDegree})},
      {"drive: steer is nan deg at 1.000 s; must be within -90 and 90 deg", controls({.steer = nan})},
      {"drive: brake_torque is -1 N m at 1.000 s; must be >= 0", controls({.brake_torque = -1.0}, true)},
      {"drive: drive_torque is nan N m at 1.000 s; must be finite", controls({.drive_torque = nan}, true)},
      {"vehicle: track_f is 0 m; must be > 0", parameters(&VehicleParameters<double>::track_f, 0.0)},
      {"vehicle: K_tr is -1 N/m; must be > 0", parameters(&VehicleParameters<double>::K_tr, -1.0)},
  };
  for (const BadInput& input : inputs) {
    try {
      input.run();
      ADD_FAILURE() << "accepted: " << input.message;
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).rfind(input.message, 0), 0U) << e.what() << "\n  expected " << input.message;
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
