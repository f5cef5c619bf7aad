#include "veridyn/aircraft/model/flight_dynamics.hpp"

#include <ceres/jet.h>

#include "tests/aircraft/rescaled_subject.hpp"
#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/wind_axes.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using Eigen::Vector3d;
using numerics::RandomStream;
using State = RigidBodyState<double>;

Controls<double> some_controls() { return {-0.05, 0.03, 0.02, 0.6, 700.0}; }

TEST(FlightDynamics, TheWindAxesEquationsAgreeWithTheBodyAxesDynamics) {
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(3, "axes");
  const Subject s = builtin_subject("unatrap");
  for (int i = 0; i < 200; ++i) {
    const double Va = random.uniform(12, 30), alpha = random.uniform(-0.3, 0.4), beta = random.uniform(-0.4, 0.4);
    const double phi = random.uniform(-3, 3), theta = random.uniform(-1.2, 1.2);
    const Vector3d omega(random.normal(), random.normal(), random.normal());
    const Vector3d v = air_velocity(Va, alpha, beta);
    const AeroLoads<double> loads = aero_loads<double>(s, v, omega, some_controls(), 1.2);

    // Exact body-axes dynamics, then air data of v + t v' by automatic differentiation.
    const Vector3d acceleration =
        loads.force / s.mass - omega.cross(v) + numerics::R_body_from_ned(phi, theta, 0.3) * Vector3d(0, 0, kGravity);
    Eigen::Matrix<Jet, 3, 1> moving;
    for (int k = 0; k < 3; ++k) {
      moving(k) = Jet(v(k));
      moving(k).v[0] = acceleration(k);
    }
    const AirData<Jet> expected = air_data(moving);

    WindAxesInput<double> in;
    in.CL = loads.coefficients.CL;
    in.CD = loads.coefficients.CD;
    in.CY = loads.coefficients.CY;
    in.p = omega(0);
    in.q = omega(1);
    in.r = omega(2);
    in.phi = phi;
    in.theta = theta;
    in.thrust = loads.propulsion.thrust;
    in.dynamic_pressure_area = loads.dynamic_pressure * s.wing_area;
    in.mass = s.mass;
    in.gravity = kGravity;
    const WindAxesRate<double> rate = wind_axes_rate(Va, alpha, beta, in);
    EXPECT_NEAR(rate.Va, expected.Va.v[0], 1e-12 * (1 + std::abs(rate.Va)));
    EXPECT_NEAR(rate.alpha, expected.alpha.v[0], 1e-12);
    EXPECT_NEAR(rate.beta, expected.beta.v[0], 1e-12);
    EXPECT_GT(in.thrust, 1.0);  // without thrust the sign of its term in beta' would go unnoticed
  }
}

// A reference length is a definition: with numbers that belong to it, forces and moments are the same.
TEST(FlightDynamics, ReferenceLengthsOfEachAxisAreDefinitions) {
  RandomStream random(4, "lengths");
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    const Subject other = testing::with_lengths(s, {.roll = 0.5, .pitch = 3.0, .yaw = 0.2});
    ASSERT_NE(other.model, s.model);
    for (int i = 0; i < 20; ++i) {
      const Vector3d v = air_velocity(random.uniform(12, 30), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
      const Vector3d omega(random.normal(), random.normal(), random.normal());
      const AeroLoads<double> a = aero_loads<double>(s, v, omega, some_controls(), 1.2);
      const AeroLoads<double> b = aero_loads<double>(other, v, omega, some_controls(), 1.2);
      EXPECT_LT((a.force - b.force).norm(), 1e-12 * (1.0 + a.force.norm())) << name;
      EXPECT_LT((a.moment - b.moment).norm(), 1e-12 * (1.0 + a.moment.norm())) << name;
    }
  }
}

TEST(FlightDynamics, PutsTheForcesWhereTheConventionsSay) {
  Subject s = builtin_subject("skywalker_2013");
  const Vector3d v = air_velocity(15.0, 0.1, 0.05);
  const AeroLoads<double> loads = aero_loads<double>(s, v, Vector3d::Zero(), some_controls(), 1.225);
  const double qS = 0.5 * 1.225 * 225 * 0.45;
  const double CL = 0.56 + 6.9 * 0.1;
  const double CD = 0.1 + CL * CL / (M_PI * 0.9 * 1.88 * 1.88 / 0.45);
  const double CY = -0.98 * 0.05 - 0.2 * 0.02;
  EXPECT_NEAR(loads.dynamic_pressure * s.wing_area, qS, 1e-10);
  // The stall blend at 0.1 rad is 1e-8 of the lift.
  EXPECT_NEAR(loads.coefficients.CL, CL, 1e-7);
  EXPECT_NEAR(loads.coefficients.CD, CD, 1e-12);
  const double thrust = std::max(0.0, 0.5 * 1.225 * 0.33 * (18.0 * 18.0 - v.x() * v.x()));
  const Vector3d aero(qS * (CL * std::sin(0.1) - CD * std::cos(0.1)), qS * CY,
                      -qS * (CL * std::cos(0.1) + CD * std::sin(0.1)));
  EXPECT_LT((loads.force - aero - Vector3d(thrust, 0, 0)).norm(), 1e-5);
  const Vector3d moments(qS * 1.88 * (-0.12 * 0.05 + 0.25 * 0.03 - 0.037 * 0.02),
                         qS * 0.24 * (0.045 - 0.7 * 0.1 + 1.0 * -0.05), qS * 1.88 * (0.25 * 0.05 + 0.1 * 0.02));
  EXPECT_LT((loads.moment - moments - Vector3d(-0.02, 0, -0.05).cross(aero)).norm(), 1e-6);
  // On the x axis the engine has no lever arm.
  s.propulsion.position = {-0.25, 0, -0.13};
  const Vector3d moved = aero_loads<double>(s, v, Vector3d::Zero(), some_controls(), 1.225).moment;
  EXPECT_NEAR(moved.y() - loads.moment.y(), -0.13 * thrust, 1e-10);
}

TEST(FlightDynamics, DoNotKnowWhereTheyAreOrHowFastTheAirMoves) {
  // Galilei: the same flight in wind, and turned about the vertical, has the same accelerations in the body.
  const Subject s = builtin_subject("unatrap");
  const MassProperties body(s.mass, s.inertia->matrix());
  State x = State::Zero();
  x.segment<4>(6) = numerics::quaternion_from_euler(0.2, 0.1, 0.5).coeffs();
  x.segment<3>(3) = Vector3d(18, 4, -1);
  x.tail<3>() = Vector3d(0.1, 0.2, -0.3);
  const Vector3d wind(3, -5, 1), gust(0.5, -0.4, 0.3);
  const State calm = aircraft_rate<double>(s, body, x, some_controls(), Vector3d::Zero(), gust, 1.2, 9.81);
  State y = x;
  y.segment<3>(3) += wind;
  y.head<3>() += Vector3d(100, 200, -50);
  const State windy = aircraft_rate<double>(s, body, y, some_controls(), wind, gust, 1.2, 9.81);
  EXPECT_LT((windy - calm).tail<10>().norm(), 1e-12);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.0, Vector3d::UnitZ()).toRotationMatrix();
  State z = x;
  z.segment<3>(3) = turn * x.segment<3>(3);
  z.segment<4>(6) = numerics::quaternion_from_euler(0.2, 0.1, 1.5).coeffs();
  const State turned = aircraft_rate<double>(s, body, z, some_controls(), Vector3d::Zero(), gust, 1.2, 9.81);
  EXPECT_LT((turned.segment<3>(3) - turn * calm.segment<3>(3)).norm(), 1e-12);
  EXPECT_LT((turned.tail<3>() - calm.tail<3>()).norm(), 1e-12);
}

// Air that turns by -w gives the forces and moments of an aircraft that turns by w more, and no gyroscopic moment.
TEST(FlightDynamics, GustRatesAreBodyRatesToTheAirAlone) {
  const Subject s = builtin_subject("unatrap");
  const MassProperties body(s.mass, s.inertia->matrix());
  State x = State::Zero();
  x(9) = 1.0;
  x(3) = 20.0;
  const Vector3d zero = Vector3d::Zero(), turn(0.3, -0.2, 0.1);
  const State in_gust = aircraft_rate<double>(s, body, x, some_controls(), zero, zero, 1.2, 9.81, {.gust_rates = turn});
  const AeroLoads<double> turning = aero_loads<double>(s, x.segment<3>(3), turn, some_controls(), 1.2);
  EXPECT_LT((body.inertia * in_gust.tail<3>() - turning.moment).norm(), 1e-12);
  EXPECT_LT((in_gust.segment<3>(3) - turning.force / s.mass - Vector3d(0, 0, 9.81)).norm(), 1e-12);
  EXPECT_LT((in_gust.head<3>() - x.segment<3>(3)).norm(), 1e-15);
  EXPECT_GT((turning.moment - aero_loads<double>(s, x.segment<3>(3), zero, some_controls(), 1.2).moment).norm(), 0.1);
}

}  // namespace
}  // namespace veridyn::aircraft
