#include "veridyn/muscle/dynamics/dynamics.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "tests/support/integrate_adaptive.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

struct RandomCase {
  Model model;
  Mechanism mechanism;
  Eigen::VectorXd q, qdot, tau;
  explicit RandomCase(Model m, RandomStream& random)
      : model(std::move(m)),
        mechanism(model),
        q(test::random_state(model.coordinates.size(), 1.0, random)),
        qdot(test::random_state(model.coordinates.size(), 2.0, random)),
        tau(test::random_state(model.coordinates.size(), 10.0, random)) {}
};

/// Of forces on links: what the coordinates need less where these act.
Eigen::VectorXd generalized_forces(Dynamics<double>& d, const std::vector<SpatialVector<double>>& applied) {
  const int n = d.mechanism().coordinates();
  Eigen::VectorXd without(n), with(n);
  d.inverse_dynamics(nullptr, nullptr, without.data());
  d.inverse_dynamics(nullptr, applied.data(), with.data());
  return without - with;
}

TEST(Dynamics, ArticulatedBodiesAndFactorizedMassMatrixAgree) {
  RandomStream random(11, "routes");
  for (int trial = 0; trial < 50; ++trial) {
    const RandomCase c(test::random_tree(10, random), random);
    Dynamics<double> d(c.mechanism);
    d.set_state(c.q.data(), c.qdot.data());
    std::vector<SpatialVector<double>> applied(static_cast<std::size_t>(c.mechanism.links()));
    for (auto& f : applied) f = {test::random_vector(5.0, random), test::random_vector(20.0, random)};
    Eigen::VectorXd a(c.q.size()), b(c.q.size()), tau(c.q.size());
    ASSERT_TRUE(d.forward_dynamics_articulated(c.tau.data(), applied.data(), a.data()).usable());
    ASSERT_TRUE(d.forward_dynamics_factorized(c.tau.data(), applied.data(), b.data()).usable());
    EXPECT_LT((a - b).norm(), 1e-9 * a.norm()) << "trial " << trial;
    // There and back.
    d.inverse_dynamics(a.data(), applied.data(), tau.data());
    EXPECT_LT((tau - c.tau).norm(), 1e-9 * (c.tau.norm() + 1.0)) << "trial " << trial;
    // Forces on links are what their generalised forces are.
    const Eigen::VectorXd sum = c.tau + generalized_forces(d, applied);
    ASSERT_TRUE(d.forward_dynamics(sum.data(), nullptr, b.data()).usable());
    EXPECT_LT((a - b).norm(), 1e-9 * a.norm()) << "trial " << trial;
  }
}

TEST(Dynamics, GeneralizedForcesDoTheWorkOfTheForcesOnTheLinks) {
  RandomStream random(17, "power");
  for (int trial = 0; trial < 10; ++trial) {
    const RandomCase c(test::random_tree(8, random), random);
    Dynamics<double> d(c.mechanism);
    d.set_state(c.q.data(), c.qdot.data());
    std::vector<SpatialVector<double>> applied(static_cast<std::size_t>(c.mechanism.links()));
    double power = 0.0;
    for (std::size_t i = 1; i < applied.size(); ++i) {
      // A force at a point of the link: its moment is about the ground's origin.
      const Eigen::Vector3d point = d.kinematics().pose[i] * Eigen::Vector3d(0.1, -0.2, 0.3);
      applied[i].linear = test::random_vector(20.0, random);
      applied[i].angular = point.cross(applied[i].linear);
      power += applied[i].linear.dot(d.kinematics().velocity[i].at(point));
    }
    const Eigen::VectorXd tau = generalized_forces(d, applied);
    EXPECT_NEAR(tau.dot(c.qdot), power, 1e-12 * tau.norm() * c.qdot.norm());
  }
}

// Moments are about the ground's origin: what that costs in digits far away from it.
TEST(Dynamics, IsPreciseTenMetresFromTheOrigin) {
  RandomStream random(18, "far");
  Model near = test::arm26_skeleton(), far = near;
  far.joints[0].parent_frame.translation += Eigen::Vector3d(10.0, 0.0, -3.0);
  const RandomCase a(near, random);
  const Mechanism far_mechanism(far);
  Dynamics<double> d(a.mechanism), e(far_mechanism);
  d.set_state(a.q.data(), a.qdot.data());
  e.set_state(a.q.data(), a.qdot.data());
  Eigen::Vector2d near_qddot, far_qddot;
  ASSERT_TRUE(d.forward_dynamics(a.tau.data(), nullptr, near_qddot.data()).usable());
  ASSERT_TRUE(e.forward_dynamics(a.tau.data(), nullptr, far_qddot.data()).usable());
  EXPECT_LT((near_qddot - far_qddot).norm(), 1e-11 * near_qddot.norm());
}

TEST(Dynamics, MassMatrixIsThatOfTheKineticEnergyAndPositiveDefinite) {
  RandomStream random(12, "mass");
  for (int trial = 0; trial < 30; ++trial) {
    const RandomCase c(test::random_tree(9, random), random);
    Dynamics<double> d(c.mechanism);
    d.set_state(c.q.data(), c.qdot.data());
    Eigen::MatrixXd M;
    d.mass_matrix(M);
    EXPECT_NEAR(0.5 * c.qdot.dot(M * c.qdot), d.kinetic_energy(), 1e-12 * d.kinetic_energy());
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(M).info(), Eigen::Success);
    // Column by column from inverse dynamics, which knows nothing of composite bodies.
    Eigen::VectorXd h(c.q.size()), column(c.q.size());
    d.inverse_dynamics(nullptr, nullptr, h.data());
    for (Eigen::Index i = 0; i < c.q.size(); ++i) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(c.q.size(), i);
      d.inverse_dynamics(unit.data(), nullptr, column.data());
      EXPECT_LT((column - h - M.col(i)).norm(), 1e-11 * (M.norm() + h.norm()));
    }
  }
}

// h and gravity from the Lagrangian by automatic differentiation: tau = d/dt (dT/dqdot) - dT/dq + dU/dq.
TEST(Dynamics, InverseDynamicsIsLagranges) {
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(13, "lagrange");
  for (int trial = 0; trial < 10; ++trial) {
    const RandomCase c(test::random_tree(6, random), random);
    const auto n = c.q.size();
    const Eigen::VectorXd qddot = test::random_state(static_cast<std::size_t>(n), 5.0, random);
    Dynamics<Jet> d(c.mechanism);
    Dynamics<double> plain(c.mechanism);
    plain.set_state(c.q.data(), c.qdot.data());
    Eigen::VectorXd tau(n);
    plain.inverse_dynamics(qddot.data(), nullptr, tau.data());
    // dT/dqdot = M qdot as a Jet in time.
    Eigen::Matrix<Jet, Eigen::Dynamic, 1> q(n), qdot(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      q(i) = Jet(c.q(i));
      q(i).v[0] = c.qdot(i);
      qdot(i) = Jet(c.qdot(i));
      qdot(i).v[0] = qddot(i);
    }
    d.set_state(q.data(), qdot.data());
    Dynamics<Jet>::Matrix M;
    d.mass_matrix(M);
    const Eigen::Matrix<Jet, Eigen::Dynamic, 1> conjugate = M * qdot;
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::Matrix<Jet, Eigen::Dynamic, 1> at = c.q.cast<Jet>(), speed = c.qdot.cast<Jet>();
      at(i).v[0] = 1.0;
      d.set_state(at.data(), speed.data());
      const double expected = conjugate(i).v[0] - d.kinetic_energy().v[0] + d.potential_energy().v[0];
      EXPECT_NEAR(tau(i), expected, 1e-10 * (tau.norm() + 1.0)) << "coordinate " << i;
    }
  }
}

TEST(Dynamics, AutomaticDerivativesOfTheAccelerationsAreCentralDifferences) {
  using Jet = ceres::Jet<double, 4>;
  RandomStream random(14, "jets");
  const RandomCase c(test::random_tree(6, random), random);
  const auto n = c.q.size();
  Dynamics<double> d(c.mechanism);
  Dynamics<Jet> jets(c.mechanism);
  const auto accelerations = [&](double t, bool articulated) {
    Eigen::VectorXd q = c.q, qdot = c.qdot, tau = c.tau, qddot(n);
    q(0) += t;
    qdot(n - 1) += t;
    tau(n / 2) += t;
    d.set_state(q.data(), qdot.data());
    const Factorization f = articulated ? d.forward_dynamics_articulated(tau.data(), nullptr, qddot.data())
                                        : d.forward_dynamics(tau.data(), nullptr, qddot.data());
    EXPECT_TRUE(f.usable());
    return qddot;
  };
  Eigen::Matrix<Jet, Eigen::Dynamic, 1> q = c.q.cast<Jet>(), qdot = c.qdot.cast<Jet>(), tau = c.tau.cast<Jet>(),
                                        qddot(n);
  q(0).v[2] = 1.0;
  qdot(n - 1).v[2] = 1.0;
  tau(n / 2).v[2] = 1.0;
  jets.set_state(q.data(), qdot.data());
  for (const bool articulated : {false, true}) {
    if (articulated) {
      ASSERT_TRUE(jets.forward_dynamics_articulated(tau.data(), nullptr, qddot.data()).usable());
    } else {
      ASSERT_TRUE(jets.forward_dynamics(tau.data(), nullptr, qddot.data()).usable());
    }
    // Fourth-order differences; what is left is rounding / step.
    const double h = 1e-3;
    const auto f = [&](double t) { return accelerations(t, articulated); };
    const Eigen::VectorXd slope = (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
    const Eigen::VectorXd value = f(0.0);
    for (Eigen::Index i = 0; i < n; ++i) {
      EXPECT_NEAR(qddot(i).a, value(i), 1e-10 * value.norm());
      EXPECT_NEAR(qddot(i).v[2], slope(i), 1e-7 * (slope.norm() + value.norm()));
    }
  }
}

struct Drift {
  double relative = 0.0;
  bool reached = false;
};

/// Largest change of the total energy over 10 s without forces, relative to the largest kinetic energy.
Drift energy_drift(const Model& model, const Eigen::VectorXd& q0, const Eigen::VectorXd& qdot0) {
  const Mechanism mechanism(model);
  Dynamics<double> d(mechanism);
  const auto n = q0.size();
  const Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd start(2 * n);
  start << q0, qdot0;
  double first = 0.0, worst = 0.0, largest = 0.0;
  bool started = false;
  const auto result = numerics::integrate_adaptive(
      [&](double, const Eigen::VectorXd& x, Eigen::VectorXd& rate) {
        d.set_state(x.data(), x.data() + n);
        rate.head(n) = x.tail(n);
        (void)d.forward_dynamics(tau.data(), nullptr, rate.data() + n);
      },
      start, 0.0, 10.0, {.absolute_tolerance = 1e-12, .relative_tolerance = 1e-12},
      [&](double, const Eigen::VectorXd& x) {
        d.set_state(x.data(), x.data() + n);
        const double kinetic = d.kinetic_energy(), energy = kinetic + d.potential_energy();
        if (!started) first = energy;
        started = true;
        worst = std::max(worst, std::abs(energy - first));
        largest = std::max(largest, kinetic);
      });
  return {worst / largest, result.usable()};
}

TEST(Dynamics, EnergyStaysInTenSecondsOfADoubleAndATriplePendulum) {
  for (const int rods : {2, 3}) {
    const Drift drift =
        energy_drift(test::pendulum(rods), Eigen::VectorXd::Constant(rods, 1.2), Eigen::VectorXd::Zero(rods));
    EXPECT_TRUE(drift.reached);
    EXPECT_LT(drift.relative, 1e-8) << rods << " rods";
  }
}

TEST(Dynamics, EnergyStaysInASplineJointAndATree) {
  RandomStream random(15, "energy");
  Model knee;
  knee.bodies.resize(1);
  knee.bodies[0].name = "ground";
  for (int i = 0; i < 2; ++i) {
    const int parent = static_cast<int>(knee.bodies.size()) - 1;
    const int child = test::add_body(knee, random);
    test::add_joint(knee, i == 0 ? test::TreeJoint::kPin : test::TreeJoint::kSpline, parent, child, random);
  }
  const Drift spline = energy_drift(knee, Eigen::Vector2d(0.4, 0.3), Eigen::Vector2d(0.5, -0.4));
  EXPECT_TRUE(spline.reached);
  EXPECT_LT(spline.relative, 1e-8);

  Model tree;
  tree.bodies.resize(1);
  tree.bodies[0].name = "ground";
  const test::TreeJoint kinds[] = {test::TreeJoint::kPin, test::TreeJoint::kPin, test::TreeJoint::kUniversal};
  for (int i = 0; i < 3; ++i) {
    const int child = test::add_body(tree, random);
    test::add_joint(tree, kinds[i], i == 0 ? 0 : 1, child, random);
  }
  const Drift branches = energy_drift(tree, Eigen::Vector4d(0.3, -0.2, 0.2, 0.1), Eigen::Vector4d::Zero());
  EXPECT_TRUE(branches.reached);
  EXPECT_LT(branches.relative, 1e-8);
}

// A knee that hangs: its second angle and its translations depend on flexion and varus.
TEST(Dynamics, EnergyStaysInAJointOfFunctionsOfSeveralCoordinates) {
  Model knee;
  knee.gravity = {0.0, -9.81, 0.0};
  knee.bodies.resize(2);
  knee.bodies[1].mass = 3.0;
  knee.bodies[1].mass_center = {0.0, -0.3, 0.02};
  knee.bodies[1].inertia.diagonal() << 0.05, 0.01, 0.06;
  Joint joint;
  joint.name = "knee";
  joint.child = 1;
  joint.coordinates = {0, 1};
  for (int i = 0; i < 3; ++i) joint.translation[i].axis = Eigen::Vector3d::Unit(i);
  joint.rotation[0].axis = Eigen::Vector3d::UnitZ();
  joint.rotation[1].axis = Eigen::Vector3d::UnitX();
  joint.rotation[2].axis = Eigen::Vector3d::UnitY();
  joint.rotation[0].coordinate = 0;
  joint.rotation[0].function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
  const auto of_both = [](TransformAxis& axis, std::vector<double> coefficients) {
    axis.several = {0, 1};
    axis.function_of_several = {2, 2, std::move(coefficients)};
  };
  of_both(joint.rotation[1], {0.0, 1.0, 0.1, 0.2, 0.3, -0.2});
  of_both(joint.rotation[2], {0.0, 0.1, 0.2, -0.3, 0.2, 0.1});
  of_both(joint.translation[0], {0.01, 0.02, -0.05, 0.03, 0.08, 0.04});
  of_both(joint.translation[1], {-0.4, 0.01, 0.03, 0.02, -0.05, 0.06});
  knee.joints = {joint};
  knee.coordinates = {{.name = "flexion"}, {.name = "varus"}};
  const Drift drift = energy_drift(knee, Eigen::Vector2d(0.4, -0.2), Eigen::Vector2d(0.5, 0.3));
  EXPECT_TRUE(drift.reached);
  EXPECT_LT(drift.relative, 1e-8);
}

// Without anything outside, momentum stays; gravity adds its impulse, and its moment about the mass centre is zero.
TEST(Dynamics, MomentumOfAFloatingTreeChangesByTheOutsideForcesOnly) {
  RandomStream random(16, "momentum");
  for (int trial = 0; trial < 10; ++trial) {
    Model model;
    model.gravity = trial % 2 == 0 ? Eigen::Vector3d::Zero() : test::random_vector(9.0, random);
    model.bodies.resize(1);
    model.bodies[0].name = "ground";
    for (int i = 0; i < 6; ++i) {
      const int parent = i == 0 ? 0 : 1 + static_cast<int>(random.index(static_cast<std::uint64_t>(i)));
      const int child = test::add_body(model, random);
      const auto kind = static_cast<test::TreeJoint>(random.index(test::kTreeJoints));
      test::add_joint(model, i == 0 ? test::TreeJoint::kFree : kind, parent, child, random);
    }
    const RandomCase c(model, random);
    const auto n = c.q.size();
    Dynamics<double> d(c.mechanism);
    d.set_state(c.q.data(), c.qdot.data());
    // Inner forces only: none on the six coordinates of the free joint.
    Eigen::VectorXd tau = c.tau, qddot(n);
    tau.head(6).setZero();
    ASSERT_TRUE(d.forward_dynamics(tau.data(), nullptr, qddot.data()).usable());
    using Jet = ceres::Jet<double, 1>;
    Eigen::Matrix<Jet, Eigen::Dynamic, 1> q(n), qdot(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      q(i) = Jet(c.q(i));
      q(i).v[0] = c.qdot(i);
      qdot(i) = Jet(c.qdot(i));
      qdot(i).v[0] = qddot(i);
    }
    Dynamics<Jet> jets(c.mechanism);
    jets.set_state(q.data(), qdot.data());
    const SpatialVector<Jet> P = jets.momentum();
    double mass = 0.0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (std::size_t b = 1; b < model.bodies.size(); ++b) {
      mass += model.bodies[b].mass;
      moment += model.bodies[b].mass *
                (body_pose(c.mechanism, d.kinematics(), static_cast<int>(b)) * model.bodies[b].mass_center);
    }
    const Eigen::Vector3d torque = moment.cross(model.gravity);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(P.linear(i).v[0], mass * model.gravity(i), 1e-9 * (1.0 + c.tau.norm()));
      EXPECT_NEAR(P.angular(i).v[0], torque(i), 1e-9 * (1.0 + c.tau.norm()));
    }
  }
}

TEST(Dynamics, NamesTheCoordinateAlongWhichNothingHasInertia) {
  Model model = test::pendulum(3);
  model.bodies[3].mass = 0.0;
  model.bodies[3].inertia.setZero();
  const Mechanism mechanism(model);
  Dynamics<double> d(mechanism);
  const Eigen::Vector3d q(0.1, 0.2, 0.3), qdot(1.0, 1.0, 1.0), tau(1.0, 1.0, 1.0);
  Eigen::Vector3d qddot;
  d.set_state(q.data(), qdot.data());
  EXPECT_EQ(d.forward_dynamics_factorized(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  EXPECT_EQ(d.forward_dynamics_articulated(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  // A point mass on the axis: nothing but rounding stands on the diagonal.
  model.bodies[3].mass = 2.0;
  model.bodies[3].mass_center.setZero();
  const Mechanism on_axis(model);
  Dynamics<double> e(on_axis);
  e.set_state(q.data(), qdot.data());
  EXPECT_EQ(e.forward_dynamics_factorized(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  EXPECT_EQ(e.forward_dynamics_articulated(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  // A coordinate of a joint that no axis uses.
  Model idle = test::pendulum(3);
  idle.joints[2].rotation[0].function = numerics::PiecewisePolynomial::constant(0.4);
  const Mechanism stuck(idle);
  Dynamics<double> s(stuck);
  s.set_state(q.data(), qdot.data());
  EXPECT_EQ(s.forward_dynamics_factorized(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  EXPECT_EQ(s.forward_dynamics_articulated(tau.data(), nullptr, qddot.data()).singular_coordinate, 2);
  // A massless link between massive ones is fine: OpenSim's knees have them.
  Model between = test::pendulum(3);
  between.bodies[2].mass = 0.0;
  between.bodies[2].inertia.setZero();
  const Mechanism middle(between);
  Dynamics<double> f(middle);
  f.set_state(q.data(), qdot.data());
  EXPECT_TRUE(f.forward_dynamics_factorized(tau.data(), nullptr, qddot.data()).usable());
}

}  // namespace
}  // namespace veridyn::muscle
