// What joints transmit where a loop is closed, and what its constraint does.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/simulation/pedalling.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/joint_reactions.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector2d;

Vector2d turned(double angle, const Vector2d& v) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

/// Of a vector that turns: its second derivative.
Vector2d turning(double angle, double speed, double acceleration, const Vector2d& v) {
  return turned(angle, acceleration * Vector2d(-v.y(), v.x()) - speed * speed * v);
}

/// The example's leg in a forward simulation, and the same motion given by splines through its angles.
struct Pedalling {
  MusculoskeletalSystem system{test::pedals()};
  MuscleTrajectory forward = test::pedalling(system, 1e-10);
  Motion motion = test::motion_of(forward, system.model());
  MotionAnalysis given = analyse_motion(system, motion, system.model().default_pose(), forward.time);
  estimation::RowMatrix none;

  [[nodiscard]] JointReactions of_given_motion() const {
    return joint_reactions(system,
                           {.time = given.time,
                            .q = given.q,
                            .qdot = given.qdot,
                            .qddot = given.qddot,
                            .tendon_force = forward.tendon_force,
                            .reserve = none},
                           ReactionFrame::kGround);
  }
};

TEST(LoopReactions, OfAGivenMotionAreThoseOfTheSimulationThatMadeIt) {
  const Pedalling p;
  ASSERT_TRUE(p.forward.usable()) << p.forward.message();
  const JointReactions simulated = joint_reactions(p.system,
                                                   {.time = p.forward.time,
                                                    .q = p.forward.q,
                                                    .qdot = p.forward.qdot,
                                                    .qddot = p.none,
                                                    .tendon_force = p.forward.tendon_force,
                                                    .reserve = p.none},
                                                   ReactionFrame::kGround);
  const JointReactions given = p.of_given_motion();
  const double largest = simulated.force.cwiseAbs().maxCoeff();
  EXPECT_GT(largest, 500.0);
  // Splines through samples know least at their ends, and where the excitation bends.
  double worst = 0.0;
  for (Eigen::Index i = 10; i + 10 < given.force.rows(); ++i) {
    if (i % 50 <= 5 || i % 50 >= 45) continue;
    worst = std::max({worst, (given.force.row(i) - simulated.force.row(i)).cwiseAbs().maxCoeff(),
                      (given.moment.row(i) - simulated.moment.row(i)).cwiseAbs().maxCoeff()});
  }
  EXPECT_LT(worst, 1e-6 * largest);
}

// What the axle bears of the crank says what the foot does to it; the shank has to be in balance with that.
TEST(LoopReactions, BodiesBesideTheLoopAreInBalance) {
  const Pedalling p;
  const JointReactions r = p.of_given_motion();
  const double g = 9.80665, crank_mass = 3.0, shank_mass = 4.3, shank_inertia = 0.15;
  const Vector2d knee_in_thigh(0.0, -0.43), centre(0.0, -0.26), pedal(0.0, -0.48), tuberosity(0.042, -0.05),
      patella(0.055, -0.41);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < p.given.q.rows(); i += 5) {
    const double hip = p.given.q(i, 0), shank = hip + p.given.q(i, 1), hip_w = p.given.qdot(i, 0),
                 shank_w = hip_w + p.given.qdot(i, 1), hip_a = p.given.qddot(i, 0),
                 shank_a = hip_a + p.given.qddot(i, 1);
    const Vector2d on_pedal = Vector2d(0.0, -crank_mass * g) + Vector2d(r.force(i, 6), r.force(i, 7));
    const Vector2d at_knee(r.force(i, 3), r.force(i, 4));
    const Vector2d pull =
        (turned(hip, patella - knee_in_thigh) - turned(shank, tuberosity)).normalized() * p.forward.tendon_force(i, 0);
    const Vector2d acceleration = turning(hip, hip_w, hip_a, knee_in_thigh) + turning(shank, shank_w, shank_a, centre);
    const Vector2d sum = at_knee + pull + on_pedal - Vector2d(0.0, shank_mass * g);
    largest = std::max(largest, on_pedal.norm());
    EXPECT_LT((sum - shank_mass * acceleration).norm(), 1e-8 * (1.0 + pull.norm())) << i;
    // Moments about the centre of mass; the knee is the shank's origin and a hinge.
    const auto moment = [&](const Vector2d& at, const Vector2d& force) {
      const Vector2d lever = turned(shank, at - centre);
      return lever.x() * force.y() - lever.y() * force.x();
    };
    EXPECT_NEAR(moment(Vector2d::Zero(), at_knee) + moment(tuberosity, pull) + moment(pedal, on_pedal) + r.moment(i, 5),
                shank_inertia * shank_a, 1e-7 * (1.0 + pull.norm()))
        << i;
  }
  EXPECT_GT(largest, 100.0);
}

// Without muscles the joints bear the generalised forces that the analysis reports, each about its axis.
TEST(LoopReactions, WithoutMusclesHaveTheLeastMoments) {
  const Pedalling p;
  const JointReactions r = joint_reactions(p.system,
                                           {.time = p.given.time,
                                            .q = p.given.q,
                                            .qdot = p.given.qdot,
                                            .qddot = p.given.qddot,
                                            .tendon_force = p.none,
                                            .reserve = p.none,
                                            .external = nullptr,
                                            .passive = false},
                                           ReactionFrame::kGround);
  for (Eigen::Index i = 0; i < p.given.q.rows(); i += 5)
    for (Eigen::Index c = 0; c < 3; ++c) EXPECT_NEAR(r.moment(i, 3 * c + 2), p.given.moment(i, c), 1e-9) << i;
}

}  // namespace
}  // namespace veridyn::muscle
