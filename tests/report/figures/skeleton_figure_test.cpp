#include "veridyn/report/figures/skeleton_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "tests/report/lifted_arm.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

const XYSeries& series(const XYPlot& plot, const std::string& name) {
  const auto found =
      std::find_if(plot.series.begin(), plot.series.end(), [&](const XYSeries& s) { return s.name == name; });
  if (found == plot.series.end()) throw std::runtime_error("no series " + name);
  return *found;
}

std::vector<std::string> series_names(const XYPlot& plot) {
  std::vector<std::string> names;
  for (const XYSeries& s : plot.series) names.push_back(s.name);
  return names;
}

TEST(SkeletonFigure, DrawsTheModelToScaleWhereItIs) {
  const test::SimulatedArm lift = test::simulated_arm(test::kLift, test::kLoad);
  const std::vector<XYPlot> plots = skeleton_figure(lift.study, lift.result);
  ASSERT_EQ(plots.size(), 2u);
  EXPECT_EQ(plots[0].x.label, "x, forward");
  EXPECT_EQ(plots[0].y.label, "y, up");
  for (const XYPlot& plot : plots) EXPECT_TRUE(plot.equal_scale);
  // The shoulder hangs at (0, 1.4), the elbow 0.29 m below; at 90 deg the load is 0.3 m in front of it.
  const XYSeries& joints = series(plots[1], "joint centres");
  EXPECT_NEAR(joints.x[1], 0.0, 1e-12);
  EXPECT_NEAR(joints.y[1], 1.11, 1e-12);
  const XYSeries& load = series(plots[1], "load");
  EXPECT_NEAR(load.x.front(), 0.3, 1e-9);
  EXPECT_NEAR(load.y.front(), 1.11, 1e-9);
  // The forearm's stick ends at twice its own mass centre, whatever it carries.
  const XYSeries& bones = series(plots[1], "bones");
  EXPECT_NEAR(*std::max_element(bones.x.begin(), bones.x.end()), 0.34, 1e-9);
  // A path's length in the plane is at most its own; brachialis lies in the plane.
  const XYSeries& path = series(plots[1], "brachialis");
  double length = 0.0;
  for (std::size_t i = 1; i < path.x.size(); ++i)
    length += std::hypot(path.x[i] - path.x[i - 1], path.y[i] - path.y[i - 1]);
  EXPECT_NEAR(length, lift.result.trajectory.path_length(lift.result.trajectory.path_length.rows() - 1, 5), 1e-4);
}

TEST(SkeletonFigure, NamesMusclesUpToALimitAndDrawsMoreOfThemInOneColour) {
  const test::SimulatedArm lift = test::simulated_arm(test::kLift);
  const XYPlot named = skeleton_figure(lift.study, lift.result, 6).front();
  EXPECT_THAT(series_names(named), Contains("triceps_long"));
  EXPECT_THAT(series_names(named), Not(Contains("load"))) << "nothing is held";
  const XYPlot together = skeleton_figure(lift.study, lift.result, 5).front();
  EXPECT_THAT(series_names(together), testing::ElementsAre("bones on the way", "bones", "muscles", "joint centres"));
  // Six paths, with a gap between each two.
  const XYSeries& muscles = series(together, "muscles");
  EXPECT_EQ(std::count_if(muscles.x.begin(), muscles.x.end(), [](double x) { return std::isnan(x); }), 5);
}

TEST(SkeletonFigure, IsOnePlotOfASinglePoseAndNoneOfAPoseThatIsNoNumber) {
  test::SimulatedArm lift = test::simulated_arm(test::kLift);
  const estimation::RowMatrix q = lift.result.trajectory.q;
  lift.result.trajectory.q = q.topRows(1);
  const std::vector<XYPlot> plots = skeleton_figure(lift.study, lift.result);
  ASSERT_EQ(plots.size(), 1U);
  EXPECT_EQ(plots[0].title, "Pose at 0 s");
  lift.result.trajectory.q(0, 0) = kNaN;
  EXPECT_THAT(skeleton_figure(lift.study, lift.result), IsEmpty());
  lift.result.trajectory.q.resize(0, q.cols());
  EXPECT_THAT(skeleton_figure(lift.study, lift.result), IsEmpty());
}

// The same motion of an arm that hangs from a frame turned by 90 deg about the vertical: forward becomes left.
TEST(SkeletonFigure, LooksAtThePlaneInWhichMostOfTheMotionIs) {
  test::SimulatedArm lift = test::simulated_arm(test::kLift);
  muscle::Model turned = lift.study.system->model();
  turned.muscles.clear();
  turned.joints.at(0).parent_frame.rotation = Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  lift.study.written = turned;
  lift.study.system = std::make_unique<muscle::MusculoskeletalSystem>(turned);
  const XYPlot plot = skeleton_figure(lift.study, lift.result).back();
  EXPECT_EQ(plot.x.label, "z, to the right");
  EXPECT_EQ(plot.y.label, "y, up");
  const XYSeries& bones = series(plot, "bones");
  // The shoulder is 0.17 m to the right of the ground's origin, the hand at 90 deg 0.34 m to the left of it.
  EXPECT_NEAR(*std::max_element(bones.x.begin(), bones.x.end()), 0.17, 1e-9);
  EXPECT_NEAR(*std::min_element(bones.x.begin(), bones.x.end()), -0.17, 1e-9);
}

}  // namespace
}  // namespace veridyn::report
