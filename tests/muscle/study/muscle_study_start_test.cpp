// Where the motion of a muscle study starts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using test::expect_refusals;
using test::kArm;
using test::read_muscle_study;
using test::study_error;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MuscleStudyStart : public testing::Test {
 protected:
  /// A forward study that starts in a file of states with these columns and rows at 0 and 1 s.
  [[nodiscard]] std::string from(const std::string& columns, const std::string& rows, bool degrees = false,
                                 const std::string& begin = "0.25") const {
    std::ofstream(folder_ / "states.sto")
        << "states\nversion=1\ninDegrees=" << (degrees ? "yes" : "no") << "\nendheader\n"
        << columns << "\n"
        << rows;
    return kArm + "[motion]\nstart_file = \"states.sto\"\nbegin = " + begin + "\nduration = 0.1\n";
  }
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

TEST_F(MuscleStudyStart, IsTheStateOfItsFileAtTheBeginning) {
  const MuscleStudy study = read_muscle_study(
      from("time\telbow_flexion\t/jointset/elbow/elbow_flexion/speed", "0\t0.4\t1\n1\t0.8\t3\n"), folder_);
  // A quarter of the way from the first row to the second; the shoulder, which the file does not have, as the model
  // has.
  EXPECT_DOUBLE_EQ(study.start.q(1), 0.5);
  EXPECT_DOUBLE_EQ(study.start.qdot(1), 1.5);
  EXPECT_EQ(study.start.q(0), read_muscle_study(kArm + "[motion]\n").start.q(0));
  EXPECT_THAT(study.warnings, ElementsAre(HasSubstr("muscles start at rest")));
  EXPECT_THAT(study.inputs, ElementsAre(folder_ / "states.sto"));
}

TEST_F(MuscleStudyStart, TakesDegreesWhereTheFileSaysSo) {
  const MuscleStudy study =
      read_muscle_study(from("time\telbow_flexion\telbow_flexion_speed", "0\t30\t10\n1\t30\t10\n", true), folder_);
  EXPECT_DOUBLE_EQ(study.start.q(1), 30.0 * kDegree);
  EXPECT_DOUBLE_EQ(study.start.qdot(1), 10.0 * kDegree);
}

TEST_F(MuscleStudyStart, HasActivationsAndFibresOfAllMusclesOrOfNone) {
  const Model model = read_muscle_study(kArm + "[motion]\n").system->model();
  std::string columns = "time\telbow_flexion", row = "\t0.5";
  for (const Muscle& muscle : model.muscles) {
    columns += "\t" + muscle.name() + "/activation\t" + muscle.name() + "/fiber_length";
    row += "\t0.2\t0.1";
  }
  const MuscleStudy study = read_muscle_study(from(columns, "0" + row + "\n1" + row + "\n"), folder_);
  EXPECT_THAT(study.warnings, IsEmpty());
  EXPECT_EQ(study.start.activation, Eigen::VectorXd::Constant(6, 0.2));
  EXPECT_EQ(study.start.fiber_length, Eigen::VectorXd::Constant(6, 0.1));
  const std::string half = from("time\telbow_flexion\tbrachialis/activation", "0\t0.5\t0.2\n1\t0.5\t0.2\n");
  EXPECT_THAT(study_error(half, folder_), HasSubstr("has only one of activation and fiber_length of 'brachialis'"));
}

TEST_F(MuscleStudyStart, RefusesAFileWithoutTheTimeOrWithoutAPose) {
  const std::string rows = "0\t0.4\n1\t0.8\n";
  EXPECT_THAT(study_error(from("time\telbow_flexion", rows, false, "1.5"), folder_),
              HasSubstr("motion.start_file: has no state at 1.5 s, only from 0 to 1 s"));
  EXPECT_THAT(study_error(from("time\tbrachialis/activation", rows), folder_),
              HasSubstr("has no column of a coordinate's value"));
}

TEST_F(MuscleStudyStart, MistakesAreNamedWithFileLineAndKey) {
  expect_refusals({{kArm + "[motion.start]\nelbow = 1\n", "s.toml:4: motion.start.elbow", "no coordinate 'elbow'"},
                   {kArm + "[motion.start]\nelbow_flexion = \"140 deg\"\n", "s.toml:4: motion.start.elbow_flexion",
                    "is outside its range"}});
}

}  // namespace
}  // namespace veridyn::muscle
