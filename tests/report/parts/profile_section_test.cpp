#include "veridyn/report/parts/profile_section.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace veridyn::report {
namespace {

/// Two parameters of a linear model: the profile of `a` is a parabola about 1 of sigma 0.1, along which `b` goes by its
/// own sigma for each one of a's. Below 0.9 there is no a.
estimation::ProfileResult linear_profile() {
  estimation::ProfileResult result;
  result.threshold = 3.84;
  estimation::ParameterProfile p{.parameter = 0, .name = "a", .unit = "N", .value = 1.0, .low_bound = 0.9};
  for (const double sigmas : {-1.0, 0.0, 1.0, 2.0, 3.0}) {
    p.points.push_back({.value = 1.0 + 0.1 * sigmas,
                        .statistic = sigmas * sigmas,
                        .theta = Eigen::Vector3d(1.0 + 0.1 * sigmas, 5.0 + 0.3 * sigmas, 2.0 - 0.1 * sigmas)});
  }
  p.low_end = estimation::ProfileEnd::kOpen;
  p.high_end = estimation::ProfileEnd::kClosed;
  p.high = 1.196;
  result.profiles = {p};
  return result;
}

std::vector<estimation::Parameter> estimated() {
  const auto parameter = [](const char* name, double value, double sigma) {
    estimation::Parameter p;
    p.name = name;
    p.value = value;
    p.sigma = sigma;
    return p;
  };
  return {parameter("a", 1.0, 0.1), parameter("b", 5.0, 0.3), parameter("c", 2.0, 1.0)};
}

// Between fits the signed root of the statistic goes on a line, which of a parabola is the parabola.
TEST(ProfileSection, DrawsAParabolaOfThreeFits) {
  const Section section = profile_section(linear_profile(), estimated());
  ASSERT_EQ(section.blocks.size(), 4U);  // what it is, the table, the plot, the valley
  const auto& plot = std::get<XYPlot>(section.blocks[2]);
  ASSERT_EQ(plot.series.size(), 3U);
  for (const XYSeries& curve : {plot.series[0], plot.series[1]}) {
    EXPECT_GT(curve.x.size(), 20U) << curve.name;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      EXPECT_NEAR(curve.y[i], std::pow((curve.x[i] - 1.0) / 0.1, 2), 1e-9) << curve.name;
      EXPECT_LE(curve.y[i], 2.0 * 3.84 + 1e-9);
      EXPECT_GE(curve.x[i], 0.9 - 1e-12) << "below its bound there is nothing to draw";
    }
  }
  EXPECT_EQ(plot.series[2].x.size(), 4U) << "the fit at three sigma is beyond the plot";
  // The threshold, and the bound that nothing excludes.
  ASSERT_EQ(plot.guides.size(), 2U);
  EXPECT_EQ(plot.guides[0].value, 3.84);
  EXPECT_EQ(plot.guides[1].value, 0.9);
  const auto& row = std::get<Table>(section.blocks[1]).rows.at(0);
  EXPECT_EQ(row.cells[2].status, Status::kCaution) << "open below";
  EXPECT_EQ(row.cells[3].status, Status::kNone);
}

TEST(ProfileSection, ShowsThePairThatMakesUpForEachOther) {
  const Section section = profile_section(linear_profile(), estimated());
  const auto& valley = std::get<XYPlot>(section.blocks.back());
  EXPECT_EQ(valley.x.label, "a");
  EXPECT_EQ(valley.y.label, "b") << "c goes by a tenth of its sigma only";
  EXPECT_EQ(valley.series[0].x.size(), 4U);
  EXPECT_EQ(valley.series[1].x.size(), 3U) << "two sigma is beyond 95 %";
}

TEST(ProfileSection, SaysWhatWentOtherwise) {
  estimation::ProfileResult result = linear_profile();
  result.gain = 0.5;
  result.message = "cut short";
  const Section section = profile_section(result, estimated(), "a note");
  const auto warnings = std::ranges::count_if(section.blocks, [](const Block& block) {
    const auto* p = std::get_if<Paragraph>(&block);
    return p != nullptr && p->tone == Tone::kWarning;
  });
  EXPECT_EQ(warnings, 2);
  EXPECT_EQ(section.blocks.size(), 7U);
  EXPECT_TRUE(profile_section({}, estimated()).blocks.empty());
}

}  // namespace
}  // namespace veridyn::report
