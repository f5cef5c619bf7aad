// Paths with automatic derivatives.
#include <gtest/gtest.h>

#include "tests/muscle/path/posed_arm.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using test::PosedArm;

TEST(MusclePaths, JetsCarryTheDerivativesOfTheMomentArms) {
  PosedArm arm(load_model("arm").model());
  using Jet = SimulationJet;
  PathWorkspace<Jet> workspace(arm.paths);
  Kinematics<Jet> kinematics(arm.mechanism);
  for (const double s : {-30.0, 15.0, 70.0}) {
    for (const double e : {20.0, 75.0, 120.0}) {
      const Eigen::Vector2d q(s * kDegree, e * kDegree);
      const Jet qj[2] = {Jet(q[0], 0), Jet(q[1], 1)};
      update_positions(arm.mechanism, qj, kinematics);
      arm.paths.evaluate(kinematics, qj, workspace);
      arm.pose(q);
      for (std::size_t k = 0; k < arm.paths.pairs().size(); ++k) {
        const auto pair = arm.paths.pairs()[k];
        EXPECT_NEAR(workspace.length[pair.muscle].v[pair.coordinate], arm.workspace.gradient[k], 3e-7);
      }
      for (int c = 0; c < 2; ++c) {
        const double h = 1e-5;
        Eigen::VectorXd up = q, down = q;
        up[c] += h;
        down[c] -= h;
        arm.pose(up);
        const std::vector<double> more = arm.workspace.gradient;
        arm.pose(down);
        for (std::size_t k = 0; k < more.size(); ++k)
          EXPECT_NEAR(workspace.gradient[k].v[c], (more[k] - arm.workspace.gradient[k]) / (2.0 * h), 2e-5) << k;
      }
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
