// Static optimisation of a minimum-jerk elbow motion of arm26 against OpenSim 4.5.2.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/muscle/reference_table.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/muscle/dynamics/inverse_dynamics.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/static_optimization.hpp"

namespace veridyn::muscle {
namespace {

constexpr std::array<const char*, 6> kNames{"TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA"};
constexpr std::array<const char*, 2> kReserves{"r_shoulder_elev_reserve_Nm", "r_elbow_flex_reserve_Nm"};

struct ReferenceMotion {
  Model model;
  Mechanism mechanism;
  MusclePaths paths;
  PathWorkspace<double> workspace;
  Kinematics<double> kinematics;
  Eigen::MatrixXd arms = Eigen::MatrixXd::Zero(6, 2);
  Eigen::VectorXd length = Eigen::VectorXd::Zero(6), speed = Eigen::VectorXd::Zero(6), required;

  ReferenceMotion(Model m, WrapMode mode)
      : model(std::move(m)), mechanism(model), paths(model, mechanism, mode), workspace(paths), kinematics(mechanism) {}

  // Shoulder at 0, elbow from 0 to 90 degrees with minimum jerk in a second.
  void at(double t) {
    const double amplitude = std::numbers::pi / 2.0, t2 = t * t, t3 = t2 * t;
    const Eigen::VectorXd q = Eigen::Vector2d(0.0, amplitude * t3 * (10.0 - 15.0 * t + 6.0 * t2));
    const Eigen::VectorXd qdot = Eigen::Vector2d(0.0, amplitude * t2 * (30.0 - 60.0 * t + 30.0 * t2));
    const Eigen::VectorXd qddot = Eigen::Vector2d(0.0, amplitude * t * (60.0 - 180.0 * t + 120.0 * t2));
    required = inverse_dynamics(mechanism, q, qdot, qddot);
    update_positions(mechanism, q.data(), kinematics);
    paths.evaluate(kinematics, q.data(), workspace);
    paths.speeds(workspace, qdot.data(), speed.data());
    arms.setZero();
    for (Eigen::Index i = 0; i < 6; ++i) length(i) = workspace.length[i];
    for (std::size_t p = 0; p < paths.pairs().size(); ++p)
      arms(paths.pairs()[p].muscle, paths.pairs()[p].coordinate) = -workspace.gradient[p];
  }
};

struct Case {
  const char* file;
  StaticForce force;
};

class StaticOptimizationReference : public testing::TestWithParam<Case> {};

TEST_P(StaticOptimizationReference, ControlsAreThoseOfOpenSim) {
  const std::filesystem::path osim = veridyn::test::shared_folder() / "data/opensim/arm26.osim";
  const test::ReferenceTable t = test::read_reference(std::string("opensim/") + GetParam().file);
  if (t.rows.empty() || !std::filesystem::exists(osim)) GTEST_SKIP() << "no " << GetParam().file << " or arm26.osim";
  ReferenceMotion motion(read_osim(osim), WrapMode::kAsOpenSim), taut(read_osim(osim), WrapMode::kTaut);
  const std::vector<MuscleParameters> muscles = muscle_parameters(motion.model);
  StaticOptimizer optimizer(muscles, {.force = GetParam().force, .reserve = {1.0, 1.0}});
  StaticOptimizer with_passive(muscles, {.force = StaticForce::kWithPassive, .reserve = {1.0, 1.0}});
  StaticOptimizationFrame frame, passive;
  double same_balance = 0.0, own_balance = 0.0, with_taut = 0.0;
  for (std::size_t row = 0; row < t.rows.size(); ++row) {
    const double time = t.number(row, "time_s");
    motion.at(time);
    const auto worst = [&](const StaticOptimizationFrame& f) {
      double greatest = 0.0;
      for (std::size_t i = 0; i < 6; ++i)
        greatest =
            std::max(greatest, std::abs(f.activation(i) - t.number(row, std::string(kNames[i]) + "_activation")));
      for (std::size_t j = 0; j < 2; ++j)
        greatest = std::max(greatest, std::abs(f.reserve(j) - t.number(row, kReserves[j])));
      return greatest;
    };
    // The generalised forces that OpenSim's own answer has: all of the motion, the optimum alone is compared.
    Eigen::VectorXd theirs = Eigen::VectorXd::Zero(2);
    for (std::size_t i = 0; i < 6; ++i)
      theirs += motion.arms.row(i).transpose() * t.number(row, std::string(kNames[i]) + "_force_N");
    for (std::size_t j = 0; j < 2; ++j) theirs(j) += t.number(row, kReserves[j]);
    optimizer.solve(motion.arms, motion.length, motion.speed, theirs, frame);
    ASSERT_TRUE(frame.usable());
    same_balance = std::max(same_balance, worst(frame));
    // Inverse dynamics of the motion in closed form. OpenSim splines its samples and rounds the jump of the jerk at
    // both ends, by up to 0.012 N m.
    if (time < 0.02 || time > 0.98) continue;
    optimizer.solve(motion.arms, motion.length, motion.speed, motion.required, frame);
    ASSERT_TRUE(frame.usable());
    own_balance = std::max(own_balance, worst(frame));
    taut.at(time);
    optimizer.solve(taut.arms, taut.length, taut.speed, taut.required, frame);
    with_taut = std::max(with_taut, worst(frame));
    with_passive.solve(motion.arms, motion.length, motion.speed, motion.required, passive);
    ASSERT_TRUE(passive.usable());
  }
  fmt::print(
      "{}: controls differ by {:.1e} at OpenSim's balance, {:.1e} at ours (0.02 to 0.98 s), {:.1e} with taut paths; "
      "with passive forces, at the end: BIClong {:.3f}\n",
      GetParam().file, same_balance, own_balance, with_taut, passive.activation(3));
  EXPECT_LT(same_balance, 1e-4);
  EXPECT_LT(own_balance, 1e-4);
  // Moment arms that are derivatives of a taut path differ from OpenSim's by up to 0.4 mm.
  EXPECT_LT(with_taut, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Arm26, StaticOptimizationReference,
                         testing::Values(Case{"d_arm26_static_optimization.csv", StaticForce::kAsOpenSim},
                                         Case{"d_arm26_static_optimization_without_muscle_physiology.csv",
                                              StaticForce::kIsometric}),
                         [](const auto& which) {
                           return std::string(which.param.force == StaticForce::kAsOpenSim ? "WithPhysiology"
                                                                                           : "WithoutPhysiology");
                         });

}  // namespace
}  // namespace veridyn::muscle
