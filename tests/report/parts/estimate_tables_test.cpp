#include "veridyn/report/parts/estimate_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {
namespace {

TEST(ParameterRow, ShowsTheParameterInTheUnitOfTheReader) {
  const estimation::Parameter p{"bias", 0.02, 0.001, 0.018, 0.022, "rad", estimation::ParameterStatus::kIdentified};
  const Row row = parameter_row(p, 100.0, "crad");
  const std::vector<Column> columns = parameter_columns(false);
  ASSERT_EQ(row.cells.size(), columns.size());
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < columns.size(); ++k) texts.push_back(cell_text(row.cells[k], columns[k]));
  EXPECT_THAT(texts, testing::ElementsAre("bias", "2.00", "0.10", "1.80", "2.20", "crad", "identified"));
  EXPECT_EQ(row.status, Status::kIdentified);
}

TEST(ParameterColumns, HaveTheTruthOnlyWhereItIsKnown) {
  EXPECT_EQ(parameter_columns(true).size(), parameter_columns(false).size() + 1);
  EXPECT_EQ(parameter_columns(true).back().name, "truth");
}

TEST(EvidenceRow, ShowsValueAndLimitInTheUnitAndSenseOfTheReader) {
  using estimation::Check;
  const auto shown = [](const estimation::Evidence& row, bool said = false) {
    const std::vector<Column> columns = evidence_columns();
    const std::vector<Cell> cells = evidence_row(row, said).cells;
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < columns.size(); ++k) texts.push_back(cell_text(cells[k], columns[k]));
    return texts;
  };
  EXPECT_THAT(shown(estimation::row_of(Check::kPlausibleUndersteer, "understeer_gradient", 0.02, 0.001)),
              testing::ElementsAre("plausibility of understeer_gradient", "1.15 ± 0.057", "-2.865\u00a0to\u00a011.46",
                                   "deg/g", "the understeer is 1.1 deg/g", "parameters"));
  const std::vector<std::string> clipped =
      shown(estimation::row_of(Check::kClippedSamples, "gyro", 0.2).with("channel", std::string("gyro")), true);
  EXPECT_THAT(clipped[2], testing::StartsWith("at\u00a0most\u00a0"));
  EXPECT_EQ(clipped[4], "see the top of this page");
}

TEST(ChangeRow, TellsAMovedMeanFromGrownNoise) {
  const estimation::Change moved{estimation::ChangeKind::kMean, 12.0, 10.5, 3.14};
  const estimation::Change grown{estimation::ChangeKind::kSpread, 12.0, 10.5, 3.14};
  EXPECT_EQ(change_words(moved), "innovation moved by 3.1 sigma");
  EXPECT_EQ(change_words(grown), "innovation grew 3.1 times");
  EXPECT_EQ(change_words({estimation::ChangeKind::kParameter, 12.0, 10.5, -0.4}), "moved to 0.6 times its value");
  EXPECT_EQ(change_row("C_f", moved).cells.size(), change_columns("what", "how").size());
}

}  // namespace
}  // namespace veridyn::report
