// What drives a forward simulation: excitations and reserves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/temporary_folder.hpp"

namespace veridyn::muscle {
namespace {

using test::expect_refusals;
using test::kArm;
using test::read_muscle_study;
using test::study_error;
using testing::ElementsAre;
using testing::HasSubstr;

class MuscleStudyExcitation : public testing::Test {
 protected:
  /// A forward study with a file of controls.
  [[nodiscard]] std::string with(const std::string& columns, const std::string& rows, const std::string& more) const {
    std::ofstream(folder_ / "controls.sto") << "controls\nversion=1\nendheader\n" << columns << "\n" << rows;
    return kArm + "[motion]\nexcitation_file = \"controls.sto\"\nreserve_force = 5\n" + more;
  }
  static std::vector<double> at(const ControlSignals& signals, double time) {
    std::vector<double> values(signals.size());
    signals.evaluate(time, values.data());
    return values;
  }
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

TEST_F(MuscleStudyExcitation, OfAFileLeavesMusclesWithoutAColumnAsTheStudySays) {
  const std::string text = with("time\tbrachialis\telbow_flexion_reserve", "0\t0.2\t0.5\n1\t0.6\t-0.5\n",
                                "[motion.excitation]\ndefault = 0.1\ntriceps_long = 0.3\n");
  const MuscleStudy study = read_muscle_study(text, folder_);
  EXPECT_THAT(study.inputs, ElementsAre(folder_ / "controls.sto"));
  const auto name = [&](std::size_t m) { return study.system->model().muscles[m].name(); };
  const std::vector<double> half_way = at(study.controls.excitation, 0.5);
  for (std::size_t m = 0; m < half_way.size(); ++m)
    EXPECT_DOUBLE_EQ(half_way[m], name(m) == "brachialis" ? 0.4 : name(m) == "triceps_long" ? 0.3 : 0.1) << name(m);
  // Reserves are in units of reserve_force.
  EXPECT_THAT(at(study.controls.reserve, 0.0), ElementsAre(0.0, 2.5));
  EXPECT_NEAR(at(study.controls.reserve, 0.5)[1], 0.0, 1e-15);
}

TEST_F(MuscleStudyExcitation, HeldSamplesStandUntilTheNextAndRepeatsAreNoSteps) {
  const std::string rows = "0\t0.2\n0.1\t0.2\n0.2\t0.6\n0.3\t0.6\n";
  const std::string text = with("time\tbrachialis", rows, "interpolation = \"hold\"\n");
  const ControlSignals held = read_muscle_study(text, folder_).controls.excitation;
  EXPECT_THAT(std::vector<double>(held.times().begin(), held.times().end()), ElementsAre(0.0, 0.2));
  EXPECT_EQ(at(held, 0.19)[5], 0.2);
  EXPECT_EQ(at(held, 0.2)[5], 0.6);
}

TEST_F(MuscleStudyExcitation, MistakesAreNamedWithFileLineAndKey) {
  expect_refusals(
      {{kArm + "[motion.excitation]\nbrachialis = nan\n", "s.toml:4: motion.excitation.brachialis", "finite"},
       {kArm + "[motion.excitation]\nbrachialis = 1.2\n", "s.toml:4: motion.excitation.brachialis",
        "must be from 0 to 1"},
       {kArm + "[motion.excitation]\nbrachalis = 0.2\n", "s.toml:4: motion.excitation.brachalis",
        "did you mean 'brachialis'?"},
       {kArm + "[motion]\n[[motion.excitation_step]]\ntime = 0.2\nbrachialis = 0.1\n[[motion.excitation_step]]\n"
               "time = 0.1\n",
        "s.toml:8", "not after 0.2 s"},
       {kArm + "[motion]\nexcitation_file = \"nowhere.sto\"\n", "nowhere.sto", "no such file"}});
  EXPECT_THAT(
      study_error(with("time\tbrachialis", "0\t0.2\n1\t0.6\n", "[[motion.excitation_step]]\ntime = 0.2\n"), folder_),
      HasSubstr("exclude each other"));
}

}  // namespace
}  // namespace veridyn::muscle
