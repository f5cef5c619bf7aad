#include "veridyn/muscle/simulation/wrap_bands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace veridyn::muscle
