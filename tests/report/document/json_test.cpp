#include "veridyn/report/document/json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/report/sample_document.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json parsed(const Document& document, const JsonOptions& options = {}) {
  return json::parse(to_json(document, options));
}

json first_block(Block block, const JsonOptions& options = {}) {
  return parsed({.sections = {{.title = "s", .blocks = {std::move(block)}}}}, options)["sections"][0]["blocks"][0];
}

TEST(ToJson, HoldsEveryKindOfBlock) {
  const json report = parsed(sample_document());
  EXPECT_EQ(report["format"], "veridyn-report");
  EXPECT_EQ(report["verdict"]["level"], "caution");
  EXPECT_EQ(report["verdict"]["word"], "Use with care");
  std::vector<std::string> kinds;
  for (const json& section : report["sections"]) {
    EXPECT_FALSE(section["id"].get<std::string>().empty());
    for (const json& block : section["blocks"]) kinds.push_back(block["kind"]);
  }
  for (const char* kind :
       {"paragraph", "list", "facts", "table", "time_series", "xy", "intervals", "matrix", "scene"}) {
    EXPECT_THAT(kinds, testing::Contains(kind));
  }
}

TEST(ToJson, HoldsTheFirstScreenAndWhatIsInsideOfASection) {
  const json report = parsed({.lead = {Paragraph{"measured against model"}}, .sections = {{.inside = "2 failed"}}});
  EXPECT_EQ(report["lead"][0]["text"], "measured against model");
  EXPECT_EQ(report["sections"][0]["inside"], "2 failed");
}

TEST(ToJson, HoldsTheWindowsOfAFigure) {
  const json figure = first_block(TimeSeries{.windows = {{.from = 1.0, .to = 2.5}, {.from = 9.0, .to = 10.0}}});
  ASSERT_EQ(figure["windows"].size(), 2U);
  EXPECT_EQ(figure["windows"][0]["from"], 1.0);
  EXPECT_EQ(figure["windows"][0]["to"], 2.5);
}

TEST(ToJson, HoldsASceneAsThePageReadsIt) {
  Scene scene{.samples = {0.0, 1.0},
              .shapes = {{.kind = SceneShape::Kind::kActuator,
                          .tone = SceneTone::kLink,
                          .points = {{1.0, 2.0, 3.0, false}, {4.0, 5.0, 6.0, true}},
                          .size = 0.5}},
              .joints = {{.name = "pitch", .unit = "deg", .turns = true, .direction = {0.0, -1.0, 0.0}, .scale = 0.5}},
              .motions = {{.name = "a", .values = {{3.0, kNaN}}}}};
  const json block = first_block(scene);
  EXPECT_EQ(block["shapes"][0]["kind"], "actuator");
  EXPECT_EQ(block["shapes"][0]["tone"], "link");
  EXPECT_EQ(block["shapes"][0]["points"], json::parse("[[1.0, 2.0, 3.0, 0], [4.0, 5.0, 6.0, 1]]"));
  EXPECT_EQ(block["joints"][0]["direction"], json::parse("[0.0, -1.0, 0.0]"));
  EXPECT_EQ(block["motions"][0]["values"][0][0], 3.0);
  EXPECT_TRUE(block["motions"][0]["values"][0][1].is_null());
}

TEST(ToJson, AnAreaWithoutAnEndHasNoneInThePage) {
  const json block =
      first_block(XYPlot{.areas = {{.name = "mask", .x = {1.0}, .low = {0.5}, .high = {kInfinity}}}, .log_x = true});
  EXPECT_EQ(block["log_x"], true);
  EXPECT_EQ(block["areas"][0]["low"][0], 0.5);
  EXPECT_TRUE(block["areas"][0]["high"][0].is_null());
}

TEST(ToJson, CannotEndTheScriptElementThatItStandsIn) {
  const std::string text = to_json({.title = kHostileText, .sections = {{.title = kHostileText}}});
  for (const char c : {'<', '>', '&'}) EXPECT_EQ(text.find(c), std::string::npos);
  EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; }));
  EXPECT_THAT(text, HasSubstr("\\u2028"));
  EXPECT_EQ(json::parse(text)["title"], kHostileText);
}

TEST(ToJson, ReplacesBytesThatAreNoText) {
  EXPECT_EQ(parsed({.title = "log\xFF\xC3(name\xE2\x82"})["title"], "log\xEF\xBF\xBD\xEF\xBF\xBD(name\xEF\xBF\xBD");
}

// Such a p-value ended a run while its report was written.
TEST(ToJson, WritesNumbersThatAreHardlyMoreThanZero) {
  const json figure = first_block(TimeSeries{
      .samples = {0, 1}, .panels = {{.label = "p", .unit = "1", .lines = {{.name = "p", .y = {3e-310, 1.0}}}}}});
  const json& y = figure["panels"][0]["lines"][0]["y"];
  EXPECT_LT(y[0].get<double>(), 1e-300);
  EXPECT_EQ(y[1], 1.0);
}

TEST(ToJson, WritesWhatIsNoNumberAsNull) {
  const json figure = first_block(
      TimeSeries{.samples = {0, 1, 2},
                 .panels = {{.label = "a",
                             .unit = "m/s",
                             .lines = {{.name = "b",
                                        .y = {1.0, kNaN, -INFINITY},
                                        .band = Band{.low = {0, kNaN, 0}, .high = {2, kNaN, INFINITY}}}}}}});
  const json& line = figure["panels"][0]["lines"][0];
  EXPECT_EQ(line["y"], json::parse("[1.0, null, null]"));
  EXPECT_EQ(line["band"]["high"], json::parse("[2.0, null, null]"));
  EXPECT_EQ(figure["xs"], json::parse("[[0.0, 1.0, 2.0]]"));
  EXPECT_EQ(line["x"], 0);
  EXPECT_EQ(line["band"]["x"], 0);
  EXPECT_EQ(figure["footnote"], "");
}

TEST(ToJson, KeepsOwnAbscissaeOfALineApart) {
  const json figure = first_block(
      TimeSeries{.samples = {0, 1, 2},
                 .panels = {{.lines = {{.name = "a", .y = {1, 2, 3}}, {.name = "b", .y = {5, 6}, .x = {0.5, 1.5}}}}}});
  EXPECT_EQ(figure["xs"], json::parse("[[0.0, 1.0, 2.0], [0.5, 1.5]]"));
  EXPECT_EQ(figure["panels"][0]["lines"][1]["x"], 1);
}

TEST(ToJson, SaysInTheFootnoteWhatItLeftOut) {
  TimeSeries figure{.panels = {{.lines = {{.name = "a"}}}}};
  for (int k = 0; k < 5000; ++k) {
    figure.samples.push_back(k);
    figure.panels[0].lines[0].y.push_back(std::sin(k));
  }
  const json block = first_block(figure, {.points_per_line = 100});
  EXPECT_LE(block["panels"][0]["lines"][0]["y"].size(), 100u);
  EXPECT_THAT(block["footnote"].get<std::string>(), HasSubstr("of 5000 samples"));
}

TEST(ToJson, FillsCellsWithTextNumberAndStatus) {
  const json table =
      first_block(Table{.columns = {{.name = "a"}, {.name = "b", .unit = "m"}, {.name = "c"}},
                        .rows = {{.cells = {text_cell("x"), number_cell(1.0 / 3.0), status_cell(Status::kNotExcited)},
                                  .status = Status::kNotExcited}}});
  EXPECT_EQ(
      table["rows"][0]["cells"],
      json::parse(R"([{"t": "x"}, {"t": "0.3333", "v": 0.333333333}, {"t": "not excited", "s": "not_excited"}])"));
  EXPECT_EQ(table["rows"][0]["status"], "not_excited");
  EXPECT_EQ(table["columns"][1]["align"], "right");
}

// An hour at 50 Hz with thirty lines, two thirds of them with bands.
TEST(ToJson, KeepsAnHourUnderTenMegabytes) {
  TimeSeries figure;
  std::vector<double> y;
  std::vector<double> low;
  std::vector<double> high;
  for (int k = 0; k < 180'000; ++k) {
    figure.samples.push_back(0.02 * k);
    y.push_back(20.0 + 3.0 * std::sin(0.013 * k) + 0.2 * std::sin(1.7 * k));
    low.push_back(y.back() - 0.31);
    high.push_back(y.back() + 0.32);
  }
  for (int k = 0; k < 30; ++k) {
    figure.panels.push_back(
        {.label = "p", .lines = {{.name = "a", .y = y, .band = k % 3 == 0 ? std::optional<Band>{} : Band{low, high}}}});
    for (double& each : y) each += 0.001 * k;
  }
  const std::string text = to_json({.sections = {{.title = "s", .blocks = {figure}}}});
  EXPECT_LT(text.size(), 10'000'000u);
  RecordProperty("bytes", static_cast<int>(text.size()));
}

}  // namespace
}  // namespace veridyn::report
