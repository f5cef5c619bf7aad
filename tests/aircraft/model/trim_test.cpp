#include "veridyn/aircraft/model/trim.hpp"

#include "tests/aircraft/model/modes.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

using Complex = std::complex<double>;

TrimCondition published(double airspeed) {
  return {.airspeed = airspeed, .density = 1.225, .bank = 0.0, .gravity = 9.81};
}

void expect_modes(const std::vector<Complex>& ours, const std::vector<Complex>& theirs, double tolerance) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(ours[i].real(), theirs[i].real(), tolerance) << i;
    EXPECT_NEAR(ours[i].imag(), theirs[i].imag(), tolerance) << i;
  }
}

// Trim and modes computed independently from the published equations, to the digits given there.
TEST(Trim, MatchesTheIndependentNumbersOfTheSkywalker) {
  const Subject s = builtin_subject("skywalker_2013");
  const Trim t = find_trim(s, published(15.0));
  ASSERT_TRUE(t.usable()) << t.message();
  EXPECT_NEAR(t.alpha, -0.03478, 5e-6);
  EXPECT_NEAR(t.controls.de, -0.06710, 5e-6);
  EXPECT_NEAR(t.controls.throttle, 0.53421, 5e-6);
  const LinearModel m = linearise(s, t);
  expect_modes(testing::longitudinal_eigenvalues(m), {-12.926, -4.226, -2.787, -0.101}, 6e-4);
  expect_modes(testing::lateral_eigenvalues(m), {-9.278, {-2.795, 4.015}, {-2.795, -4.015}, -0.207}, 6e-4);
}

TEST(Trim, MatchesTheIndependentNumbersOfTheAerosonde) {
  const Subject s = builtin_subject("aerosonde");
  const Trim t = find_trim(s, published(35.0));
  ASSERT_TRUE(t.usable()) << t.message();
  EXPECT_NEAR(t.alpha, 0.01792, 5e-6);
  EXPECT_NEAR(t.controls.de, 0.06038, 5e-6);
  EXPECT_NEAR(t.controls.throttle, 0.46416, 5e-6);
  const LinearModel m = linearise(s, t);
  expect_modes(testing::longitudinal_eigenvalues(m), {{-2.471, 5.093}, {-2.471, -5.093}, -0.384, -0.327}, 6e-4);
  expect_modes(testing::lateral_eigenvalues(m), {-60.44, -18.45, -10.43, -0.080}, 6e-3);
}

TEST(Trim, IsFoundForEveryBuiltInAircraftAndReallySteady) {
  const std::vector<std::pair<std::string, double>> speeds = {
      {"unatrap", 20}, {"skywalker_2013_mod", 13}, {"tut_airplane", 15}, {"hcuav", 40}, {"x8", 18}, {"thor", 17}};
  for (const auto& [name, speed] : speeds) {
    const Subject s = builtin_subject(name);
    for (const double bank : {0.0, 0.3}) {
      if (bank > 0.0 && name == "x8") continue;  // no rudder: a turn of the prescribed rate does not balance
      const Trim t = find_trim(s, {.airspeed = speed, .bank = bank});
      ASSERT_TRUE(t.usable()) << name << ": " << t.message();
      // Flown with the six degrees of freedom, height and speed stay: another formulation of the dynamics.
      const MassProperties body(s.mass, s.inertia->matrix());
      RigidBodyState<double> x = RigidBodyState<double>::Zero();
      x.segment<4>(6) = numerics::quaternion_from_euler(bank, t.theta, 0.0).coeffs();
      x.segment<3>(3) = R_body_from_ned(x).transpose() * air_velocity(speed, t.alpha, t.beta);
      x.tail<3>() = t.rates;
      const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
      for (int i = 0; i < 200; ++i) {
        x = numerics::runge_kutta_4_step(
            [&](double, const RigidBodyState<double>& y) {
              return aircraft_rate<double>(s, body, y, t.controls, zero, zero, kSeaLevelDensity, kGravity);
            },
            0.0, x, 0.0025);
      }
      EXPECT_NEAR(x(2), 0.0, 1e-7) << name;
      EXPECT_NEAR(x.segment<3>(3).norm(), speed, 1e-7) << name;
      EXPECT_NEAR(numerics::euler_from_quaternion(attitude_of(x)).phi, bank, 1e-7) << name;
    }
  }
}

TEST(Trim, SaysWhenTheAircraftCannotFlyThere) {
  const Subject s = builtin_subject("unatrap");
  const Trim slow = find_trim(s, {.airspeed = 5.0});
  EXPECT_FALSE(slow.usable());
  const Trim fast = find_trim(s, {.airspeed = 60.0});
  EXPECT_EQ(fast.end, TrimEnd::kLimits);
  EXPECT_THAT(fast.message(), ::testing::HasSubstr("needs more than the controls have"));
  Subject glider = s;
  glider.propulsion = {};
  const Trim no_engine = find_trim(glider, {.airspeed = 20.0});
  EXPECT_EQ(no_engine.end, TrimEnd::kNoSolution);
  EXPECT_THAT(no_engine.message(), ::testing::HasSubstr("does not exist for this aircraft"));
}

}  // namespace
}  // namespace veridyn::aircraft
