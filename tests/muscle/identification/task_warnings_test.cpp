#include "veridyn/muscle/identification/task_warnings.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

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
  // The triceps comes off the end of its cylinder about here.
  std::vector<MotionSegment> segments;
  for (int i = 0; i <= 20; ++i) segments.push_back(task(35.0 + 0.5 * i, "near the end"));
  segments.push_back(task(0.0, "far from it"));
  const MuscleParametricModel model(system, std::vector<MuscleUnknown>{}, segments, {});
  std::size_t near = 0, far = 0;
  for (const std::string& warning : task_warnings(model, Eigen::VectorXd())) {
    near += warning.find("near the end: muscle 'TRIlong'") == 0 ? 1 : 0;
    far += warning.find("far from it") == 0 ? 1 : 0;
  }
  EXPECT_GT(near, 0u);
  EXPECT_EQ(far, 0u);
}

TEST(TaskWarnings, NameATaskThatCannotBeSimulated) {
  const MusculoskeletalSystem arm(load_model("arm").model());
  MotionSegment segment;
  segment.start = default_start(arm.model());
  segment.controls = {ControlSignals(std::vector<double>(6, 0.05)), {}};
  segment.time = {0.0, 0.01, 0.02};
  segment.name = "curl";
  const MuscleUnknown force =
      make_unknown(arm.model(), {.muscles = {"brachialis"}, .fields = {"max_isometric_force"}, .factor = true}, "test");
  const MuscleParametricModel model(arm, std::vector<MuscleUnknown>{force}, {segment}, {});
  EXPECT_TRUE(task_warnings(model, Eigen::VectorXd::Constant(1, 1.0)).empty());
  // No muscle pulls with less than nothing.
  EXPECT_EQ(task_warnings(model, Eigen::VectorXd::Constant(1, -1.0)),
            std::vector<std::string>{"curl: the simulation cannot finish"});
}

}  // namespace
}  // namespace veridyn::muscle
