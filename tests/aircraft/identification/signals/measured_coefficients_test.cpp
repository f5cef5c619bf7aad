#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"

#include <gtest/gtest.h>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/rigid_body.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using F = FlightSignal;

FlightSample<double> random_sample(numerics::RandomStream& random) {
  FlightSample<double> s;
  s[F::kAlpha] = 0.1 * random.normal();
  s[F::kBeta] = 0.1 * random.normal();
  s[F::kAirspeed] = 15.0 + random.normal();
  for (const F f : {F::kP, F::kQ, F::kR}) s[f] = 0.5 * random.normal();
  for (const F f : {F::kPdot, F::kQdot, F::kRdot}) s[f] = 2.0 * random.normal();
  for (const F f : {F::kAx, F::kAy, F::kAz}) s[f] = 5.0 * random.normal();
  for (const F f : {F::kElevator, F::kAileron, F::kRudder}) s[f] = 0.1 * random.normal();
  s[F::kThrust] = 5.0;
  return s;
}

// Forward: forces and moments from coefficients, then the equations of motion in vector form. Back:
// measured_coefficients.
TEST(MeasuredCoefficients, InvertTheEquationsOfMotion) {
  numerics::RandomStream random(7, "inverse");
  Subject subject = builtin_subject("thor");
  subject.force_point = {-0.02, 0.01, -0.05};
  subject.propulsion.position = {0.2, 0.03, -0.04};
  const double rho = 1.1;
  for (int i = 0; i < 100; ++i) {
    FlightSample<double> s = random_sample(random);
    const AeroCoefficients<double> c{.CL = random.normal(),
                                     .CD = random.normal(),
                                     .CY = random.normal(),
                                     .Cl = random.normal(),
                                     .Cm = random.normal(),
                                     .Cn = random.normal()};
    const double torque = 0.1 * random.normal();
    const double qS = 0.5 * rho * subject.wing_area * s[F::kAirspeed] * s[F::kAirspeed];
    const double ca = std::cos(s[F::kAlpha]), sa = std::sin(s[F::kAlpha]);
    const Eigen::Vector3d aero(qS * (-c.CD * ca + c.CL * sa), qS * c.CY, qS * (-c.CD * sa - c.CL * ca));
    const Eigen::Vector3d thrust(s[F::kThrust], 0.0, 0.0);
    const Eigen::Vector3d point(subject.force_point[0], subject.force_point[1], subject.force_point[2]);
    const Eigen::Vector3d engine(subject.propulsion.position[0], subject.propulsion.position[1],
                                 subject.propulsion.position[2]);
    const Eigen::Vector3d moment =
        qS * Eigen::Vector3d(subject.span * c.Cl, subject.chord * c.Cm, subject.span * c.Cn) + point.cross(aero) +
        engine.cross(thrust) + Eigen::Vector3d(torque, 0.0, 0.0);
    const MassProperties body(subject.mass, subject.inertia->matrix());
    RigidBodyState<double> x = RigidBodyState<double>::Zero();
    x(9) = 1.0;
    x.tail<3>() << s[F::kP], s[F::kQ], s[F::kR];
    const RigidBodyState<double> rate = rigid_body_rate<double>(x, body, aero + thrust, moment, 0.0);
    s[F::kAx] = rate(3);
    s[F::kAy] = rate(4);
    s[F::kAz] = rate(5);
    s[F::kPdot] = rate(10);
    s[F::kQdot] = rate(11);
    s[F::kRdot] = rate(12);
    const AeroCoefficients<double> back = measured_coefficients(s, subject, rho, torque);
    EXPECT_NEAR(back.CL, c.CL, 1e-12);
    EXPECT_NEAR(back.CD, c.CD, 1e-12);
    EXPECT_NEAR(back.CY, c.CY, 1e-12);
    EXPECT_NEAR(back.Cl, c.Cl, 1e-12);
    EXPECT_NEAR(back.Cm, c.Cm, 1e-11);
    EXPECT_NEAR(back.Cn, c.Cn, 1e-12);
  }
}

TEST(CoefficientRow, HasTheJacobianOfCentralDifferences) {
  numerics::RandomStream random(8, "jacobian");
  const Subject subject = builtin_subject("thor");
  const CoefficientModel model = coefficient_model(
      Coefficient::kCm,
      std::vector<std::pair<std::string_view, double>>{{"1", 0.0}, {"alpha", 0.0}, {"alpha*q_n", 0.0}, {"de", 0.0}});
  const FlightSample<double> s = random_sample(random);
  const CoefficientRow row = coefficient_row(model, s, subject, 1.2);
  for (std::size_t i = 0; i < kFlightSignals; ++i) {
    const double h = 1e-5 * std::max(1.0, std::abs(s.value[i]));
    FlightSample<double> low = s;
    FlightSample<double> high = s;
    low.value[i] -= h;
    high.value[i] += h;
    const Eigen::VectorXd slope =
        (coefficient_row(model, high, subject, 1.2).row - coefficient_row(model, low, subject, 1.2).row) / (2.0 * h);
    for (Eigen::Index j = 0; j < slope.size(); ++j) {
      EXPECT_NEAR(row.jacobian(j, i), slope(j), 1e-7 * std::max(1.0, std::abs(slope(j))))
          << kFlightSignalNames[i] << " row " << j;
    }
  }
}

}  // namespace
}  // namespace veridyn::aircraft
