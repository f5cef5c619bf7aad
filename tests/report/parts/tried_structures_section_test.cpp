#include "veridyn/report/parts/tried_structures_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {
namespace {

estimation::StructureTrial fitted_trial(std::string name, double gain, double stiffness) {
  return {.name = std::move(name),
          .log_likelihood_gain = gain,
          .needed_gain = 25.0,
          .holdout_quantity = "yaw_rate",
          .holdout_rmse = 0.25 * kDegree,
          .holdout_unit = "rad/s",
          .parameters = {{.name = "C_f", .value = stiffness, .sigma = 800.0, .unit = "N/rad"}}};
}

/// Three structures of which the second is taken and the third could not be fitted.
estimation::Estimate three_trials() {
  estimation::Estimate estimate;
  estimate.structure = "roll";
  estimate.structure_reason = "structure: roll, which makes the drive likelier";
  estimate.tried_structures = {fitted_trial("bicycle", 0.0, 44000.0),
                               fitted_trial("roll", 412.3, 57000.0),
                               {.name = "roll and relaxation", .obstacle = "the search diverged"}};
  estimate.tried_structures[0].needed_gain = kNaN;
  estimate.tried_structures[1].taken = true;
  return estimate;
}

std::vector<std::string> paragraphs(const Section& section) {
  std::vector<std::string> found;
  for (const Block& block : section.blocks)
    if (const auto* paragraph = std::get_if<Paragraph>(&block)) found.push_back(paragraph->text);
  return found;
}

/// The table; an empty one where there is none.
Table structure_table(const Section& section) {
  for (const Block& block : section.blocks)
    if (const auto* table = std::get_if<Table>(&block)) return *table;
  return {};
}

/// What the cells of a row say under the column of this name and group.
std::string shown_cell(const Table& table, std::size_t row, const std::string& column, const std::string& group = {}) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == column && table.columns[i].group == group)
      return cell_text(table.rows[row].cells[i], table.columns[i]);
  }
  return "no such column";
}

TEST(TriedStructuresSection, ShowsWhatEachGainedAndWhatItMakesOfTheParameters) {
  const Table table = structure_table(tried_structures_section(three_trials()));
  ASSERT_EQ(table.rows.size(), 3U);
  for (const Row& row : table.rows) EXPECT_EQ(row.cells.size(), table.columns.size());
  EXPECT_EQ(shown_cell(table, 0, "structure"), "bicycle");
  EXPECT_EQ(shown_cell(table, 1, "gained", "log-likelihood"), "412.3");
  EXPECT_EQ(shown_cell(table, 0, "needed", "log-likelihood"), "–");
  EXPECT_EQ(shown_cell(table, 1, "needed", "log-likelihood"), "25.0");
  EXPECT_EQ(shown_cell(table, 1, "yaw_rate", "hold-out rms"), "0.250");  // deg/s
  EXPECT_EQ(shown_cell(table, 0, "value", "C_f [N/rad]"), "44000");
  EXPECT_EQ(shown_cell(table, 1, "value", "C_f [N/rad]"), "57000");
  EXPECT_EQ(shown_cell(table, 1, "sigma", "C_f [N/rad]"), "800");
}

TEST(TriedStructuresSection, MarksTheOneThatIsTakenAndSaysWhy) {
  const Section section = tried_structures_section(three_trials());
  const Table table = structure_table(section);
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[0].cells[1].status, Status::kNone);
  EXPECT_EQ(table.rows[1].cells[1].status, Status::kGood);
  EXPECT_EQ(table.rows[1].cells[1].text, "taken");
  EXPECT_THAT(paragraphs(section), testing::Contains("Structure: roll, which makes the drive likelier."));
}

TEST(TriedStructuresSection, SaysWhatKeptAStructureFromBeingTaken) {
  const Section section = tried_structures_section(three_trials());
  EXPECT_THAT(paragraphs(section), testing::ElementsAre(testing::_, "roll and relaxation: the search diverged"));
  const Table table = structure_table(section);
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[2].cells[1].status, Status::kCaution);
  EXPECT_EQ(shown_cell(table, 2, "value", "C_f [N/rad]"), "–");
}

TEST(TriedStructuresSection, HasItsColumnsFromTheFirstThatWasFitted) {
  estimation::Estimate estimate = three_trials();
  estimate.tried_structures[0] = {.name = "bicycle", .obstacle = "the search diverged"};
  const Table table = structure_table(tried_structures_section(estimate));
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(shown_cell(table, 0, "value", "C_f [N/rad]"), "–");
  EXPECT_EQ(shown_cell(table, 1, "value", "C_f [N/rad]"), "57000");
}

TEST(TriedStructuresSection, NamesAStructureThatTheStudyFixesAndComparesItWithNothing) {
  estimation::Estimate estimate = three_trials();
  estimate.structure_reason.clear();
  estimate.tried_structures = {estimate.tried_structures[1]};
  const Section section = tried_structures_section(estimate);
  EXPECT_THAT(paragraphs(section), testing::ElementsAre("The study fixes it: roll."));
  EXPECT_TRUE(structure_table(section).rows.empty());
}

TEST(TriedStructuresSection, IsEmptyWhereNoneWasTried) { EXPECT_TRUE(tried_structures_section({}).blocks.empty()); }

}  // namespace
}  // namespace veridyn::report
