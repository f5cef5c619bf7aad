#include "veridyn/muscle/simulation/wrap_bands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/identification/task_warnings.hpp"
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

TEST(WrapBands, OfATaskAreInItsWarnings) {
  const auto file = veridyn::test::shared_folder() / "data/opensim/arm26.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  const MusculoskeletalSystem system(read_osim(file), {.locked = {"r_shoulder_elev"}});
  std::vector<double> time;
  for (int i = 0; i <= 10; ++i) time.push_back(0.01 * i);
  const auto task = [&](double shoulder_deg, const char* name) {
    MotionSegment segment;
    segment.start = default_start(system.model());
    segment.start.q << shoulder_deg * kDegree, 0.5;
    segment.controls = {ControlSignals(std::vector<double>(6, 0.05)), {}};
    segment.time = time;
    segment.name = name;
    return segment;
  };
  // Of every tenth of a degree about the jump, one is in the band.
  std::vector<MotionSegment> segments;
  for (int i = 0; i <= 40; ++i) segments.push_back(task(20.0 + 0.5 * i, "near the jump"));
  segments.push_back(task(0.0, "far from it"));
  const MuscleParametricModel model(system, std::vector<MuscleUnknown>{}, segments, {});
  std::size_t near = 0, far = 0;
  for (const std::string& warning : task_warnings(model, Eigen::VectorXd())) {
    near += warning.find("near the jump: muscle 'BIClong'") == 0 ? 1 : 0;
    far += warning.find("far from it") == 0 ? 1 : 0;
  }
  EXPECT_GT(near, 0u);
  EXPECT_EQ(far, 0u);
}

}  // namespace
}  // namespace veridyn::muscle
