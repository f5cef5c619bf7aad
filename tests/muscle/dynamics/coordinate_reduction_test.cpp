#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <filesystem>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/integrate_adaptive.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

numerics::PiecewisePolynomial spline(double size, RandomStream& random) {
  const std::array<double, 6> x{-2.0, -1.1, -0.3, 0.4, 1.2, 2.0};
  std::array<double, 6> y{};
  for (double& value : y) value = random.uniform(-size, size);
  return numerics::PiecewisePolynomial::simm_spline(x, y);
}

CoordinateCoupler coupler(int independent, int dependent, numerics::PiecewisePolynomial function) {
  return {fmt::format("couple{}", dependent), independent, dependent, std::move(function)};
}

/// A tree of at least ten coordinates: 1 follows 4, 6 follows 1, 8 follows 7; 3 is locked, 7 prescribed.
struct ConstrainedTree {
  Model model;
  std::vector<int> prescribed{7};

  explicit ConstrainedTree(RandomStream& random) {
    do {
      model = test::random_tree(9, random);
    } while (model.coordinates.size() < 10);
    model.coordinates[3].locked = true;
    model.coordinates[3].default_value = 0.3;
    model.couplers.push_back(coupler(1, 6, spline(0.8, random)));
    model.couplers.push_back(coupler(4, 1, spline(0.8, random)));
    model.couplers.push_back(coupler(7, 8, spline(0.8, random)));
  }
};

template <typename Scalar>
std::vector<DrivenMotion<Scalar>> drive(const CoordinateReduction& reduction) {
  std::vector<DrivenMotion<Scalar>> motion;
  for (const DrivenMotion<double>& m : reduction.default_motion()) {
    motion.push_back({Scalar(m.value), Scalar(m.speed), Scalar(m.acceleration)});
  }
  motion.back() = {Scalar(0.2), Scalar(-1.1), Scalar(2.5)};
  return motion;
}

TEST(CoordinateReduction, SortsCoordinatesByWhoDecides) {
  RandomStream random(31, "roles");
  const ConstrainedTree tree(random);
  const CoordinateReduction reduction(tree.model, tree.prescribed);
  EXPECT_EQ(reduction.role(0), CoordinateRole::kFree);
  EXPECT_EQ(reduction.role(1), CoordinateRole::kCoupled);
  EXPECT_EQ(reduction.role(3), CoordinateRole::kDriven);
  EXPECT_EQ(reduction.role(7), CoordinateRole::kDriven);
  EXPECT_THAT(std::vector<int>(reduction.driven().begin(), reduction.driven().end()), testing::ElementsAre(3, 7));
  EXPECT_EQ(reduction.free().size(), tree.model.coordinates.size() - 5);
  const auto z_of_4 = static_cast<std::size_t>(reduction.free_root(6));
  EXPECT_EQ(reduction.free()[z_of_4], 4);
  EXPECT_EQ(reduction.free_root(8), -1);
  EXPECT_FALSE(reduction.all_free());
  EXPECT_DOUBLE_EQ(reduction.default_motion()[0].value, 0.3);
  EXPECT_TRUE(CoordinateReduction(test::pendulum(3)).all_free());
}

TEST(CoordinateReduction, SpeedsAndBiasesAreTimeDerivativesThroughTheCouplers) {
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(32, "expand");
  for (int trial = 0; trial < 10; ++trial) {
    const ConstrainedTree tree(random);
    const CoordinateReduction reduction(tree.model, tree.prescribed);
    const std::size_t n = reduction.free().size();
    const Eigen::VectorXd z = test::random_state(n, 1.0, random), zdot = test::random_state(n, 2.0, random);
    std::vector<DrivenMotion<Jet>> driven = drive<Jet>(reduction);
    for (DrivenMotion<Jet>& m : driven) {
      m.value.v[0] = m.speed.a;
      m.speed.v[0] = m.acceleration.a;
    }
    Eigen::Matrix<Jet, Eigen::Dynamic, 1> zj = z.cast<Jet>(), zdotj = zdot.cast<Jet>();
    for (Eigen::Index i = 0; i < z.size(); ++i) zj(i).v[0] = zdot(i);
    ExpandedState<Jet> state(reduction.coordinates());
    expand(reduction, zj.data(), zdotj.data(), driven.data(), state);
    for (int c = 0; c < reduction.coordinates(); ++c) {
      EXPECT_NEAR(state.q(c).v[0], state.qdot(c).a, 1e-13) << c;
      EXPECT_NEAR(state.qdot(c).v[0], state.bias(c).a, 1e-12) << c;
    }
  }
}

// The same accelerations from the other formulation: all coordinates, constraints with multipliers.
// With couplers among the free coordinates, and without (where the tree's own factorisation is used).
TEST(ReducedDynamics, IsTheSolutionWithLagrangeMultipliers) {
  RandomStream random(33, "multipliers");
  for (int trial = 0; trial < 30; ++trial) {
    ConstrainedTree tree(random);
    if (trial % 2 == 1) tree.model.couplers.erase(tree.model.couplers.begin(), tree.model.couplers.begin() + 2);
    const Mechanism mechanism(tree.model);
    const CoordinateReduction reduction(tree.model, tree.prescribed);
    ASSERT_EQ(reduction.free_are_uncoupled(), trial % 2 == 1);
    ReducedDynamics<double> reduced(mechanism, reduction);
    const std::size_t nz = reduction.free().size();
    const Eigen::VectorXd z = test::random_state(nz, 1.0, random), zdot = test::random_state(nz, 2.0, random);
    const std::vector<DrivenMotion<double>> driven = drive<double>(reduction);
    const auto n = static_cast<Eigen::Index>(mechanism.coordinates());
    const Eigen::VectorXd tau = test::random_state(static_cast<std::size_t>(n), 10.0, random);
    std::vector<SpatialVector<double>> applied(static_cast<std::size_t>(mechanism.links()));
    for (auto& f : applied) f = {test::random_vector(2.0, random), test::random_vector(10.0, random)};
    reduced.set_state(z.data(), zdot.data(), driven.data());
    Eigen::VectorXd zddot(z.size());
    ASSERT_TRUE(reduced.forward_dynamics(tau.data(), applied.data(), zddot.data()).usable());
    const Eigen::VectorXd qddot = reduced.qddot();

    Dynamics<double> d(mechanism);
    const Eigen::VectorXd& q = reduced.state().q;
    const Eigen::VectorXd& qdot = reduced.state().qdot;
    d.set_state(q.data(), qdot.data());
    Eigen::MatrixXd M;
    d.mass_matrix(M);
    Eigen::VectorXd h(n);
    d.inverse_dynamics(nullptr, applied.data(), h.data());
    const auto couplers = static_cast<Eigen::Index>(tree.model.couplers.size()), constraints = couplers + 2;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(constraints, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(constraints);
    for (Eigen::Index i = 0; i < couplers; ++i) {
      const CoordinateCoupler& c = tree.model.couplers[i];
      const numerics::FunctionValue<double> f = c.function.evaluate(q(c.independent));
      ASSERT_NEAR(q(c.dependent), f.value, 1e-15);
      A(i, c.dependent) = 1.0;
      A(i, c.independent) = -f.slope;
      b(i) = f.curvature * qdot(c.independent) * qdot(c.independent);
    }
    for (Eigen::Index i = 0; i < 2; ++i) {
      A(couplers + i, reduction.driven()[i]) = 1.0;
      b(couplers + i) = driven[i].acceleration;
    }
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + constraints, n + constraints);
    K.topLeftCorner(n, n) = M;
    K.topRightCorner(n, constraints) = -A.transpose();
    K.bottomLeftCorner(constraints, n) = A;
    Eigen::VectorXd right(n + constraints);
    right << tau - h, b;
    const Eigen::VectorXd solution = K.fullPivLu().solve(right);
    EXPECT_LT((solution.head(n) - qddot).norm(), 1e-9 * qddot.norm()) << "trial " << trial;
  }
}

TEST(ReducedDynamics, ACoupledTranslationIsASplineJoint) {
  RandomStream random(34, "knee");
  Model knee;
  knee.bodies.resize(1);
  test::add_body(knee, random);
  test::add_joint(knee, test::TreeJoint::kPlanar, 0, 1, random);
  // One model: the rotation drives the two translations by couplers. The other: by the joint's own functions.
  const numerics::PiecewisePolynomial x = spline(0.1, random), y = spline(0.1, random);
  Model coupled = knee, built_in = knee;
  for (Model* model : {&coupled, &built_in}) {
    for (TransformAxis& axis : model->joints[0].translation) {
      if (axis.coordinate >= 0) axis.function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
    }
  }
  coupled.couplers = {coupler(0, 1, x), coupler(0, 2, y)};
  built_in.joints[0].translation[0].coordinate = built_in.joints[0].translation[1].coordinate = 0;
  built_in.joints[0].translation[0].function = x;
  built_in.joints[0].translation[1].function = y;
  built_in.joints[0].coordinates.resize(1);
  built_in.coordinates.resize(1);
  const Mechanism coupled_mechanism(coupled), built_in_mechanism(built_in);
  const CoordinateReduction reduction(coupled);
  ReducedDynamics<double> reduced(coupled_mechanism, reduction);
  Dynamics<double> direct(built_in_mechanism);
  for (const double q : {-0.9, -0.2, 0.5, 1.4}) {
    const double speed = 1.7;
    const Eigen::Vector3d tau(2.0, 0.0, 0.0);
    double a = 0.0, b = 0.0;
    reduced.set_state(&q, &speed, nullptr);
    ASSERT_TRUE(reduced.forward_dynamics(tau.data(), nullptr, &a).usable());
    direct.set_state(&q, &speed);
    ASSERT_TRUE(direct.forward_dynamics(tau.data(), nullptr, &b).usable());
    EXPECT_NEAR(a, b, 1e-12 * std::abs(b));
  }
}

TEST(ReducedDynamics, ALockedCoordinateIsAWeld) {
  Model locked = test::pendulum(3), welded = test::pendulum(3);
  locked.coordinates[1].locked = true;
  locked.coordinates[1].default_value = 0.6;
  welded.joints[1].rotation[0].coordinate = -1;
  welded.joints[1].rotation[0].function = numerics::PiecewisePolynomial::constant(0.6);
  welded.joints[1].coordinates.clear();
  welded.coordinates.erase(welded.coordinates.begin() + 1);
  welded.joints[2].rotation[0].coordinate = 1;
  welded.joints[2].coordinates = {1};
  const Mechanism locked_mechanism(locked), welded_mechanism(welded);
  ASSERT_EQ(welded_mechanism.links(), 3);
  const CoordinateReduction reduction(locked);
  ReducedDynamics<double> reduced(locked_mechanism, reduction);
  Dynamics<double> direct(welded_mechanism);
  const Eigen::Vector2d z(0.3, -0.4), zdot(1.0, 2.0), tau2(3.0, -1.0);
  const Eigen::Vector3d tau3(3.0, 77.0, -1.0);  // a force on a locked coordinate counts for nothing
  Eigen::Vector2d a, b;
  reduced.set_state(z.data(), zdot.data(), reduction.default_motion().data());
  ASSERT_TRUE(reduced.forward_dynamics(tau3.data(), nullptr, a.data()).usable());
  direct.set_state(z.data(), zdot.data());
  ASSERT_TRUE(direct.forward_dynamics(tau2.data(), nullptr, b.data()).usable());
  EXPECT_LT((a - b).norm(), 1e-12 * b.norm());
}

TEST(ReducedDynamics, EnergyStaysInTenSecondsWithCouplers) {
  Model model = test::pendulum(4);
  model.couplers.push_back(coupler(0, 2, numerics::PiecewisePolynomial::linear(-0.8, 0.1)));
  // Strong enough to matter, smooth within the motion.
  const std::array<double, 4> quartic{0.0, 0.3, 0.4, -0.2};
  model.couplers.push_back(coupler(1, 3, numerics::PiecewisePolynomial::polynomial(quartic)));
  const Mechanism mechanism(model);
  const CoordinateReduction reduction(model);
  ReducedDynamics<double> reduced(mechanism, reduction);
  const Eigen::Vector4d tau = Eigen::Vector4d::Zero(), start(0.9, 0.3, 0.0, 0.0);
  double first = 0.0, worst = 0.0, largest = 0.0;
  bool started = false;
  const auto result = numerics::integrate_adaptive(
      [&](double, const Eigen::VectorXd& x, Eigen::VectorXd& rate) {
        reduced.set_state(x.data(), x.data() + 2, nullptr);
        rate.head<2>() = x.tail<2>();
        (void)reduced.forward_dynamics(tau.data(), nullptr, rate.data() + 2);
      },
      start, 0.0, 10.0, {.absolute_tolerance = 1e-12, .relative_tolerance = 1e-12},
      [&](double, const Eigen::VectorXd& x) {
        reduced.set_state(x.data(), x.data() + 2, nullptr);
        const double kinetic = reduced.dynamics().kinetic_energy();
        const double energy = kinetic + reduced.dynamics().potential_energy();
        if (!started) first = energy;
        started = true;
        worst = std::max(worst, std::abs(energy - first));
        largest = std::max(largest, kinetic);
      });
  EXPECT_TRUE(result.usable());
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(worst, 1e-8 * largest);
}

TEST(ReducedDynamics, NamesTheFreeCoordinateWithoutInertia) {
  Model model = test::pendulum(3);
  model.coordinates[0].locked = true;
  model.bodies[3].mass = 0.0;
  model.bodies[3].inertia.setZero();
  const Mechanism mechanism(model);
  const CoordinateReduction reduction(model);
  ReducedDynamics<double> reduced(mechanism, reduction);
  const Eigen::Vector2d z(0.1, 0.2), zdot(0.0, 0.0);
  Eigen::Vector2d zddot;
  const Eigen::Vector3d tau(0.0, 0.0, 0.0);
  reduced.set_state(z.data(), zdot.data(), reduction.default_motion().data());
  EXPECT_EQ(reduced.forward_dynamics(tau.data(), nullptr, zddot.data()).singular_coordinate, 2);
}

std::string message_of(const Model& model, std::vector<int> prescribed = {}) {
  try {
    const CoordinateReduction reduction(model, prescribed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CoordinateReduction, NamesContradictions) {
  using testing::AllOf;
  using testing::HasSubstr;
  const numerics::PiecewisePolynomial f = numerics::PiecewisePolynomial::linear(2.0, 0.0);
  Model circle = test::pendulum(4);
  circle.couplers = {coupler(1, 2, f), coupler(2, 1, f), coupler(2, 0, f)};
  EXPECT_THAT(message_of(circle), AllOf(testing::ContainsRegex("coordinate 'q[12]'"), HasSubstr("depend on itself")));
  Model twice = test::pendulum(4);
  twice.couplers = {coupler(1, 2, f), coupler(3, 2, f)};
  EXPECT_THAT(message_of(twice), AllOf(HasSubstr("'q2'"), HasSubstr("both set it")));
  Model locked = test::pendulum(4);
  locked.couplers = {coupler(1, 2, f)};
  EXPECT_THAT(message_of(locked, {2}), AllOf(HasSubstr("'q2'"), HasSubstr("prescribed"), HasSubstr("couple2")));
  locked.coordinates[2].locked = true;
  EXPECT_THAT(message_of(locked), AllOf(HasSubstr("'q2'"), HasSubstr("locked")));
}

// Every model in circulation that we have must be simulated in its default pose.
TEST(ReducedDynamics, RunsEveryModelOfOpenSimThatWeHave) {
  const std::filesystem::path folder = veridyn::test::shared_folder().string() + "/data/opensim";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  int models = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".osim") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const Model model = read_osim(entry.path());
    const Mechanism mechanism(model);
    const CoordinateReduction reduction(model);
    ReducedDynamics<double> reduced(mechanism, reduction);
    const Eigen::VectorXd pose = model.default_pose();
    Eigen::VectorXd z(reduction.free().size());
    for (Eigen::Index i = 0; i < z.size(); ++i) z(i) = pose(reduction.free()[i]);
    Eigen::VectorXd zddot(z.size());
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(mechanism.coordinates());
    reduced.set_state(z.data(), zero.data(), reduction.default_motion().data());
    const Factorization f = reduced.forward_dynamics(zero.data(), nullptr, zddot.data());
    EXPECT_TRUE(f.usable()) << model.coordinates[static_cast<std::size_t>(std::max(0, f.singular_coordinate))].name;
    EXPECT_TRUE(zddot.allFinite());
    ++models;
  }
  EXPECT_GE(models, 10);
}

}  // namespace
}  // namespace veridyn::muscle
