#include "veridyn/muscle/simulation/wrap_bands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// arm26 with the elbow still while the shoulder goes from -90 to 90 deg: the long head of the triceps comes off the
/// end of its cylinder at the glenoid, the long head of the biceps goes over the top of the humeral head (OpenSim's arm
/// is steepest there, at -78.4 deg).
TEST(WrapBands, AreNamedWithMuscleAndPose) {
  const auto file = veridyn::test::shared_folder() / "data/opensim/arm26.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  const MusculoskeletalSystem system(read_osim(file), {});
  std::vector<double> time;
  estimation::RowMatrix q(181, 2);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    time.push_back(0.01 * static_cast<double>(i));
    q.row(i) << static_cast<double>(i - 90) * kDegree, 0.5;
  }
  const std::vector<WrapBandVisit> visits = wrap_band_visits(system, time, q);
  bool biceps = false, triceps = false;
  for (const WrapBandVisit& visit : visits) {
    if (visit.muscle == system.model().muscle("BIClong")) {
      // The biceps' point inside the humeral head, from 31.3 deg on, is no reason to doubt its arm.
      biceps = true;
      EXPECT_EQ(visit.kind, WrapBandKind::kSideChange);
      EXPECT_NEAR(visit.pose(0), -78.43 * kDegree, 0.05 * kDegree);
      EXPECT_NEAR(visit.first, 0.01 * (90.0 - 78.43), 0.001);
      EXPECT_NEAR(visit.jump, 0.029, 0.001);
      EXPECT_EQ(visit.length_jump, 0.0);
      EXPECT_THAT(wrap_band_text(system, visit), AllOf(HasSubstr("BIClong"), HasSubstr("r_shoulder_elev = -78.4")));
    } else if (visit.muscle == system.model().muscle("TRIlong") && visit.kind == WrapBandKind::kEnds) {
      triceps = true;
      EXPECT_GT(visit.poses, 0u);
      EXPECT_LT(visit.poses, 181u);
      EXPECT_LE(visit.first, visit.last);
      EXPECT_THAT(wrap_band_text(system, visit), AllOf(HasSubstr("TRIlong"), HasSubstr("r_shoulder_elev = ")));
    }
  }
  EXPECT_TRUE(biceps);
  EXPECT_TRUE(triceps);
  // Where none is, none is named.
  const estimation::RowMatrix rest = system.model().default_pose().transpose();
  EXPECT_TRUE(wrap_band_visits(system, std::vector<double>{0.0}, rest).empty());
}

/// A point of a path that turns through the wall of its cylinder's quadrant: the path went round the far side before.
TEST(WrapBands, SayHowMuchALengthJumpsWhereAPointPassesAWall) {
  Model model = load_model("arm").model();
  WrapObject cylinder;
  cylinder.name = "trochlea";
  cylinder.shape = WrapShape::kCylinder;
  cylinder.body = model.body("humerus");
  cylinder.placement.translation = model.joints[1].parent_frame.translation;
  cylinder.dimensions = {0.012, 0.3, 0.0};
  cylinder.quadrant = {0, 1};
  model.wrap_objects = {cylinder};
  Muscle muscle = model.muscles[model.muscle("brachialis")];
  muscle.points.resize(2);
  muscle.points[0].body = model.body("humerus");
  muscle.points[0].location = cylinder.placement.translation + Eigen::Vector3d(-0.01, 0.08, 0.0);
  muscle.points[1].body = model.body("forearm");
  muscle.points[1].location = {-0.04, 0.02, 0.0};
  muscle.wraps = {{}};
  muscle.wraps[0].object = 0;
  model.muscles = {muscle};
  const MusculoskeletalSystem system(model, {});
  std::vector<double> time;
  estimation::RowMatrix q(131, 2);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    time.push_back(0.01 * static_cast<double>(i));
    q.row(i) << 0.0, static_cast<double>(i) * kDegree;
  }
  const std::vector<WrapBandVisit> visits = wrap_band_visits(system, time, q);
  ASSERT_EQ(visits.size(), 1u);
  EXPECT_EQ(visits[0].kind, WrapBandKind::kSideChange);
  // Where the point lies on the wall, behind the axis.
  EXPECT_NEAR(visits[0].pose(1), std::atan2(0.02, 0.04), 1e-5);
  EXPECT_GT(visits[0].length_jump, 0.01);
  EXPECT_THAT(wrap_band_text(system, visits[0]), HasSubstr("its length by "));
}

}  // namespace
}  // namespace veridyn::muscle
