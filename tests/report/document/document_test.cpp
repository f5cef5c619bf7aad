#include "veridyn/report/document/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

TEST(SectionIds, AreDifferentAndSafeInALink) {
  const Document document{.sections = {{.title = "What was flown?"},
                                       {.title = "What was flown?"},
                                       {.title = "<\"'>"},
                                       {.title = "x", .id = "what-was-flown-2"},
                                       {.title = "Report"}}};
  EXPECT_THAT(section_ids(document),
              testing::ElementsAre("what-was-flown", "what-was-flown-2", "section", "what-was-flown-2-2", "report-2"));
}

TEST(WithCaptionsOnce, LeavesACaptionAtTheFirstThatHasIt) {
  const Document document = with_captions_once(
      {.lead = {XYPlot{.caption = "one"}},
       .sections = {{.blocks = {Paragraph{"text"}, Table{.caption = "two"}, XYPlot{.caption = "one"}}},
                    {.blocks = {Table{.caption = "two"}, Table{.caption = "three"}}}}});
  EXPECT_EQ(std::get<XYPlot>(document.lead[0]).caption, "one");
  EXPECT_EQ(std::get<Table>(document.sections[0].blocks[1]).caption, "two");
  EXPECT_EQ(std::get<XYPlot>(document.sections[0].blocks[2]).caption, "");
  EXPECT_EQ(std::get<Table>(document.sections[1].blocks[0]).caption, "");
  EXPECT_EQ(std::get<Table>(document.sections[1].blocks[1]).caption, "three");
}

TEST(Status, ReadsBackItsName) {
  for (const Status status :
       {Status::kIdentified, Status::kInsignificant, Status::kNotExcited, Status::kRejected, Status::kFixed}) {
    EXPECT_EQ(status_from_name(status_name(status)), status);
  }
  EXPECT_EQ(status_name(Status::kNotExcited), "not_excited");
  EXPECT_EQ(status_label(Status::kNotExcited), "not excited");
  EXPECT_EQ(status_from_name("no such word"), Status::kNone);
}

TEST(Verdict, HasAWordForEveryLevel) {
  EXPECT_EQ(verdict_word({.level = Level::kGood}), "Usable");
  EXPECT_EQ(verdict_word({.level = Level::kCaution}), "Use with care");
  EXPECT_EQ(verdict_word({.level = Level::kBad}), "Do not use");
  EXPECT_EQ(verdict_word({.level = Level::kBad, .word = "Closed loop"}), "Closed loop");
}

TEST(CheckDeathTest, NamesWhatDoesNotFit) {
  EXPECT_DEATH(check({.sections = {{.blocks = {Table{.columns = {{.name = "a"}}, .rows = {{.cells = {}}}}}}}}),
               "row.cells.size");
  EXPECT_DEATH(check({.sections = {{.blocks = {TimeSeries{.samples = {0, 1},
                                                          .panels = {{.lines = {{.name = "a", .y = {1}}}}}}}}}}),
               "line.y.size");
  EXPECT_DEATH(check({.sections = {{.blocks = {TimeSeries{.windows = {{0, 10}, {5, 20}}}}}}}), "windows");
}

}  // namespace
}  // namespace veridyn::report
