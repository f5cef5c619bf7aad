#include "veridyn/report/muscle_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/report/document/html.hpp"
#include "veridyn/report/figures/skeleton_figure.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Simulated {
  muscle::MuscleStudy study;
  muscle::MuscleResult result;
};

Simulated run(const std::string& motion, const std::string& subject = "") {
  const Study study = Study::parse("[subject]\nmodel = \"arm\"\n" + subject + "[motion]\n" + motion, "s.toml");
  Progress progress;
  muscle::MuscleStudy read = muscle::read_study(study, progress);
  muscle::MuscleResult result = muscle::run_study(read, progress);
  return {std::move(read), std::move(result)};
}

const std::string kLift =
    "method = \"static optimization\"\nduration = 0.5\nrate = 40\n[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\n"
    "from = \"20 deg\"\nto = \"90 deg\"\nduration = 0.5\n";
const std::string kLoad = "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n";

template <typename Block>
std::vector<const Block*> blocks(const Document& document) {
  std::vector<const Block*> found;
  for (const Section& section : document.sections) {
    for (const auto& block : section.blocks) {
      if (const auto* each = std::get_if<Block>(&block)) found.push_back(each);
    }
  }
  return found;
}

const XYSeries& series(const XYPlot& plot, const std::string& name) {
  const auto found =
      std::find_if(plot.series.begin(), plot.series.end(), [&](const XYSeries& s) { return s.name == name; });
  EXPECT_NE(found, plot.series.end()) << name;
  return *found;
}

TEST(MuscleReport, HasPosesCurvesAndATableOfTheMuscles) {
  const Simulated lift = run(kLift, kLoad + "[subject.parameters]\nbrachialis.max_isometric_force = 900\n");
  const Document document = muscle_report(lift.study, lift.result, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kGood);
  std::vector<std::string> titles;
  for (const Section& section : document.sections) titles.push_back(section.title);
  EXPECT_THAT(titles, ElementsAre("Motion", "Muscles", "Notes", "Credits of the model"));
  EXPECT_EQ(blocks<XYPlot>(document).size(), 2u);
  const auto tables = blocks<Table>(document);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0]->rows.size(), 6u);
  EXPECT_EQ(tables[0]->rows[5].status, Status::kCaution);  // brachialis, whose parameter the study sets
  EXPECT_EQ(tables[0]->rows[0].status, Status::kNone);
  EXPECT_THAT(to_html(document), HasSubstr("biceps_long"));
}

TEST(MuscleReport, DrawsTheModelToScaleWhereItIs) {
  const Simulated lift = run(kLift, kLoad);
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

TEST(MuscleReport, SaysThatASimulationDidNotFinish) {
  const Simulated failed = run("duration = 1\naccuracy = 0.1\n[motion.start_speed]\nelbow_flexion = 1e6\n",
                               "locked = [\"shoulder_flexion\"]\n");
  ASSERT_FALSE(failed.result.usable());
  const Document document = muscle_report(failed.study, failed.result, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.word, "Not finished");
  EXPECT_THAT(document.verdict.headline, HasSubstr("at "));
}

TEST(MuscleReport, WarnsWhereMusclesCannotDoIt) {
  const Simulated weak =
      run("reserve_force = 0\n" + kLift, kLoad +
                                             "[subject.parameters]\nbrachialis.max_isometric_force = 5\n"
                                             "biceps_long.max_isometric_force = 5\n"
                                             "biceps_short.max_isometric_force = 5\n");
  const Document document = muscle_report(weak.study, weak.result, "veridyn test");
  EXPECT_EQ(document.verdict.level, Level::kCaution);
  ASSERT_FALSE(document.sections.empty());
  EXPECT_EQ(document.sections[0].title, "Warnings");
}

}  // namespace
}  // namespace veridyn::report
