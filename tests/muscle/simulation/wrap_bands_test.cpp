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

/// arm26 with the elbow still while the shoulder goes through the pose at which OpenSim's BIClong jumps by 87 mm, 29.6
/// deg (reference), where ours fades from one path to the other.
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
  bool biceps = false;
  for (const WrapBandVisit& visit : visits) {
    if (visit.muscle != system.model().muscle("BIClong")) continue;
    biceps = true;
    EXPECT_GT(visit.poses, 0u);
    EXPECT_LT(visit.poses, 181u);
    EXPECT_LE(visit.first, visit.last);
    EXPECT_THAT(wrap_band_text(system, visit), AllOf(HasSubstr("BIClong"), HasSubstr("r_shoulder_elev = ")));
  }
  EXPECT_TRUE(biceps);
  // Where none is, none is named.
  const estimation::RowMatrix rest = system.model().default_pose().transpose();
  EXPECT_TRUE(wrap_band_visits(system, std::vector<double>{0.0}, rest).empty());
}

}  // namespace
}  // namespace veridyn::muscle
