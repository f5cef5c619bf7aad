#include "veridyn/muscle/simulation/assembly.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

double energy_at(const MusculoskeletalSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
  Dynamics<double> dynamics(system.mechanism());
  dynamics.set_state(q.data(), qdot.data());
  return dynamics.kinetic_energy() + dynamics.potential_energy();
}

/// Largest error of the loops at a pose.
double open_by(const MusculoskeletalSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
  Kinematics<double> kinematics(system.mechanism());
  update_positions(system.mechanism(), q.data(), kinematics);
  update_velocities(system.mechanism(), qdot.data(), kinematics);
  std::vector<LoopRow<double>> rows(static_cast<std::size_t>(system.loops().rows()));
  system.loops().evaluate(kinematics, rows.data());
  double largest = 0.0;
  for (const LoopRow<double>& row : rows) largest = std::max({largest, std::abs(row.error), std::abs(row.rate)});
  return largest;
}

MuscleTrajectory simulated(const MusculoskeletalSystem& system, const StartState& start, double end, double accuracy) {
  Progress progress;
  return simulate_forward(system, start, {ControlSignals(std::vector<double>{}), {}},
                          {.end = end, .rate_Hz = 100.0, .accuracy = accuracy}, progress);
}

StartState started_at(const MusculoskeletalSystem& system, const Eigen::VectorXd& q) {
  StartState start = default_start(system.model());
  start.q = q;
  return start;
}

TEST(Assembly, ClosesAFourBarLinkage) {
  const MusculoskeletalSystem system(test::four_bar());
  const Eigen::Vector3d open(0.5, 1.0, 0.2), speed(2.0, 0.0, 0.0);
  const Assembly closed = assemble(system, open, speed);
  EXPECT_LT(open_by(system, closed.q, closed.qdot), 1e-12);
  EXPECT_GE(closed.moved, 0);
  EXPECT_THAT(assembly_text(system, closed), testing::HasSubstr("to close the model's loops 'q"));
  // Nothing to do: nothing done.
  const Assembly same = assemble(system, closed.q, closed.qdot);
  EXPECT_LT((same.q - closed.q).norm(), 1e-12);
  EXPECT_LT((same.qdot - closed.qdot).norm(), 1e-11);
  EXPECT_EQ(assembly_text(system, same), "");
  // Freudenstein's equation of the linkage, angles from the line of its fixed pins.
  const double crank = closed.q(0) - std::numbers::pi / 2, rocker = closed.q(2) - std::numbers::pi / 2;
  const double a = 0.3, b = 0.5, c = 0.4, d = 0.6;
  EXPECT_NEAR(d / a * std::cos(rocker) - d / c * std::cos(crank) + (a * a - b * b + c * c + d * d) / (2 * a * c),
              std::cos(crank - rocker), 1e-11);
}

TEST(Assembly, LoopsThatCannotCloseAreNamed) {
  Model model = test::four_bar();
  model.loops[0].frame_1.translation.x() = 3.0;
  const MusculoskeletalSystem system(model);
  try {
    static_cast<void>(assemble(system, Eigen::Vector3d(0.5, 1.0, 0.2), Eigen::Vector3d::Zero()));
    FAIL() << "closed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("PointConstraint 'hinge' stays "),
                                             testing::HasSubstr("open; start nearer to one")));
  }
}

TEST(Loops, AFourBarLinkageKeepsItsEnergyAndStaysClosed) {
  const MusculoskeletalSystem system(test::four_bar());
  const MuscleTrajectory t = simulated(system, started_at(system, Eigen::Vector3d(1.2, 0.4, 0.6)), 10.0, 1e-8);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  const double first = energy_at(system, t.q.row(0).transpose(), t.qdot.row(0).transpose());
  double worst = 0.0, open = 0.0, fastest = 0.0;
  for (Eigen::Index i = 0; i < t.q.rows(); ++i) {
    const Eigen::VectorXd q = t.q.row(i), qdot = t.qdot.row(i);
    worst = std::max(worst, std::abs(energy_at(system, q, qdot) - first));
    open = std::max(open, open_by(system, q, qdot));
    fastest = std::max(fastest, qdot.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(fastest, 1.0);
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(open, 1e-6);
}

/// A mass on two crossed sliders; a distance constraint makes it a pendulum.
Model held_mass(double length) {
  numerics::RandomStream random(5, "mass");
  Model model;
  model.bodies.resize(1);
  model.bodies[0].name = "ground";
  const int mass = test::add_body(model, random);
  test::add_joint(model, test::TreeJoint::kPlanar, 0, mass, random);
  Joint& joint = model.joints[0];
  joint.parent_frame = joint.child_frame = {};
  for (int i = 1; i < 3; ++i)
    joint.translation[static_cast<std::size_t>(i - 1)].function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
  model.bodies[1].mass_center.setZero();
  model.coordinates[0].locked = true;
  for (Coordinate& c : model.coordinates) {
    c.low = -10.0;
    c.high = 10.0;
  }
  model.loops.push_back({.name = "rod", .kind = LoopKind::kDistance, .body_1 = 0, .body_2 = 1, .distance = length});
  return model;
}

TEST(Loops, AMassAtADistanceIsAPendulum) {
  const double length = 0.7, amplitude = 2.0;
  const MusculoskeletalSystem system(held_mass(length));
  // The period of a pendulum: 4 sqrt(L/g) K(sin(amplitude/2)).
  const double g = -system.model().gravity.y();
  const double period = 4.0 * std::sqrt(length / g) * std::comp_ellint_1(std::sin(0.5 * amplitude));
  const Eigen::Vector3d q0(0.0, length * std::sin(amplitude), -length * std::cos(amplitude));
  const MuscleTrajectory t = simulated(system, started_at(system, q0), period, 1e-9);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  EXPECT_NEAR(t.final_state(0), q0(1), 1e-7);
  EXPECT_NEAR(t.final_state(1), q0(2), 1e-7);
  for (Eigen::Index i = 0; i < t.q.rows(); ++i) EXPECT_NEAR(std::hypot(t.q(i, 1), t.q(i, 2)), length, 1e-8);
}

TEST(Loops, AWeldConstraintIsALockedJoint) {
  Model locked = test::pendulum(2), welded = test::pendulum(2);
  for (Model* model : {&locked, &welded}) {
    for (Coordinate& c : model->coordinates) {
      c.low = -10.0;
      c.high = 10.0;
    }
  }
  locked.coordinates[1].locked = true;
  locked.coordinates[1].default_value = 0.4;
  welded.loops.push_back({.name = "weld",
                          .kind = LoopKind::kWeld,
                          .body_1 = 1,
                          .body_2 = 2,
                          .frame_1 = {.rotation = body_fixed_xyz({0.0, 0.0, 0.4}), .translation = {0.0, -0.5, 0.0}},
                          .frame_2 = {}});
  const MusculoskeletalSystem one(locked), two(welded);
  const MuscleTrajectory a = simulated(one, started_at(one, Eigen::Vector2d(1.5, 0.4)), 2.0, 1e-9);
  const MuscleTrajectory b = simulated(two, started_at(two, Eigen::Vector2d(1.5, 0.7)), 2.0, 1e-9);
  // Assembly changed both angles of the second; start from where it began.
  const MuscleTrajectory c = simulated(two, started_at(two, Eigen::Vector2d(1.5, 0.4)), 2.0, 1e-9);
  ASSERT_EQ(b.end, MotionEnd::kCompleted);
  EXPECT_NEAR(b.q(0, 1), 0.4, 1e-12);
  ASSERT_EQ(a.q.rows(), c.q.rows());
  EXPECT_LT((a.q - c.q).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Loops, APointOnALineIsASlider) {
  // The planar mass held to the y axis falls freely.
  Model model = held_mass(1.0);
  model.loops[0] = {.name = "rail",
                    .kind = LoopKind::kPointOnLine,
                    .body_1 = 0,
                    .body_2 = 1,
                    .frame_1 = {.rotation = body_fixed_xyz({0.0, 0.0, 0.5 * std::numbers::pi})}};
  const MusculoskeletalSystem system(model);
  const MuscleTrajectory t = simulated(system, started_at(system, Eigen::Vector3d(0.0, 0.3, 2.0)), 0.5, 1e-9);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  EXPECT_NEAR(t.q(0, 1), 0.0, 1e-12) << "assembled on the line";
  EXPECT_NEAR(t.final_state(0), 0.0, 1e-10);
  EXPECT_NEAR(t.final_state(1), 2.0 + 0.5 * model.gravity.y() * 0.25, 1e-9);
}

TEST(Loops, DerivativesRefuseThemByName) {
  const MusculoskeletalSystem system(test::four_bar());
  try {
    static_cast<void>(SystemLinearization(system, {}, {}, 0));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("estimation) does not know closed loops, and PointConstraint 'hinge'"));
  }
}

}  // namespace
}  // namespace veridyn::muscle
