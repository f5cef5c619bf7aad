#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation_loop.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

using testing::linear_car;
using testing::LinearCar;

struct SignalDriver : Driver {
  std::function<Controls(double)> signal;
  explicit SignalDriver(std::function<Controls(double)> s) : signal(std::move(s)) {}
  [[nodiscard]] Controls controls(double time) const override { return signal(time); }
};

Controls reference_manoeuvre(double t) {
  return {.steer = 5.0 * kDegree * std::min(std::clamp(t - 2.0, 0.0, 1.0), std::clamp(16.0 - t, 0.0, 1.0))};
}

struct SignalRoad : Road {
  std::function<double(const RoadPoint&)> signal;
  explicit SignalRoad(std::function<double(const RoadPoint&)> s) : signal(std::move(s)) {}
  [[nodiscard]] double height(const RoadPoint& point) const override { return signal(point); }
};

/// With anti-roll bars.
VehicleParameters<double> road_car() {
  VehicleParameters<double> p = testing::road_car();
  p.K_bf = 9000.0;
  p.K_br = 4000.0;
  return p;
}

VehicleTrajectory drive(const LinearCar<double>& car, const std::function<Controls(double)>& controls,
                        const SimulationOptions& options, const Road* road = nullptr) {
  SignalDriver driver(controls);
  Progress nobody;
  return simulate(car, driver, road, options, nobody);
}
Controls hands_off(double /*time*/) { return {}; }

TEST(BicycleSimulation, DrivesTheReferenceManoeuvreToThePrintedDigits) {
  const VehicleParameters<double> p;
  const BicycleModel<double, LinearTyre<double>> model{
      p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, kGravity, BicycleGeometry::kSmallAngles};
  SignalDriver driver(reference_manoeuvre);
  Progress nobody;
  const VehicleTrajectory out = simulate(model, driver, {}, nobody);
  ASSERT_EQ(out.size(), 2001U);
  EXPECT_EQ(out.end, SimulationEnd::kCompleted);
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
  SignalDriver driver(reference_manoeuvre);
  Progress nobody;
  const SimulationOptions options{.duration = 12.0, .step = 5e-4};
  const auto four = [&](double track, double height) {
    VehicleParameters<double> p;
    p.track_f = p.track_r = track;
    p.cg_height = height;
    p.K_sf = p.K_sr = p.K_tf = p.K_tr = p.K_bf = p.K_br = 200000.0;
    p.I_x = 590.0 * track * track;  // as the roll stiffness
    auto out = simulate(linear_car(p), driver, nullptr, options, nobody);
    EXPECT_EQ(out.end, SimulationEnd::kCompleted);
    return out.r;
  };
  const VehicleParameters<double> p;
  const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
  const std::vector<double> two = simulate(bicycle, driver, options, nobody).r;
  const auto apart = [](const std::vector<double>& one, const std::vector<double>& other) {
    double worst = 0.0;
    for (std::size_t k = 0; k < one.size(); ++k) worst = std::max(worst, std::abs(one[k] - other[k]));
    return worst;
  };
  EXPECT_LT(apart(four(1e-3, 0.0), two), 1e-7);
  EXPECT_NEAR(apart(four(0.4, 0.0), two) / apart(four(0.2, 0.0), two), 4.0, 0.05);
  const std::vector<double> flat = four(0.4, 0.0);
  EXPECT_NEAR(apart(four(0.4, 0.01), flat) / apart(four(0.4, 0.005), flat), 4.0, 0.05);
}

/// A violent but smooth drive over a smooth bumpy road, no wheel off the ground.
Controls slalom(double t) { return {.steer = 0.05 * std::sin(4.0 * t)}; }
double bumps(const RoadPoint& at) { return 0.015 * std::sin(0.7 * at.x) * std::cos(0.5 * at.y); }

TEST(FourWheelSimulation, ConvergesInFourthOrderOfTheStep) {
  const SignalRoad road(bumps);
  const auto car = linear_car(road_car());
  const auto run = [&](double step) {
    return drive(car, slalom, {.duration = 2.0, .step = step, .output_step = 2.0}, &road);
  };
  const auto exact = run(1.25e-4);
  ASSERT_TRUE(exact.lift_offs.empty()) << exact.message();
  const auto error = [&](const VehicleTrajectory& at) {
    double sum = 0.0;
    for (const auto column :
         {&VehicleTrajectory::r, &VehicleTrajectory::roll, &VehicleTrajectory::y, &VehicleTrajectory::heave_rate}) {
      sum = std::hypot(sum, (at.*column).back() - (exact.*column).back());
    }
    return sum;
  };
  const double coarse = error(run(4e-3)), fine = error(run(2e-3)), finer = error(run(1e-3));
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.25);
  EXPECT_NEAR(std::log2(fine / finer), 4.0, 0.25);
}

TEST(FourWheelSimulation, MirrorsToTheLastBit) {
  const SignalRoad road(bumps);
  const SignalRoad mirrored_road([](const RoadPoint& at) {
    RoadPoint seen = at;
    seen.y = -at.y;
    seen.offset = -at.offset;
    return bumps(seen);
  });
  FourWheelOptions options;
  options.longitudinal.emplace();
  options.ackermann = 0.5;
  const auto car = linear_car(road_car(), options);
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
  Progress nobody;
  const auto run = [&](const Car& car, double sign) {
    SignalDriver driver([sign](double t) { return Controls{.steer = sign * slalom(t).steer, .drive_torque = 300.0}; });
    return simulate(car, driver, nullptr, {.duration = 3.0}, nobody);
  };
  FourWheelOptions options;
  options.longitudinal.emplace();
  options.relaxation_length = 0.3;
  const Car even(road_car(), {left, right, left, right}, options),
      uneven(road_car(), {left, left, left, left}, options);
  const auto a = run(even, 1.0), b = run(even, -1.0), c = run(uneven, 1.0), d = run(uneven, -1.0);
  ASSERT_EQ(a.end, SimulationEnd::kCompleted) << a.message();
  EXPECT_GT(std::abs(a.y.back()), 0.5);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a.y[k], -b.y[k]);
    EXPECT_EQ(a.Fy[0][k], -b.Fy[1][k]);
  }
  EXPECT_GT(std::abs(c.y.back() + d.y.back()), 1e-3);
}

// In a steady turn the body leans by c sum F_y over the roll stiffness less gravity's tilting moment: tyre, spring and
// bar in series (Milliken & Milliken 1995, chapter 16).
TEST(FourWheelSimulation, LeansAsRollStiffnessLessGravitySays) {
  const VehicleParameters<double> p = road_car();
  const auto axle = [](double spring, double bar, double tyre, double track) {
    const double at_wheel = spring + 2.0 * bar;
    return 0.5 * track * track * at_wheel * tyre / (at_wheel + tyre);
  };
  const double stiffness = axle(p.K_sf, p.K_bf, p.K_tf, p.track_f) + axle(p.K_sr, p.K_br, p.K_tr, p.track_r);
  const double tilting = (p.mass - 4.0 * p.unsprung_mass) * kGravity * p.cg_height;
  EXPECT_GT(tilting / stiffness, 0.04);  // what the test would miss without it
  const auto lean = [&](double steer) {
    const auto out = drive(linear_car(p), [steer](double) { return Controls{.steer = steer}; }, {.duration = 15.0});
    EXPECT_NEAR(out.roll_rate.back(), 0.0, 1e-9);
    const double wanted = p.mass * out.lateral_acceleration.back() * p.cg_height / (stiffness - tilting);
    return out.roll.back() / wanted - 1.0;
  };
  EXPECT_NEAR(lean(0.005), 0.0, 1e-9);
  EXPECT_NEAR(lean(0.03), 0.0, 1e-9);
}

TEST(FourWheelSimulation, FallsIntoAHoleAndLandsAgain) {
  const SignalRoad hole([](const RoadPoint& at) {
    const bool in = at.offset > 0.0 && at.distance > 20.0 && at.distance < 26.0;
    return in ? -0.3 : 0.0;
  });
  const auto out = drive(linear_car(road_car()), hands_off, {.duration = 6.0, .output_step = 1e-3}, &hole);
  EXPECT_EQ(out.end, SimulationEnd::kCompleted);
  ASSERT_FALSE(out.lift_offs.empty());
  // Front left over the edge after (20 - a)/u, rear left b behind.
  const auto first = [&](std::size_t wheel) {
    for (const LiftOff& l : out.lift_offs) {
      if (l.wheel == wheel) return l;
    }
    return LiftOff{};
  };
  EXPECT_NEAR(first(kFrontLeft).from, (20.0 - 1.25) / 20.0, 2e-3);
  EXPECT_NEAR(first(kRearLeft).from, (20.0 + 1.00) / 20.0, 2e-3);
  EXPECT_GT(first(kFrontLeft).to - first(kFrontLeft).from, 0.02);
  EXPECT_NE(out.message().find("wheel fl off the ground from 0.938 to "), std::string::npos) << out.message();
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      bool off = false;
      for (const LiftOff& l : out.lift_offs) {
        off |= l.wheel == i && out.time[k] > l.from - 1e-9 && out.time[k] < l.to - 1e-9;
      }
      EXPECT_EQ(off, out.Fz[i][k] == 0.0) << i << " at " << out.time[k];
      EXPECT_GE(out.Fz[i][k], 0.0);
    }
  }
  // It comes to rest as it was; while one wheel is off the others carry the car.
  for (std::size_t i = 0; i < kWheels; ++i) {
    EXPECT_NEAR(out.Fz[i].back(), linear_car(road_car()).rest_loads()[signed_index(i)], 0.5);
    EXPECT_NEAR(out.wheel_height[i].back(), 0.0, 1e-5);
  }
}

/// A car on springs so stiff that it tips as a block: the inner wheels lift when a_y > g W/(2 c).
TEST(FourWheelSimulation, LiftsItsInnerWheelsAtHalfTheTrackOverTheHeight) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_f = p.C_r = p.mass * 100.0 / (4.0 * p.b);  // v = 0 in every steady turn at 10 m/s: no pitching
  p.cg_height = 0.9;
  p.unsprung_mass = 5.0;  // tyres and wheels alone carry springs' force to the road
  p.K_sf = p.K_sr = p.K_tf = p.K_tr = 1e7;
  p.C_sf = p.C_sr = 3e4;
  const double threshold = p.track_f / (2.0 * p.cg_height);  // g
  const auto run = [&](double share) {
    // Neutral steer: r = u delta/L.
    const double u = 10.0, a_y = share * threshold * kGravity, steer = a_y * 2.4 / (u * u);
    const auto controls = [steer](double t) {
      const double part = std::clamp(t / 4.0, 0.0, 1.0);
      return Controls{.steer = steer * part * part * (3.0 - 2.0 * part)};
    };
    FourWheelOptions options;
    options.geometry = BicycleGeometry::kSmallAngles;
    return drive(linear_car(p, options), controls, {.duration = 6.0, .step = 1e-4, .speed = u});
  };
  const auto below = run(0.97);
  EXPECT_EQ(below.end, SimulationEnd::kCompleted) << below.message();
  EXPECT_TRUE(below.lift_offs.empty()) << below.message();
  EXPECT_NEAR(below.lateral_acceleration.back() / kGravity / threshold, 0.97, 0.01);
  const auto above = run(1.03);
  EXPECT_EQ(above.end, SimulationEnd::kRolledOver) << above.message();
  ASSERT_GE(above.lift_offs.size(), 2U);
  for (const LiftOff& l : above.lift_offs) EXPECT_TRUE(is_left(l.wheel));
  EXPECT_NE(above.message().find("the vehicle rolls or pitches beyond 45 deg"), std::string::npos);
}

TEST(FourWheelSimulation, LiftsTwoWheelsInAHardTurnAndSetsThemDownAgain) {
  VehicleParameters<double> p = road_car();
  p.cg_height = 0.75;
  p.I_x = 400.0;
  const auto controls = [](double t) { return Controls{.steer = t > 1.0 && t < 1.5 ? 0.065 : 0.0}; };
  const auto out = drive(linear_car(p), controls, {.duration = 6.0, .output_step = 1e-3});
  EXPECT_EQ(out.end, SimulationEnd::kCompleted) << out.message();
  bool two = false;
  for (std::size_t k = 0; k < out.size(); ++k) {
    two |= out.Fz[kFrontLeft][k] == 0.0 && out.Fz[kRearLeft][k] == 0.0;
  }
  EXPECT_TRUE(two) << out.message();
  EXPECT_GT(out.Fz[kFrontLeft].back(), 1000.0);
  EXPECT_NEAR(out.roll.back(), 0.0, 1e-3);
}

FourWheelOptions with(const LongitudinalParameters& longitudinal) {
  FourWheelOptions options;
  options.longitudinal = longitudinal;
  return options;
}

/// By which the weight of a body that leans or pitches by 1 rad pushes [N].
double tilting(const VehicleParameters<double>& p) { return (p.mass - 4.0 * p.unsprung_mass) * kGravity; }

TEST(FourWheelSimulation, StopsInTheDistanceThatFrictionLeaves) {
  VehicleParameters<double> p = road_car();
  p.mu = 0.8;
  p.cg_height = 0.0;  // no pitch: the loads stay
  const auto car = linear_car(p, with({.drag_area = 0.0, .rolling_resistance = 0.0}));
  const auto out =
      drive(car, [](double) { return Controls{.brake_torque = 20000.0}; }, {.duration = 10.0, .speed = 25.0});
  ASSERT_EQ(out.end, SimulationEnd::kStopped) << out.message();
  const double left = out.u.back();  // at or just below 0.5 m/s
  EXPECT_LE(left, 0.5);
  // The wheels take some hundredths of a second to lock: until then they brake less.
  EXPECT_NEAR(out.x.back(), (25.0 * 25.0 - left * left) / (2.0 * 0.8 * kGravity), 0.1);
  for (std::size_t i = 0; i < kWheels; ++i) {
    EXPECT_EQ(out.wheel_speed[i].back(), 0.0);
    EXPECT_NEAR(out.slip_ratio[i][out.size() - 2], -1.0, 1e-12);
    for (const double spin : out.wheel_speed[i]) EXPECT_GE(spin, 0.0);
  }
}

TEST(FourWheelSimulation, BrakesWithMoreLoadInFrontByHeightOverWheelbase) {
  VehicleParameters<double> p = road_car();
  const auto car = linear_car(p, with({.drag_area = 0.0, .rolling_resistance = 0.0}));
  const auto out = drive(car, [](double t) { return Controls{.brake_torque = 1000.0 * std::min(1.0, t)}; },
                         {.duration = 4.0, .speed = 40.0});
  ASSERT_EQ(out.end, SimulationEnd::kCompleted);
  const double a_x = out.longitudinal_acceleration.back();
  // The spinning wheels are slowed too: m a R = -T + 4 I_w a/R, but for the slip.
  EXPECT_NEAR(a_x * (p.mass * 0.3 + 4.0 * 1.0 / 0.3), -1000.0, 3.0);
  const double moved = 0.5 * (out.Fz[0].back() + out.Fz[1].back() - out.Fz[2].back() - out.Fz[3].back()) -
                       0.5 * p.mass * kGravity * (p.b - p.a) / (p.a + p.b);
  EXPECT_NEAR(moved, (-p.mass * a_x + tilting(p) * out.pitch.back()) * p.cg_height / (p.a + p.b), 1e-3 * moved);
  EXPECT_GT(out.pitch.back(), 0.0);
}

// Drag and rolling resistance alone: (m + 4 I_w/R^2) u' = -(A + B u^2), u = sqrt(A/B) tan(phi_0 - sqrt(A B) t/m_eff).
TEST(FourWheelSimulation, CoastsDownAsTheClosedFormSays) {
  VehicleParameters<double> p = road_car();
  const LongitudinalParameters l{.wheel_inertia = 0.8, .rolling_resistance = 0.015};
  LinearTyre<double> stiff{.stiffness = 60000.0, .slip_stiffness = 3e6};  // hardly slips
  const LinearCar<double> car(p, {stiff, stiff, stiff, stiff}, with(l));
  const auto out = drive(car, hands_off, {.duration = 30.0, .speed = 40.0});
  ASSERT_EQ(out.end, SimulationEnd::kCompleted);
  const double A = l.rolling_resistance * p.mass * kGravity, B = 0.5 * l.air_density * l.drag_area;
  const double mass = p.mass + 4.0 * l.wheel_inertia / (l.wheel_radius * l.wheel_radius);
  const double phase = std::atan(40.0 * std::sqrt(B / A)) - std::sqrt(A * B) / mass * 30.0;
  EXPECT_NEAR(out.u.back(), std::sqrt(A / B) * std::tan(phase), 2e-3);
  EXPECT_LT(out.u.back(), 31.0);
}

TEST(FourWheelSimulation, ClimbsAGradeAtTheTorqueThatItTakes) {
  const VehicleParameters<double> p = road_car();
  const LongitudinalParameters l{.drag_area = 0.0, .rolling_resistance = 0.0, .grade = 0.08};
  const double torque = p.mass * kGravity * std::sin(l.grade) * l.wheel_radius;
  const auto out =
      drive(linear_car(p, with(l)), [&](double) { return Controls{.drive_torque = torque}; }, {.duration = 10.0});
  EXPECT_NEAR(out.longitudinal_acceleration.back(), 0.0, 1e-6);
  EXPECT_NEAR(out.u.back(), 20.0, 0.1);
  double load = 0.0;
  for (const auto& column : out.Fz) load += column.back();
  EXPECT_NEAR(load, p.mass * kGravity * std::cos(l.grade), 1e-6);
  // The tyres push at the road: weight moves to the rear as when accelerating.
  const double moved = 0.5 * (out.Fz[2].back() + out.Fz[3].back() - out.Fz[0].back() - out.Fz[1].back()) -
                       0.5 * p.mass * kGravity * std::cos(l.grade) * (p.a - p.b) / (p.a + p.b);
  EXPECT_LT(out.pitch.back(), 0.0);
  EXPECT_NEAR(moved,
              (torque / l.wheel_radius - std::cos(l.grade) * tilting(p) * out.pitch.back()) * p.cg_height / (p.a + p.b),
              1e-4 * moved);
}

// Fast wheels are followed at the step in fourth order. Slow ones, which relax in less than a step (here in 0.2 ms),
// need parts of it, and are followed better than that.
TEST(FourWheelSimulation, FollowsTheWheelsSpinAtAnySpeed) {
  const auto car = linear_car(road_car(), with({}));
  const auto error = [&](double speed, double step) {
    const auto controls = [](double t) { return Controls{.steer = 0.02 * std::sin(t), .drive_torque = 600.0 * t}; };
    const auto run = [&](double h) {
      const auto out = drive(car, controls, {.duration = 1.2, .step = h, .output_step = 1.2, .speed = speed});
      EXPECT_EQ(out.end, SimulationEnd::kCompleted);
      return out;
    };
    const auto one = run(step), exact = run(6.25e-5);
    return std::hypot(one.u.back() - exact.u.back(), one.wheel_speed[2].back() - exact.wheel_speed[2].back());
  };
  const double coarse = error(30.0, 2e-3), fine = error(30.0, 1e-3), finer = error(30.0, 5e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3);
  EXPECT_NEAR(std::log2(fine / finer), 4.0, 0.3);
  EXPECT_LT(error(2.0, 1e-3), 1e-8);
  EXPECT_LT(error(2.0, 4e-3), 1e-6);
}

TEST(FourWheelSimulation, EndsWhereTheVehicleStopsOrSpins) {
  const auto coasting = drive(linear_car(road_car(), with({})), [](double) { return Controls{.brake_torque = 200.0}; },
                              {.duration = 60.0, .speed = 2.0});
  EXPECT_EQ(coasting.end, SimulationEnd::kStopped);
  EXPECT_LT(coasting.end_time, 60.0);
  EXPECT_EQ(coasting.time.back(), coasting.end_time);
  EXPECT_NE(coasting.message().find("came to a stop"), std::string::npos);
  VehicleParameters<double> loose = road_car();
  loose.mu = 0.5;
  loose.C_r = 30000.0;
  const auto spinning =
      drive(linear_car(loose, with({})),
            [](double t) { return Controls{.steer = 0.1 * std::min(1.0, t), .drive_torque = 2000.0}; },
            {.duration = 60.0, .speed = 30.0});
  EXPECT_EQ(spinning.end, SimulationEnd::kSpun) << spinning.message();
  EXPECT_TRUE(spinning.usable());
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
  const auto full = drive(linear_car(p), reference_manoeuvre, {});
  const auto model = drive(linear_car(twin(p, length, mass), scaled), reference_manoeuvre, {.speed = 4.0});
  ASSERT_EQ(full.size(), model.size());
  ASSERT_GT(*std::max_element(full.roll.begin(), full.roll.end()), 0.1);
  for (std::size_t k = 0; k < full.size(); ++k) {
    EXPECT_NEAR(model.yaw[k], full.yaw[k], 1e-9);
    EXPECT_NEAR(model.roll[k], full.roll[k], 1e-9);
    EXPECT_NEAR(model.x[k] / length, full.x[k], 1e-9 * 160.0);
    EXPECT_NEAR(model.heave[k] / length, full.heave[k], 1e-9);
    EXPECT_NEAR(model.Fz[0][k] / (mass * length), full.Fz[0][k], 1e-9 * 1e4);
  }
  // With the gravity of the Earth the same model behaves differently: it is not tilted as much, never lifts.
  const auto on_earth = drive(linear_car(twin(p, length, mass)), reference_manoeuvre, {.speed = 4.0});
  EXPECT_GT(std::abs(on_earth.roll[1000] - full.roll[1000]), 0.01);
}

// One Jet through the whole drive against runs with changed parameters.
TEST(FourWheelSimulation, CarriesDerivativesThroughTheWholeDrive) {
  using Jet = ceres::Jet<double, 4>;
  constexpr std::size_t kParameters[] = {0, 6, 10, 12};  // mass, height, C_f, K_sf
  const VehicleParameters<double> p = road_car();
  VehicleParameters<Jet> moving = p.cast<Jet>();
  for (Eigen::Index j = 0; j < 4; ++j) field_of(moving, kParameters[j]).v(j) = 1.0;
  const LinearCar<Jet> car = linear_car(moving);
  FourWheelState<Jet> state = car.steady_start(Jet(20.0));
  const auto flat = [](const FourWheelState<Jet>&) { return PerWheel<double>{}; };
  const auto at = [&](double t) { return car.wheel_controls(slalom(t)); };
  for (int k = 0; k < 2000; ++k) {
    const double t = k * 1e-3;
    const std::array<WheelControls<Jet>, 3> controls{at(t), at(t + 5e-4), at(t + 1e-3)};
    FourWheelRates<Jet> rates;
    car.rates(state, controls[0], {}, rates);
    four_wheel_step(car, flat, controls, 1e-3, rates, state);
  }
  const SimulationOptions options{.duration = 2.0};
  const auto run = drive(linear_car(p), slalom, options);
  EXPECT_NEAR(state(kYaw).a, run.yaw.back(), 1e-12);
  EXPECT_NEAR(state(kRoll).a, run.roll.back(), 1e-12);
  for (Eigen::Index j = 0; j < 4; ++j) {
    VehicleParameters<double> more = p, less = p;
    const double step = 1e-4 * field_of(p, kParameters[j]);
    field_of(more, kParameters[j]) += step;
    field_of(less, kParameters[j]) -= step;
    const auto up = drive(linear_car(more), slalom, options), down = drive(linear_car(less), slalom, options);
    const auto slope = [&](const std::vector<double> VehicleTrajectory::*column) {
      return ((up.*column).back() - (down.*column).back()) / (2.0 * step);
    };
    const double y = slope(&VehicleTrajectory::y), roll = slope(&VehicleTrajectory::roll);
    EXPECT_NEAR(state(kY).v(j), y, 1e-5 * std::abs(y)) << kVehicleFields[kParameters[j]].name;
    EXPECT_NEAR(state(kRoll).v(j), roll, 1e-5 * std::abs(roll)) << kVehicleFields[kParameters[j]].name;
  }
}

TEST(FourWheelSimulation, StopsWhenAskedAndKeepsWhatItHas) {
  struct Impatient : Progress {
    int calls = 0;
    [[nodiscard]] bool update(double) override { return ++calls < 3; }
  } impatient;
  SignalDriver driver(hands_off);
  const auto out = simulate(linear_car(road_car()), driver, nullptr, {}, impatient);
  EXPECT_EQ(out.end, SimulationEnd::kInterrupted);
  EXPECT_EQ(impatient.calls, 3);
  EXPECT_GT(out.size(), 100U);
  EXPECT_EQ(out.Fz[3].size(), out.size());
}

TEST(FourWheelSimulation, SamplesAtItsOutputStepAndAtTheEnd) {
  const auto out = drive(linear_car(road_car()), hands_off, {.duration = 1.0005, .output_step = 0.25});
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
  Progress nobody;
  const SimulationOptions options{.duration = 0.5, .output_step = 1e-3};
  const VehicleParameters<double> p = road_car();
  const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
  Passenger in_four, in_two;
  const auto four = simulate(linear_car(p), in_four, nullptr, options, nobody);
  const auto two = simulate(bicycle, in_two, options, nobody);
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
  const VehicleParameters<double> p = road_car();
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
      linear_car(road_car()), [](double) { return Controls{.steer = 0.1}; },
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
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto options = [](const SimulationOptions& o) {
    return [o] { (void)drive(linear_car(road_car()), hands_off, o); };
  };
  const auto controls = [](const Controls& c, bool torques = false) {
    return [=] {
      (void)drive(linear_car(road_car(), torques ? with({}) : FourWheelOptions{}),
                  [=](double t) { return t < 1.0 ? Controls{} : c; }, {.duration = 2.0});
    };
  };
  const auto parameters = [](double VehicleParameters<double>::*field, double value) {
    return [=] {
      VehicleParameters<double> p = road_car();
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
      EXPECT_EQ(std::string(e.what()).rfind(input.message, 0), 0U) << e.what() << "\n  wanted " << input.message;
    }
  }
}

TEST(FourWheelSimulation, TakesStepsUpToWhatItSaysAndNotBeyond) {
  const auto car = linear_car(road_car());
  const double fastest = internal::fastest_rates(car, 20.0).all;
  // Stable at the limit, beyond it the simulation diverges: shown with the step function itself.
  const auto spread = [&](double factor) {
    const double h = factor * 2.5 / fastest;
    FourWheelState<double> state = car.steady_start(20.0);
    state(kWheelHeightRate) = 0.01;
    const auto straight = car.wheel_controls(0.0);
    const auto flat = [](const FourWheelState<double>&) { return PerWheel<double>{}; };
    FourWheelRates<double> rates;
    for (int k = 0; k < 500; ++k) {
      car.rates(state, straight, {}, rates);
      four_wheel_step(car, flat, {straight, straight, straight}, h, rates, state);
    }
    return state.segment<4>(kWheelHeight).norm();
  };
  EXPECT_LT(spread(1.0), 1e-6);
  EXPECT_GT(spread(1.25), 1e-3);
}

}  // namespace
}  // namespace veridyn::vehicle
