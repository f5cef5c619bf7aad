#include "veridyn/muscle/dynamics/coordinate_forces.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>

namespace veridyn::muscle {
namespace {

CoordinateLimitForce elbow_limit() {
  CoordinateLimitForce limit;
  limit.upper_limit = 2.0;
  limit.upper_stiffness = 30.0;
  limit.lower_limit = 0.1;
  limit.lower_stiffness = 20.0;
  limit.damping = 0.5;
  limit.transition = 0.2;
  return limit;
}

TEST(LimitForce, IsNothingInsideAndASpringWithDamperOutside) {
  const CoordinateLimitForce limit = elbow_limit();
  for (const double q : {0.1, 0.7, 2.0}) EXPECT_EQ(limit_force(limit, q, 3.0), 0.0) << q;
  EXPECT_NEAR(limit_force(limit, 2.5, 3.0), -30.0 * 0.5 - 0.5 * 3.0, 1e-14);
  EXPECT_NEAR(limit_force(limit, -0.4, 3.0), 20.0 * 0.5 - 0.5 * 3.0, 1e-14);
  // In the middle of the transition the step is a half, and so are stiffness and damping.
  EXPECT_NEAR(limit_force(limit, 2.1, 3.0), 0.5 * (-30.0 * 0.1 - 0.5 * 3.0), 1e-14);
  EXPECT_NEAR(limit_force(limit, 0.0, 3.0), 0.5 * (20.0 * 0.1 - 0.5 * 3.0), 1e-14);
}

/// Integral of x s(x) from 0 to x with the quintic step s of `limit_force`.
template <typename Scalar>
Scalar step_moment(const Scalar& x) {
  if (!(x > 0.0)) return x * 0.0;
  if (x >= 1.0) return 0.5 * x * x - 1.0 / 7.0;
  const Scalar x2 = x * x;
  return x2 * x2 * x * (x * (x * (6.0 / 7.0) - 2.5) + 2.0);
}

/// Energy stored in the limit's springs [J].
template <typename Scalar>
Scalar limit_energy(const CoordinateLimitForce& limit, const Scalar& q) {
  const double unit = limit.transition * limit.transition;
  return limit.upper_stiffness * unit * step_moment(Scalar((q - limit.upper_limit) / limit.transition)) +
         limit.lower_stiffness * unit * step_moment(Scalar((limit.lower_limit - q) / limit.transition));
}

TEST(LimitForce, IsMinusTheSlopeOfItsEnergyAndHasTwoContinuousDerivatives) {
  using Jet = ceres::Jet<double, 1>;
  const CoordinateLimitForce limit = elbow_limit();
  for (double q = -0.5; q < 3.0; q += 0.037) {
    EXPECT_NEAR(limit_force(limit, q, 0.0), -limit_energy(limit, Jet(q, 0)).v[0], 1e-13) << q;
  }
  for (const double edge : {-0.1, 0.1, 2.0, 2.2}) {
    const double h = 1e-4;
    const auto slope = [&](double q) { return limit_force(limit, Jet(q, 0), Jet(0.0)).v[0]; };
    EXPECT_NEAR(slope(edge - h), slope(edge + h), 1e-2) << edge;  // continuous slope
    EXPECT_NEAR(limit_energy(limit, edge - h), limit_energy(limit, edge + h), 1e-2);
    // No jump of the second derivative: second differences on both sides go to the same limit with h.
    const auto bend = [&](double q) { return (slope(q + h) - slope(q - h)) / (2.0 * h); };
    EXPECT_NEAR(bend(edge - 2.0 * h), bend(edge + 2.0 * h), 40.0) << edge;
  }
}

TEST(LimitForce, MayHaveNoStiffnessOnOneSide) {
  CoordinateLimitForce limit = elbow_limit();
  limit.upper_stiffness = 0.0;
  EXPECT_NEAR(limit_force(limit, 2.5, 3.0), -0.5 * 3.0, 1e-15);
}

TEST(CoordinateForces, AddToWhatIsThere) {
  std::array<double, 2> tau{4.0, 22.5};
  std::array<CoordinateLimitForce, 1> limits{elbow_limit()};
  limits[0].coordinate = 1;
  const std::array<double, 2> q{5.0, 2.5}, qdot{5.0, 3.0};
  add_limit_forces<double>(limits, q.data(), qdot.data(), tau.data());
  EXPECT_EQ(tau[0], 4.0);
  EXPECT_NEAR(tau[1], 22.5 - 16.5, 1e-13);
}

TEST(CoordinateForces, OfASpringAreThoseOfItsEnergyAndItsDamperDissipates) {
  Model model;
  CoordinateSpring spring;
  spring.stiffness = 5.0;
  spring.rest_length = 0.2;
  spring.viscosity = 0.3;
  model.coordinate_springs.push_back(spring);
  const double q = 0.7, qdot = 2.0;
  double tau = 1.0;
  add_coordinate_forces<double>(model, &q, &qdot, &tau);
  EXPECT_DOUBLE_EQ(tau, 1.0 - 5.0 * 0.5 - 0.3 * 2.0);
  const auto energy = [&](double x) { return 0.5 * 5.0 * (x - 0.2) * (x - 0.2); };
  EXPECT_NEAR(spring_force(spring, q, 0.0), -(energy(q + 1e-5) - energy(q - 1e-5)) / 2e-5, 1e-9);
}

TEST(PassiveTension, IsNoneWhileThePathIsSlackAndNeverAPush) {
  const PassivePathLaw spring = PathSpringLaw{0.3, 100.0, 0.5};
  EXPECT_EQ(passive_tension(spring, 0.29, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(passive_tension(spring, 0.4, 0.4), 100.0 * (0.4 - 0.3) * 1.2);
  EXPECT_EQ(passive_tension(spring, 0.4, -3.0), 0.0);
  const PassivePathLaw ligament = LigamentLaw{0.2, 50.0, numerics::PiecewisePolynomial::linear(2.0, 0.0)};
  EXPECT_NEAR(passive_tension(ligament, 0.22, 0.0), 50.0 * 2.0 * 0.1, 1e-12);
  EXPECT_EQ(passive_tension(ligament, 0.2, 0.0), 0.0);
}

/// Energy stored by a Blankevoort ligament: the integral of its law over the length.
double stored(const BlankevoortLaw& law, double length) {
  const double e = length / law.slack_length - 1.0, t = law.transition_strain;
  const double unit = law.linear_stiffness * law.slack_length;
  if (!(e > 0.0)) return 0.0;
  return e < t ? unit * e * e * e / (6.0 * t) : unit * (t * t / 6.0 + 0.5 * e * (e - t));
}

TEST(CoordinateForces, OfABlankevoortLigamentAreTheSlopeOfItsEnergy) {
  const BlankevoortLaw law{.slack_length = 0.05, .linear_stiffness = 2000.0, .transition_strain = 0.06};
  for (const double length : {0.04, 0.0499, 0.051, 0.0525, 0.0529, 0.0531, 0.06}) {
    constexpr double kStep = 1e-6;
    const double slope = (stored(law, length + kStep) - stored(law, length - kStep)) / (2.0 * kStep);
    // Central differences of energies of joules: rounding of 1e-16/h, and h^2 times a third derivative.
    EXPECT_NEAR(passive_tension<double>(law, length, 0.0), slope, 1e-5) << length;
  }
  // At twice the transition strain 2000 (0.12 - 0.03) N.
  EXPECT_NEAR(passive_tension<double>(law, 0.05 * 1.12, 0.0), 180.0, 1e-9);
}

TEST(CoordinateForces, ABlankevoortLigamentDampsOnlyWhileItLengthens) {
  const BlankevoortLaw law{
      .slack_length = 0.05, .linear_stiffness = 2000.0, .transition_strain = 0.06, .damping_coefficient = 3.0};
  const double length = 0.05 * 1.12;
  EXPECT_NEAR(passive_tension<double>(law, length, 0.1), 180.0 + 3.0 * 0.1 / 0.05, 1e-9);
  EXPECT_NEAR(passive_tension<double>(law, length, -0.1), 180.0, 1e-9);
  // Half of it at half of the strain at which it is whole; none when slack.
  const double strain = 0.005;
  EXPECT_NEAR(passive_tension<double>(law, 0.05 * (1.0 + strain), 0.1),
              2000.0 * strain * strain / 0.12 + 0.5 * 3.0 * 0.1 / 0.05, 1e-9);
  EXPECT_EQ(passive_tension<double>(law, 0.049, 1.0), 0.0);
}

}  // namespace
}  // namespace veridyn::muscle
