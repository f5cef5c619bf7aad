#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "tests/vehicle/similarity/builtin_subject.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"

namespace veridyn::vehicle {
namespace {

using testing::subject_of;

// The published table: stiffnesses 100 and 200 where 96 and 192 would be similar, I_x 0.188 for 0.1888.
TEST(Similarity, FindsTheRoundingOfThePublishedModelAndNothingElse) {
  const SimilarityReport report = compare(subject_of("reference"), subject_of("reference_1to5"));
  const std::vector<GroupComparison> found = report.mismatches();
  ASSERT_EQ(found.size(), 3U) << report.message();
  EXPECT_EQ(found[0].parameter, "C_f");
  EXPECT_EQ(found[0].formula, "C_f L/(m u^2)");
  EXPECT_NEAR(found[0].mismatch_percent, 100.0 * (100.0 / 96.0 - 1.0), 1e-9);
  EXPECT_EQ(found[1].parameter, "C_r");
  EXPECT_NEAR(found[1].mismatch_percent, 100.0 * (200.0 / 192.0 - 1.0), 1e-9);
  EXPECT_EQ(found[2].parameter, "I_x");
  EXPECT_EQ(found[2].formula, "I_x/(m L^2)");
  EXPECT_NEAR(found[2].mismatch_percent, -0.4, 0.05);
  EXPECT_FALSE(report.similar_without_gravity());
  // All others are exact but for the rounding of double.
  EXPECT_EQ(std::ranges::count_if(report.groups, [](const auto& g) { return std::abs(g.mismatch_percent) > 1e-9; }), 3);
  EXPECT_EQ(report.gravity.formula, "g L/u^2");
  EXPECT_NEAR(report.gravity.prototype, 0.0552, 5e-5);
  EXPECT_NEAR(report.gravity.model, 0.2758, 5e-5);  // 9.80665 * 0.45/16 = 0.27581; printed 0.2759 is for g = 9.81
  EXPECT_NEAR(report.gravity.mismatch_percent, 400.0, 1e-9);
  EXPECT_FALSE(report.gravity_changes.empty());
  EXPECT_NE(report.gravity_changes.front().find("forces scale by 1/625 but weight by 1/125"), std::string::npos);
}

// What the mismatch does to the response: stiffer tyres by 1/24 on both axles lower the understeer gradient by 4 %.
TEST(Similarity, SaysWhatAMismatchDoesToTheResponse) {
  const SimilarityReport report = compare(subject_of("reference"), subject_of("reference_1to5"));
  const auto find = [&](std::string_view name) {
    return *std::ranges::find_if(report.behaviour, [&](const auto& one) { return one.name == name; });
  };
  EXPECT_NEAR(find("understeer gradient").change_percent, -4.0, 1e-9);
  EXPECT_NEAR(find("heave frequency").change_percent, 0.0, 1e-9);
  EXPECT_NEAR(find("lateral acceleration at lift-off of a rigid vehicle").change_percent, 400.0, 1e-9);
  EXPECT_NEAR(find("roll frequency").change_percent, 100.0 * (std::sqrt(0.1888 / 0.188) - 1.0), 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
