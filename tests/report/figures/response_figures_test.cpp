#include "veridyn/report/figures/response_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::report {
namespace {

using cueing::Cue;
using testing::HasSubstr;

/// An algorithm with the phases of a long delay, wrapped as they are measured.
cueing::CueingResult measured() {
  cueing::AlgorithmResult a;
  a.run.algorithm = "late";
  a.response[Cue::kSway] = {{.frequency = 1.0, .gain = 1.0, .phase = -40.0 * kDegree},
                            {.frequency = 4.0, .gain = 0.8, .phase = -130.0 * kDegree},
                            {.frequency = 10.0, .gain = 2.0, .phase = 138.0 * kDegree}};
  cueing::CueingResult result;
  result.algorithms.push_back(std::move(a));
  return result;
}

std::vector<XYPlot> plots_of(const Section& section) {
  std::vector<XYPlot> plots;
  for (const Block& block : section.blocks) {
    if (const auto* plot = std::get_if<XYPlot>(&block)) plots.push_back(*plot);
  }
  return plots;
}

TEST(ResponseSection, PhasesGoOnBeyondHalfATurn) {
  const std::vector<XYPlot> plots = plots_of(response_section({}, measured()));
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_TRUE(plots[0].log_x && plots[1].log_x);
  ASSERT_EQ(plots[1].series.size(), 2U) << "a line, and markers where it was measured";
  EXPECT_EQ(plots[1].series[1].style, Style::kMarkers);
  EXPECT_NEAR(plots[1].series[0].y[2], -222.0, 1e-9);
  EXPECT_TRUE(plots[0].areas.empty());
}

TEST(ResponseSection, PhasesAreAsTheMaskTakesThem) {
  cueing::ResponseStudy study;
  study.mask[Cue::kSway] = {{.frequency = 1.0, .least_phase = -kPi / 2.0}, {.frequency = 10.0, .least_phase = -kPi}};
  const std::vector<XYPlot> plots = plots_of(response_section(study, measured()));
  EXPECT_NEAR(plots[1].series[0].y[2], 138.0, 1e-9);
  ASSERT_EQ(plots[1].areas.size(), 1U);
  EXPECT_NEAR(plots[1].areas[0].low.back(), -180.0, 1e-9);
  EXPECT_FALSE(std::isfinite(plots[1].areas[0].high.back())) << "no upper limit";
  EXPECT_TRUE(plots[0].areas.empty()) << "the gain has no limits";
}

TEST(ResponseSection, TheMaskGoesStraightOverTheFrequency) {
  cueing::ResponseStudy study;
  study.mask[Cue::kSway] = {{.frequency = 0.3, .least_gain = 0.2, .most_gain = 1.2},
                            {.frequency = 8.0, .least_gain = 0.02, .most_gain = 1.2}};
  const std::vector<XYPlot> plots = plots_of(response_section(study, measured()));
  ASSERT_EQ(plots[0].areas.size(), 1U);
  const XYArea& area = plots[0].areas[0];
  EXPECT_NEAR(area.x.front(), 0.3, 1e-12);
  EXPECT_NEAR(area.x.back(), 8.0, 1e-12);
  for (std::size_t k = 0; k < area.x.size(); ++k) {
    EXPECT_NEAR(area.low[k], 0.2 - 0.18 * (area.x[k] - 0.3) / 7.7, 1e-12);
    EXPECT_NEAR(area.high[k], 1.2, 1e-12);
  }
}

TEST(ResponseSection, SaysWhatIsOutsideTheMask) {
  const auto texts = [](const Section& section) {
    std::string all;
    for (const Block& block : section.blocks) {
      if (const auto* list = std::get_if<List>(&block)) {
        for (const std::string& item : list->items) all += item + "\n";
      } else if (const auto* paragraph = std::get_if<Paragraph>(&block)) {
        all += paragraph->text + "\n";
      }
    }
    return all;
  };
  cueing::ResponseStudy study;
  study.mask[Cue::kSway] = {{.frequency = 1.0, .most_gain = 1.5}, {.frequency = 20.0, .most_gain = 1.5}};
  cueing::CueingResult result = measured();
  EXPECT_THAT(texts(response_section(study, result)), HasSubstr("within the mask"));
  auto& outside = result.algorithms[0].outside_mask[Cue::kSway];
  outside = cueing::outside(result.algorithms[0].response[Cue::kSway], study.mask[Cue::kSway]);
  EXPECT_THAT(texts(response_section(study, result)), HasSubstr("sway, late: outside the mask at 10 rad/s"));
}

}  // namespace
}  // namespace veridyn::report
