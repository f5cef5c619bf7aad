#include "veridyn/report/parts/posterior_section.hpp"

#include <gtest/gtest.h>

#include <variant>

namespace veridyn::report {
namespace {

TEST(PosteriorSection, HasATableAHistogramOfEachAndThePairThatGoesTogether) {
  estimation::PosteriorSample sample;
  sample.ensemble.draws.resize(400, 2);
  for (Eigen::Index k = 0; k < 400; ++k) {
    const double x = 0.01 * static_cast<double>(k % 20);
    sample.ensemble.draws.row(k) << x, 2.0 * x;
  }
  sample.ensemble.converged = true;
  sample.parameters = {{.parameter = 1, .name = "a", .unit = "N", .mean = 0.095, .sd = 0.058, .low = 0.0, .high = 0.19},
                       {.parameter = 0, .name = "b", .unit = "1", .mean = 0.19, .sd = 0.115, .low = 0.0, .high = 0.38}};
  std::vector<estimation::Parameter> own(2);
  own[0].value = 0.2;
  own[0].sigma = 0.1;
  own[1].value = 0.1;
  own[1].sigma = 0.05;
  const Section section = posterior_section(sample, own);
  ASSERT_EQ(section.blocks.size(), 5u);
  EXPECT_EQ(std::get<Paragraph>(section.blocks[0]).tone, Tone::kPlain);
  EXPECT_EQ(std::get<Table>(section.blocks[1]).rows.size(), 2u);
  const auto& histogram = std::get<XYPlot>(section.blocks[2]);
  ASSERT_EQ(histogram.series.size(), 2u);
  // Its area is one.
  double area = 0.0;
  for (std::size_t i = 1; i < histogram.series[0].x.size(); ++i)
    area += histogram.series[0].y[i] * (histogram.series[0].x[i] - histogram.series[0].x[i - 1]);
  EXPECT_NEAR(area, 1.0, 1e-12);
  EXPECT_EQ(std::get<XYPlot>(section.blocks[4]).x.label, "a");
  Document document{.title = "posterior", .sections = {section}};
  check(document);

  sample.ensemble.converged = false;
  EXPECT_EQ(std::get<Paragraph>(posterior_section(sample, own).blocks[0]).tone, Tone::kWarning);
  EXPECT_TRUE(posterior_section({}, own).blocks.empty());
}

}  // namespace
}  // namespace veridyn::report
