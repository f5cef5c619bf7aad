#include "veridyn/muscle/simulation/motion_analysis.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/muscle/minimum_jerk.hpp"
#include "tests/muscle/reference_table.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

TEST(MotionAnalysis, StaticOptimisationOfAMotionIsOpenSims) {
  if (!std::filesystem::exists(veridyn::test::shared_folder() / "reference/opensim"))
    GTEST_SKIP() << "OpenSim's results of ../shared/reference are not here";
  const test::ReferenceTable table = test::read_reference("opensim/d_arm26_static_optimization.csv");
  const MusculoskeletalSystem system(read_osim(veridyn::test::shared_folder() / "data/opensim/arm26.osim"),
                                     {.paths = PathSource::kAsOpenSim});
  const Motion motion =
      make_motion(read_signals(veridyn::test::shared_folder() / "reference/opensim/minjerk_elbow.mot"), system.model());
  Progress progress;
  const MotionAnalysis a = optimise_motion(system, motion, system.model().default_pose(), frame_times(0.0, 1.0, 200.0),
                                           {.reserve = {1.0, 1.0}}, progress);
  ASSERT_EQ(a.time.size(), table.rows.size());
  EXPECT_TRUE(a.infeasible.empty());
  for (std::size_t i = 0; i < a.time.size(); ++i) {
    // The jerk of this motion jumps at its ends: there any spline rings, each differently.
    const double tolerance = a.time[i] < 0.02 || a.time[i] > 0.98 ? 3e-4 : 1e-4;
    for (std::size_t m = 0; m < 6; ++m) {
      EXPECT_NEAR(a.activation(i, m), table.number(i, system.model().muscles[m].name() + "_activation"), tolerance)
          << a.time[i];
    }
  }
}

TEST(MotionAnalysis, MomentsAreProducedByTheMuscles) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const Motion motion = test::minimum_jerk(system.model(), 0.3, 1.6);
  Progress progress;
  for (const StaticForce force : {StaticForce::kAsOpenSim, StaticForce::kWithPassive, StaticForce::kIsometric}) {
    const MotionAnalysis a = optimise_motion(system, motion, system.model().default_pose(), frame_times(0.0, 1.0, 50.0),
                                             {.force = force, .reserve = {1.0, 1.0}}, progress);
    Kinematics<double> kinematics(system.mechanism());
    PathWorkspace<double> workspace(system.paths());
    for (Eigen::Index i = 0; i < a.q.rows(); ++i) {
      const Eigen::VectorXd q = a.q.row(i);
      update_positions(system.mechanism(), q.data(), kinematics);
      system.paths().evaluate(kinematics, q.data(), workspace);
      Eigen::VectorXd moment = a.reserve.row(i);
      for (std::size_t k = 0; k < workspace.gradient.size(); ++k) {
        moment(system.paths().pairs()[k].coordinate) -=
            workspace.gradient[k] * a.force(i, system.paths().pairs()[k].muscle);
      }
      EXPECT_LT((moment - a.moment.row(i).transpose()).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
