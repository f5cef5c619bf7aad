#include "veridyn/muscle/dynamics/external_forces.hpp"

#include <gtest/gtest.h>

#include <random>

#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

/// The legs in random poses.
struct PosedLegs {
  Model model = load_model("legs").model();
  Mechanism mechanism{model};
  Kinematics<double> kinematics{mechanism};
  void set(const Eigen::VectorXd& q) { update_positions(mechanism, q.data(), kinematics); }
};

Eigen::Vector3d random_point(std::mt19937& random, double scale) {
  std::uniform_real_distribution<double> u(-scale, scale);
  return {u(random), u(random), u(random)};
}

TEST(ExternalForces, DoTheWorkOfTheirPointWhateverTheFrames) {
  PosedLegs posed;
  std::mt19937 random(3);
  const Eigen::Index n = posed.mechanism.coordinates();
  for (const char* force_frame : {"ground", "tibia_r", "foot_r"}) {
    for (const char* point_frame : {"ground", "tibia_r", "foot_r"}) {
      SCOPED_TRACE(std::string(force_frame) + " " + point_frame);
      ExternalLoadSource source{.name = "l", .place = "p", .body = "foot_r", .force_frame = force_frame};
      source.point_frame = point_frame;
      source.constant_force = random_point(random, 100.0);
      source.constant_point = random_point(random, 0.5);
      source.has_constant_point = true;
      ExternalLoads loads;
      add_external_loads({&source, 1}, nullptr, posed.model, 0.0, loads);
      Eigen::VectorXd q = posed.model.default_pose();
      for (double& x : q) x += random_point(random, 0.4).x();
      posed.set(q);
      Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
      add_external_forces(loads, 0.0, posed.mechanism, posed.kinematics, tau.data());
      // The point where the force acts now, as a point of the foot; the force as it is now, in ground.
      const auto place = [&](const char* body) {
        return body_pose(posed.mechanism, posed.kinematics, posed.model.body(body));
      };
      const Eigen::Vector3d force = place(force_frame).rotation * source.constant_force;
      const Eigen::Vector3d in_ground = place(point_frame) * source.constant_point;
      const Pose<double> foot = place("foot_r");
      const Eigen::Vector3d in_foot = foot.rotation.transpose() * (in_ground - foot.position);
      for (Eigen::Index c = 0; c < n; ++c) {
        constexpr double kStep = 1e-6;
        Eigen::VectorXd q1 = q, q2 = q;
        q1(c) -= kStep;
        q2(c) += kStep;
        posed.set(q2);
        const Eigen::Vector3d after = place("foot_r") * in_foot;
        posed.set(q1);
        const Eigen::Vector3d before = place("foot_r") * in_foot;
        // Central differences: h^2 and 1e-16/h, of forces of 100 N.
        EXPECT_NEAR(tau(c), force.dot(after - before) / (2.0 * kStep), 1e-6) << c;
      }
    }
  }
}

TEST(ExternalForces, ATorqueWorksOnRotationsOnly) {
  PosedLegs posed;
  ExternalLoadSource source{.name = "l", .place = "p", .body = "pelvis"};
  source.constant_moment = {1.0, 2.0, 3.0};
  ExternalLoads loads;
  add_external_loads({&source, 1}, nullptr, posed.model, 0.0, loads);
  posed.set(posed.model.default_pose());
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(posed.mechanism.coordinates());
  add_external_forces(loads, 0.0, posed.mechanism, posed.kinematics, tau.data());
  EXPECT_NEAR(tau(posed.model.coordinate("pelvis_tilt")), 3.0, 1e-12);
  EXPECT_NEAR(tau(posed.model.coordinate("pelvis_ty")), 0.0, 1e-12);
  EXPECT_NEAR(tau(posed.model.coordinate("knee_angle_l")), 0.0, 1e-12);
}

}  // namespace
}  // namespace veridyn::muscle
