#include "veridyn/aircraft/simulation/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

SimulationOptions calm(std::string_view name, double duration) {
  SimulationOptions o;
  o.subject = builtin_subject(name);
  o.duration = duration;
  return o;
}

SimulatedFlight fly(const SimulationOptions& o) {
  Progress silent;
  return simulate(o, silent);
}

TEST(Simulation, FliesTheReferenceFlightWithinTheLinearRangeOfTheWing) {
  const SimulatedFlight calm_flight = fly(calm("unatrap", 300));
  ASSERT_TRUE(calm_flight.usable()) << calm_flight.message();
  EXPECT_GT(calm_flight.alpha_min, -5 * kDegree);
  EXPECT_LT(calm_flight.alpha_max, 15 * kDegree);

  SimulationOptions rough = calm("unatrap", 300);
  rough.turbulence = dryden_settings("low_moderate", "test");
  rough.wind.mean = {3, -2, 0};
  const SimulatedFlight flight = fly(rough);
  ASSERT_TRUE(flight.usable()) << flight.message();
  // Gusts of 1.4 m/s at 20 m/s move alpha by 4 deg (one sigma): the share beyond the range is their peaks.
  const Channel& alpha = flight.truth.at("alpha");
  std::size_t outside = 0;
  for (const double a : alpha.value) outside += a < -5 * kDegree || a > 15 * kDegree ? 1 : 0;
  EXPECT_LT(static_cast<double>(outside) / static_cast<double>(alpha.size()), 0.02);
  for (const double down : flight.truth.at("pos_down").value) EXPECT_NEAR(down, -100.0, 40.0);
}

TEST(Simulation, ChangesTheAircraftAtTheStatedTime) {
  const Study study = Study::parse(
      "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 20\n[[flight.change]]\ntime = 8\n"
      "parameters = { Cm_alpha = -0.3, CL_alpha = 3.0 }\n",
      "study.toml");
  const SimulationOptions o = read_simulation(study.root());
  ASSERT_EQ(o.changes.size(), 1u);
  const SimulatedFlight flight = fly(o);
  ASSERT_TRUE(flight.usable());
  const auto at = [&](const char* name, std::size_t k) { return flight.truth.at(name).value[k]; };
  for (std::size_t k = 0; k < flight.truth.at("CL").size(); k += 50) {
    const double t = flight.truth.at("CL").times()[k];
    AeroVariables<double> v;
    v.alpha = at("alpha", k), v.beta = at("beta", k), v.Va = at("airspeed", k);
    v.q_n = 0.5 * o.subject.chord * at("gyro_y", k) / v.Va;
    v.de = at("elevator", k);
    const AeroModel& model = t < 8.0 - 1e-9 ? o.subject.model : o.changes[0].model;
    EXPECT_NEAR(at("CL", k), model.evaluate(v).CL, 1e-12) << t;
  }
  EXPECT_THAT(flight.truth.events.back().text, HasSubstr("Cm_alpha"));
}

TEST(Simulation, MovesTheAccelerometerAlongItsLeverArm) {
  SimulationOptions o = calm("unatrap", 60);
  o.subject.imu_position = {0.4, -0.1, 0.2};
  const SimulatedFlight flight = fly(o);
  ASSERT_TRUE(flight.usable()) << flight.message();
  const Eigen::Vector3d arm(0.4, -0.1, 0.2);
  const auto at = [&](const char* name, std::size_t i) {
    const auto value = [&](const char* axis) { return flight.truth.at(std::string(name) + axis).value[i]; };
    return Eigen::Vector3d(value("_x"), value("_y"), value("_z"));
  };
  double largest = 0.0;
  for (std::size_t i = 0; i < flight.truth.at("gyro_x").size(); i += 7) {
    const Eigen::Vector3d w = at("gyro", i), dw = at("gyro_rate", i);
    const Eigen::Vector3d difference = at("imu_accel", i) - at("accel", i);
    EXPECT_LT((difference - dw.cross(arm) - w.cross(w.cross(arm))).norm(), 1e-9);
    largest = std::max(largest, difference.norm());
  }
  EXPECT_GT(largest, 0.1);
}

TEST(Simulation, FliesEveryBuiltInAircraft) {
  for (const std::string& name : builtin_subject_names()) {
    SimulationOptions o = calm(name, 150);
    if (name == "skywalker_2013") o.airspeed = 15;
    const SimulatedFlight flight = fly(o);
    EXPECT_TRUE(flight.usable()) << name << ": " << flight.message();
    EXPECT_GT(flight.alpha_min, -12 * kDegree) << name;
    EXPECT_LT(flight.alpha_max, 16 * kDegree) << name;
  }
}

void expect_newton_and_wind_triangle(const DrydenSettings& turbulence, double tolerance) {
  SimulationOptions o = calm("skywalker_2013", 30);
  o.airspeed = 15;
  o.turbulence = turbulence;
  o.wind.mean = {4, 1, 0.2};
  o.truth_rate = 400;
  const SimulatedFlight f = fly(o);
  ASSERT_TRUE(f.usable()) << f.message();
  const auto v = [&](std::string_view name, std::size_t i) { return f.truth.at(name).value[i]; };
  const auto vector = [&](std::string prefix, std::array<const char*, 3> axes, std::size_t i) {
    return Eigen::Vector3d(v(prefix + axes[0], i), v(prefix + axes[1], i), v(prefix + axes[2], i));
  };
  constexpr std::array<const char*, 3> kNed = {"north", "east", "down"}, kXyz = {"x", "y", "z"};
  const double h = 0.0025;
  double jump = 0.0;
  for (std::size_t i = 1000; i + 1 < f.truth.at("roll").size(); i += 37) {
    const Eigen::Matrix3d R = numerics::R_body_from_ned(v("roll", i), v("pitch", i), v("yaw", i));
    const Eigen::Vector3d v_r = air_velocity(v("airspeed", i), v("alpha", i), v("beta", i));
    EXPECT_LT((R.transpose() * v_r + vector("wind_", kNed, i) - vector("vel_", kNed, i)).norm(), 1e-11);
    // Within a step the gust is a straight line, so the mean acceleration is that of the trapezium rule to h^2/12 a'':
    // with modes up to 13 1/s and accelerations of 10 m/s^2 that is 9e-4.
    const Eigen::Vector3d a = (vector("vel_", kNed, i + 1) - vector("vel_", kNed, i)) / h;
    const Eigen::Matrix3d R_next = numerics::R_body_from_ned(v("roll", i + 1), v("pitch", i + 1), v("yaw", i + 1));
    const Eigen::Vector3d expected =
        0.5 * (R.transpose() * vector("accel_", kXyz, i) + R_next.transpose() * vector("accel_", kXyz, i + 1)) +
        Eigen::Vector3d(0, 0, kGravity);
    jump = std::max(jump, (a - expected).norm());
  }
  EXPECT_LT(jump, tolerance);
}

TEST(Simulation, ObeysNewtonAndTheWindTriangleAtEverySample) {
  expect_newton_and_wind_triangle({}, 1e-3);
  // Gusts change by up to 50 m/s in a second (four standard deviations, sigma_w sqrt(3 Va / (Lw h))): then a'' is of
  // the order 2 (L_alpha / m) (50 / Va)^2 = 5e3 m/s^4 from alpha and as much from the dynamic pressure, h^2/12 a'' =
  // 5e-3.
  expect_newton_and_wind_triangle(dryden_settings("low_light", "test"), 1e-2);
}

TEST(Simulation, TheSpeedAndAttitudeDoNotDependOnTheStep) {
  const auto end_state = [](double step) {
    SimulationOptions o = calm("unatrap", 30);
    o.step = step;
    o.truth_rate = 50;
    const SimulatedFlight f = fly(o);
    return std::array{f.truth.at("airspeed").value.back(), f.truth.at("pitch").value.back(),
                      f.truth.at("pos_north").value.back()};
  };
  const auto coarse = end_state(0.005), middle = end_state(0.0025), fine = end_state(0.00125);
  // The pilot is sampled once a step, a delay of half a step: first order, so halving the step halves the difference.
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(middle[i] - fine[i]), 0.7 * std::abs(coarse[i] - middle[i]) + 1e-9);
    EXPECT_NEAR(middle[i], fine[i], 0.02);
  }
}

// The coefficients that act are those of the model at the rates with p_g, q_g, r_g; the motion has its own.
TEST(Simulation, GustGradientsActAsBodyRatesInTheAerodynamics) {
  SimulationOptions o = calm("unatrap", 20);
  o.subject.model.stall.reset();
  o.turbulence = dryden_settings("low_moderate", "test");
  EXPECT_FALSE(fly(o).truth.has("gust_rate_x"));
  o.gust_gradients = true;
  const SimulatedFlight flight = fly(o);
  ASSERT_TRUE(flight.usable());
  const auto at = [&](const char* name, std::size_t k) { return flight.truth.at(name).value[k]; };
  double with = 0.0, without = 0.0;
  for (std::size_t k = 0; k < flight.truth.at("CL").size(); ++k) {
    AeroVariables<double> v;
    v.alpha = at("alpha", k), v.beta = at("beta", k), v.Va = at("airspeed", k);
    v.de = at("elevator", k), v.da = at("aileron", k), v.dr = at("rudder", k);
    const double b = 0.5 * o.subject.span / v.Va, c = 0.5 * o.subject.chord / v.Va;
    for (const double share : {0.0, 1.0}) {
      v.p_n = b * (at("gyro_x", k) + share * at("gust_rate_x", k));
      v.q_n = c * (at("gyro_y", k) + share * at("gust_rate_y", k));
      v.r_n = b * (at("gyro_z", k) + share * at("gust_rate_z", k));
      const AeroCoefficients<double> m = o.subject.model.evaluate(v);
      double& largest = share > 0.0 ? with : without;
      largest = std::max({largest, std::abs(m.CL - at("CL", k)), std::abs(m.CY - at("CY", k))});
    }
  }
  EXPECT_LT(with, 1e-12);
  EXPECT_GT(without, 1e-3);
}

// Commands that an ideal servo has at once are the deflections; behind a lag the deflections follow its closed form.
TEST(Simulation, LogsCommandsInPlaceOfDeflections) {
  SimulationOptions o = calm("unatrap", 60);
  o.log_commands = true;
  o.truth_rate = 400;
  o.subject.elevator = {};
  const SimulatedFlight ideal = fly(o);
  for (std::size_t k = 0; k < ideal.truth.at("elevator").size(); ++k)
    EXPECT_NEAR(ideal.truth.at("elevator").value[k], ideal.truth.at("elevator_command").value[k], 1e-15);
  o.subject.elevator.time_constant = 0.08;
  const SimulatedFlight flight = fly(o);
  const std::vector<double>&command = flight.truth.at("elevator_command").value,
        &deflection = flight.truth.at("elevator").value;
  double lagged = deflection[0], apart = 0.0;
  for (std::size_t k = 1; k < command.size(); ++k) {
    lagged += -std::expm1(-0.0025 / 0.08) * (command[k] - lagged);
    EXPECT_NEAR(deflection[k], lagged, 1e-12);
    apart = std::max(apart, std::abs(command[k] - deflection[k]));
  }
  EXPECT_GT(apart, 0.02);
  const Channel& logged = flight.measured.at("elevator");
  for (std::size_t i = 0; i < logged.size(); ++i) EXPECT_NEAR(logged.value[i], command[4 * i], 1e-12);
}

TEST(Simulation, LosesRowsOfTheLogAlone) {
  SimulationOptions o = calm("unatrap", 20);
  const SimulatedFlight all = fly(o);
  o.lost_rows = 0.2;
  const SimulatedFlight some = fly(o);
  EXPECT_EQ(some.measured.at("gyro_x").time, some.measured.at("gyro_y").time);
  EXPECT_NEAR(static_cast<double>(some.measured.at("gyro_x").size()), 0.8 * 2001.0, 4.0 * std::sqrt(0.16 * 2001.0));
  EXPECT_EQ(some.truth.at("alpha").value, all.truth.at("alpha").value);
}

std::string bytes(const Recording& r) {
  std::string out;
  for (const Channel& c : r.channels()) {
    out += c.name;
    out.append(reinterpret_cast<const char*>(c.value.data()), c.value.size() * sizeof(double));
    out.append(reinterpret_cast<const char*>(c.time->data()), c.time->size() * sizeof(double));
  }
  return out;
}

TEST(Simulation, SameSeedSameBytesAndOtherSeedOthers) {
  SimulationOptions o = calm("unatrap", 20);
  o.turbulence = dryden_settings("low_moderate", "test");
  o.wind.drift_sigma = 0.2;
  const SimulatedFlight a = fly(o), b = fly(o);
  EXPECT_EQ(bytes(a.measured), bytes(b.measured));
  EXPECT_EQ(bytes(a.truth), bytes(b.truth));
  o.seed = 2;
  EXPECT_NE(bytes(fly(o).measured), bytes(a.measured));
}

TEST(Simulation, SwitchingASensorOffLeavesTheOthersUnchanged) {
  SimulationOptions o = calm("unatrap", 5);
  o.turbulence = dryden_settings("low_moderate", "test");
  const SimulatedFlight all = fly(o);
  const auto gyro = std::ranges::find(sensor_kinds(), "gyro", &SensorKind::name);
  o.sensors.at(static_cast<std::size_t>(gyro - sensor_kinds().begin())).enabled = false;
  const SimulatedFlight some = fly(o);
  EXPECT_FALSE(some.measured.has("gyro_x"));
  for (const Channel& c : some.measured.channels()) EXPECT_EQ(c.value, all.measured.at(c.name).value) << c.name;
  EXPECT_EQ(bytes(all.truth), bytes(some.truth));
}

TEST(Simulation, EndsWithAReportWhenTheFlightFails) {
  SimulationOptions slow = calm("unatrap", 10);
  slow.airspeed = 6;
  EXPECT_EQ(fly(slow).end, FlightEnd::kNoTrim);

  SimulationOptions low = calm("unatrap", 60);
  low.altitude = 12;
  low.manoeuvres = std::vector<Manoeuvre>{{.kind = ManoeuvreKind::kDoublet,
                                           .start = 1,
                                           .surfaces = {Surface::kElevator},
                                           .amplitude = {-0.3},
                                           .pulse = 20}};
  const SimulatedFlight ground = fly(low);
  EXPECT_EQ(ground.end, FlightEnd::kGround) << ground.message();
  EXPECT_GT(ground.truth.at("alpha").size(), 100u);

  SimulationOptions stiff = calm("tut_airplane", 60);
  stiff.step = 0.02;
  stiff.subject.inertia = Inertia{1e-4, 1e-4, 1e-4, 0};
  const SimulatedFlight broken = fly(stiff);
  EXPECT_TRUE(broken.end == FlightEnd::kDiverged || broken.end == FlightEnd::kUpset) << broken.message();
}

/// Asks to stop at its n-th update.
class StopsAtUpdate : public Progress {
 public:
  explicit StopsAtUpdate(int n) : left_(n) {}
  bool update(double) override { return --left_ > 0; }

 private:
  int left_;
};

// 80,000 s with the default plan: the answer must come within seconds, before the flight and during it.
TEST(Simulation, EndsSoonWhenItIsInterrupted) {
  SimulationOptions o = calm("unatrap", 80000);
  for (const int update : {1, 3}) {
    StopsAtUpdate progress(update);
    const auto begin = std::chrono::steady_clock::now();
    const SimulatedFlight flight = simulate(o, progress);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 5.0);
    EXPECT_EQ(flight.end, FlightEnd::kInterrupted);
    EXPECT_FALSE(flight.usable());
    EXPECT_LT(flight.end_time, 20.0);
    EXPECT_EQ(flight.message(), fmt::format("interrupted at {:.1f} s", flight.end_time));
  }
}

TEST(Simulation, RefusesASubjectThatCannotFly) {
  SimulationOptions o = calm("unatrap", 1);
  o.subject.inertia.reset();
  EXPECT_THROW(static_cast<void>(fly(o)), InputError);
  o = calm("unatrap", 1);
  o.subject.model.at(Coefficient::kCm).values[1] = kNaN;
  try {
    static_cast<void>(fly(o));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "subject 'unatrap': has no values for Cm_alpha: a simulation needs them");
  }
}

}  // namespace
}  // namespace veridyn::aircraft
