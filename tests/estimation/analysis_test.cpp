#include "veridyn/estimation/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::estimation {
namespace {

TEST(MethodResult, FindsItsParametersByName) {
  const MethodResult gtls{.method = "GTLS", .usable = true, .parameters = {{.name = "Cm_alpha", .value = -0.5}}};
  ASSERT_NE(gtls.find("Cm_alpha"), nullptr);
  EXPECT_DOUBLE_EQ(gtls.find("Cm_alpha")->value, -0.5);
  EXPECT_EQ(gtls.find("Cm_q"), nullptr);
}

TEST(Analysis, KnowsTheTruthOfSimulatedRecordingsOnly) {
  Analysis analysis;
  EXPECT_TRUE(std::isnan(analysis.true_value("C_f")));
  analysis.truth["C_f"] = 5e4;
  EXPECT_DOUBLE_EQ(analysis.true_value("C_f"), 5e4);
}

}  // namespace
}  // namespace veridyn::estimation
