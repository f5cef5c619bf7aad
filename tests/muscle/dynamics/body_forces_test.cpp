#include "veridyn/muscle/dynamics/body_forces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <span>

#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

/// A body that flies free and another one on a pin.
Model two_bodies() {
  return OsimFile::parse(R"(<OpenSimDocument Version="40000"><Model name="two"><BodySet><objects>
<Body name="ball"><mass>2</mass><inertia>0.02 0.03 0.04 0 0 0</inertia></Body>
<Body name="bar"><mass>1</mass><inertia>0.02 0.03 0.04 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><FreeJoint name="free"><socket_parent_frame>/ground</socket_parent_frame>
<socket_child_frame>/bodyset/ball</socket_child_frame></FreeJoint>
<PinJoint name="pin"><socket_parent_frame>/ground</socket_parent_frame>
<socket_child_frame>/bodyset/bar</socket_child_frame></PinJoint></objects></JointSet></Model></OpenSimDocument>)",
                         "two.osim")
      .model();
}

struct Posed {
  Model model = two_bodies();
  Mechanism mechanism{model};
  Kinematics<double> kinematics{mechanism};

  void set(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
    update_positions(mechanism, q.data(), kinematics);
    update_velocities(mechanism, qdot.data(), kinematics);
  }
  [[nodiscard]] Eigen::VectorXd forces(const BodyForces& all) const {
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(mechanism.coordinates());
    add_body_forces(all, mechanism, kinematics, tau.data());
    return tau;
  }
};

Eigen::VectorXd random_vector(std::mt19937& random, Eigen::Index size, double scale) {
  std::uniform_real_distribution<double> u(-scale, scale);
  Eigen::VectorXd v(size);
  for (double& x : v) x = u(random);
  return v;
}

/// Where nothing moves the forces are minus the slopes of an energy; motion takes energy out.
template <typename Energy>
void expect_energy(const BodyForces& all, const Energy& energy, double tolerance) {
  Posed posed;
  std::mt19937 random(4);
  const Eigen::Index n = posed.mechanism.coordinates();
  ASSERT_EQ(n, 7);
  int acting = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q = random_vector(random, n, 0.5);
    posed.set(q, Eigen::VectorXd::Zero(n));
    const Eigen::VectorXd rest = posed.forces(all);
    acting += rest.norm() > 0.0 ? 1 : 0;
    for (Eigen::Index c = 0; c < n; ++c) {
      const double h = 1e-5;
      const auto at = [&](double step) {
        posed.set(q + step * Eigen::VectorXd::Unit(n, c), Eigen::VectorXd::Zero(n));
        return energy(posed);
      };
      EXPECT_NEAR(rest(c), -(at(h) - at(-h)) / (2.0 * h), tolerance * (1.0 + std::abs(rest(c)))) << q.transpose();
    }
    const Eigen::VectorXd qdot = random_vector(random, n, 1.0);
    posed.set(q, qdot);
    EXPECT_LE((posed.forces(all) - rest).dot(qdot), 1e-9) << q.transpose();
  }
  EXPECT_GT(acting, 50);
}

TEST(BodyForces, OfAPointSpringAreTheSlopesOfItsEnergy) {
  BodyForces all;
  all.springs.push_back({"s", 1, 2, {0.1, 0.0, 0.05}, {0.0, -0.3, 0.1}, 150.0, 0.2});
  expect_energy(
      all,
      [&](const Posed& p) {
        const Eigen::Vector3d a = body_pose(p.mechanism, p.kinematics, 1) * all.springs[0].point_1;
        const Eigen::Vector3d b = body_pose(p.mechanism, p.kinematics, 2) * all.springs[0].point_2;
        return 75.0 * std::pow((b - a).norm() - 0.2, 2);
      },
      1e-7);
}

/// Between the two bodies, with dampers.
Bushing placed_bushing() {
  Bushing b;
  b.body_1 = 2;
  b.body_2 = 1;
  b.frame_1 = {body_fixed_xyz({0.2, -0.1, 0.3}), {0.0, -0.2, 0.0}};
  b.frame_2 = {body_fixed_xyz({-0.1, 0.3, 0.1}), {0.1, 0.0, 0.05}};
  b.rotational_damping = {1.0, 2.0, 3.0};
  b.translational_damping = {4.0, 5.0, 6.0};
  return b;
}

/// Angles and translation of its second frame in its first.
Eigen::Vector<double, 6> deflection(const Bushing& b, const Posed& p) {
  const auto frame = [&](int body, const Placement& in) {
    const Pose<double> pose = body_pose(p.mechanism, p.kinematics, body);
    return Placement{pose.rotation * in.rotation, pose * in.translation};
  };
  const Placement relative = frame(b.body_1, b.frame_1).inverse() * frame(b.body_2, b.frame_2);
  const Eigen::Matrix3d& R = relative.rotation;
  const Eigen::Vector3d t(std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0)));
  EXPECT_NEAR((body_fixed_xyz(t) - R).norm(), 0.0, 1e-12);
  Eigen::Vector<double, 6> all;
  all << t, relative.translation;
  return all;
}

TEST(BodyForces, OfABushingAreTheSlopesOfItsEnergyAndItsDampersDissipate) {
  Bushing b = placed_bushing();
  b.set_stiffness({10.0, 20.0, 30.0}, {100.0, 200.0, 300.0});
  BodyForces all;
  all.bushings.push_back(b);
  const Eigen::Vector<double, 6> stiffness{10.0, 20.0, 30.0, 100.0, 200.0, 300.0};
  expect_energy(
      all, [&](const Posed& p) { return 0.5 * deflection(b, p).cwiseAbs2().dot(stiffness); }, 1e-7);
}

TEST(BodyForces, OfABushingOfFunctionsAreTheSlopesOfTheirIntegrals) {
  Bushing b = placed_bushing();
  for (std::size_t i = 0; i < 6; ++i) {
    // Stiffening, stronger to one side, with a pull at rest.
    const double k = 10.0 * (1.0 + static_cast<double>(i));
    b.resistance[i] = numerics::PiecewisePolynomial::polynomial(std::array{0.1 * k, k, 0.5 * k, 3.0 * k});
  }
  BodyForces all;
  all.bushings.push_back(b);
  expect_energy(
      all,
      [&](const Posed& p) {
        const Eigen::Vector<double, 6> x = deflection(b, p);
        double energy = 0.0;
        for (std::size_t i = 0; i < 6; ++i) {
          const double k = 10.0 * (1.0 + static_cast<double>(i)), d = x(static_cast<int>(i));
          energy += k * d * (0.1 + d * (0.5 + d * (0.5 / 3.0 + d * 0.75)));
        }
        return energy;
      },
      1e-7);
}

SphereContact ball_on_the_floor(double dissipation, double friction) {
  SphereContact c;
  c.sphere_body = 1;
  c.center = {0.02, 0.01, 0.0};
  c.radius = 0.3;
  c.plane = {body_fixed_xyz({0.0, 0.0, -1.5707963267948966}), {0.0, 0.0, 0.0}};  // y > 0 is free
  c.half_stiffness = std::pow(1e5, 2.0 / 3.0) / 2.0;
  c.dissipation = dissipation;
  c.static_friction = c.dynamic_friction = friction;
  c.viscous_friction = 0.1 * friction;
  return c;
}

TEST(BodyForces, OfContactAreHertzsAndFrictionAndDampingDissipate) {
  BodyForces all;
  all.contacts.push_back(ball_on_the_floor(0.5, 0.8));
  expect_energy(
      all,
      [&](const Posed& p) {
        const SphereContact& c = all.contacts[0];
        const double depth = c.radius - (body_pose(p.mechanism, p.kinematics, 1) * c.center).y();
        return depth > 0.0 ? 0.4 * hertz_force(c, depth) * depth : 0.0;
      },
      1e-5);
}

TEST(BodyForces, ABallRestsWhereHertzCarriesItsWeight) {
  Posed posed;
  BodyForces all;
  all.contacts.push_back(ball_on_the_floor(0.0, 0.0));
  const SphereContact& c = all.contacts[0];
  // Two equal moduli E* of 1e5 Pa make 1/2 E* of each: F = 4/3 (1e5/2^(3/2)) sqrt(R) depth^(3/2).
  const double weight = 2.0 * 9.81;
  const double depth = std::pow(weight / (4.0 / 3.0 * 1e5 / std::pow(2.0, 1.5) * std::sqrt(c.radius)), 2.0 / 3.0);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(7);
  q(4) = c.radius - depth - c.center.y();
  posed.set(q, Eigen::VectorXd::Zero(7));
  EXPECT_NEAR(posed.forces(all)(4), weight, 1e-9 * weight);
  // Out of reach there is nothing.
  q(4) = c.radius - c.center.y() + 1e-9;
  posed.set(q, Eigen::VectorXd::Zero(7));
  EXPECT_TRUE(posed.forces(all).isZero(0.0));
}

TEST(BodyForces, SmoothContactComesToTheSharpOne) {
  Posed posed;
  BodyForces sharp, smooth;
  sharp.contacts.push_back(ball_on_the_floor(0.5, 0.8));
  smooth = sharp;
  smooth.contacts[0].smooth = true;
  smooth.contacts[0].constant_force = 1e-14;
  smooth.contacts[0].hertz_smoothing = 1e5;
  smooth.contacts[0].hunt_crossley_smoothing = 1e3;
  std::mt19937 random(8);
  for (int i = 0; i < 100; ++i) {
    Eigen::VectorXd q = random_vector(random, 7, 0.3);
    posed.set(q, random_vector(random, 7, 0.5));
    EXPECT_NEAR((posed.forces(sharp) - posed.forces(smooth)).norm(), 0.0, 1e-4 * (1.0 + posed.forces(sharp).norm()));
  }
}

}  // namespace
}  // namespace veridyn::muscle
