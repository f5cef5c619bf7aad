#include "veridyn/report/cueing_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/study.hpp"
#include "veridyn/report/document/json.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Document report_of(const std::string& text) {
  const Study study = Study::parse(text, "rig.toml");
  Progress progress;
  const cueing::CueingStudy read = cueing::read_study(study, progress);
  study.root().finish();
  Document document = cueing_report(read, cueing::cue(read, progress), "Veridyn");
  check(document);
  EXPECT_FALSE(to_json(document).empty());
  return document;
}

std::string drive(const char* amplitude) {
  return std::string(
             "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
             "manoeuvre = \"sine\"\nfrequency = \"0.3 Hz\"\nspeed = 15\nduration = 12\namplitude = \"") +
         amplitude + "\"\n[platform]\nsubject = \"three_axis\"\n";
}

std::vector<std::string> titles(const Document& document) {
  std::vector<std::string> all;
  for (const Section& section : document.sections) all.push_back(section.title);
  return all;
}

const Section& section(const Document& document, const std::string& title) {
  for (const Section& each : document.sections) {
    if (each.title == title) return each;
  }
  throw std::runtime_error("no section " + title);
}

TEST(CueingReport, ShowsThePlatformBesideItsHistories) {
  const Document document = report_of("[cue]\nalgorithms = [\"tilt\", \"optimal\"]\n" + drive("2 deg"));
  const std::vector<Block>& blocks = section(document, "What the platform does").blocks;
  ASSERT_GE(blocks.size(), 2U);
  const auto* scene = std::get_if<Scene>(&blocks[0]);
  const auto* histories = std::get_if<TimeSeries>(&blocks[1]);
  ASSERT_TRUE(scene != nullptr && histories != nullptr);
  EXPECT_EQ(scene->axis, histories->axis) << "one time";
  EXPECT_EQ(scene->samples.front(), histories->samples.front());
  EXPECT_EQ(scene->samples.back(), histories->samples.back());
  ASSERT_EQ(scene->motions.size(), 2U);
  EXPECT_EQ(scene->motions[1].name, "optimal");
  // The roll of the drawing is that of the histories.
  for (std::size_t j = 0; j < scene->joints.size(); ++j) {
    for (const Panel& panel : histories->panels) {
      if (panel.label != scene->joints[j].name) continue;
      EXPECT_EQ(panel.unit, scene->joints[j].unit);
      EXPECT_NEAR(scene->motions[1].values[j].back(), panel.lines[1].y.back(), 1e-9);
    }
  }
}

TEST(CueingReport, SaysByHowMuchEachDiffersFromTheFirst) {
  const Document document = report_of("[cue]\nalgorithms = [\"tilt\", \"optimal\", \"mpc\"]\n" + drive("2 deg"));
  const Table* against = nullptr;
  for (const Block& block : section(document, "Cue by cue").blocks) {
    if (const auto* table = std::get_if<Table>(&block); table != nullptr && table->title == "Against tilt")
      against = table;
  }
  ASSERT_TRUE(against != nullptr);
  ASSERT_EQ(against->rows.size(), 2U) << "not against itself";
  EXPECT_EQ(against->rows[1].cells.size(), against->columns.size());
  const Document one = report_of("[cue]\nalgorithms = [\"tilt\"]\n" + drive("2 deg"));
  for (const Block& block : section(one, "Cue by cue").blocks) {
    if (const auto* table = std::get_if<Table>(&block); table != nullptr) {
      EXPECT_THAT(table->title, Not(HasSubstr("Against")));
    }
  }
}

TEST(CueingReport, ShowsWhatTheKnobsDo) {
  const std::string text = "[cue]\nalgorithms = [\"tilt\", \"classical\"]\nknobs = true\n" + drive("2 deg");
  Progress progress;
  const cueing::CueingStudy study = cueing::read_study(Study::parse(text, "rig.toml"), progress);
  const Document document = knob_report(study, cueing::cue(study, progress), "Veridyn");
  check(document);
  EXPECT_THAT(titles(document), testing::ElementsAre("Tilt", "Classical"));
  EXPECT_THAT(document.verdict.headline, HasSubstr("With tilt, "));
  const std::vector<Block>& blocks = section(document, "Classical").blocks;
  ASSERT_EQ(blocks.size(), 2U);
  const auto* table = std::get_if<Table>(&blocks[0]);
  const auto* figure = std::get_if<TimeSeries>(&blocks[1]);
  ASSERT_TRUE(table != nullptr && figure != nullptr);
  EXPECT_GE(table->rows.size(), figure->panels.size());
  EXPECT_EQ(figure->panels.front().lines.size(), 4U) << "the vehicle; half, as set, twice";
}

TEST(CueingReport, NamesWhatIsMostLikeTheDrive) {
  const Document one = report_of("[cue]\nalgorithms = [\"classical\"]\n" + drive("2 deg"));
  EXPECT_THAT(one.verdict.headline, HasSubstr("With classical: correlation"));
  EXPECT_THAT(titles(one), Not(Contains("Gain and phase")));
  EXPECT_EQ(titles(one).front(), "Score");
  const Document two = report_of("[cue]\nalgorithms = [\"tilt\", \"optimal\"]\n" + drive("2 deg"));
  EXPECT_THAT(two.verdict.headline, HasSubstr("Most like the drive is"));
}

TEST(CueingReport, SaysThatADriveIsNotFelt) {
  const Document still = report_of("[cue]\nalgorithms = [\"classical\"]\n" + drive("0.001 deg"));
  EXPECT_THAT(still.verdict.headline, HasSubstr("no force that is felt"));
  EXPECT_THAT(titles(still), Not(Contains("Score")));
  EXPECT_THAT(titles(still), Not(Contains("What is felt")));
  EXPECT_THAT(titles(still), Contains("What the platform does"));
}

}  // namespace
}  // namespace veridyn::report
