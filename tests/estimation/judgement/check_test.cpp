#include "veridyn/estimation/judgement/check.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "veridyn/estimation/judgement/check_table.hpp"

namespace veridyn::estimation {
namespace {

TEST(Checks, AreInTheOrderOfTheirEnumeration) {
  for (std::size_t i = 0; i < all_checks().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(all_checks()[i].check), i) << all_checks()[i].name;
}

TEST(Checks, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const CheckInfo& info : all_checks()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name << " stands twice";
    EXPECT_EQ(check_named(info.name), info.check);
  }
  EXPECT_EQ(check_named("a check of the future"), Check::kUnknown);
}

TEST(Checks, SayWhereTheirLimitsComeFrom) {
  for (const CheckInfo& info : all_checks()) {
    const Tolerance& t = info.tolerance;
    const bool has_limit = std::isfinite(t.low) || std::isfinite(t.high) || std::isfinite(t.lowest) ||
                           std::isfinite(t.highest) || !info.key.empty();
    if (has_limit)
      EXPECT_NE(info.source.kind, LimitSource::Kind::kLogic) << info.name << " has a limit without a source";
    if (info.source.kind != LimitSource::Kind::kLogic) EXPECT_FALSE(info.source.text.empty()) << info.name;
  }
}

TEST(Checks, HaveSentences) {
  for (const CheckInfo& info : all_checks())
    if (info.check != Check::kUnknown) EXPECT_FALSE(info.says.front().text.empty()) << info.name << " says nothing";
}

TEST(RowOf, TakesItsOutcomeAndTheLimitThatDecidedFromTheTable) {
  const Evidence fine = row_of(Check::kClippedSamples, "gyro", 0.001);
  EXPECT_EQ(fine.outcome, Outcome::kPassed);
  EXPECT_EQ(fine.limit, info_of(Check::kClippedSamples).tolerance.high);
  const Evidence bad = row_of(Check::kClippedSamples, "gyro", 0.2);
  EXPECT_EQ(bad.outcome, Outcome::kFailed);
  EXPECT_EQ(bad.limit, info_of(Check::kClippedSamples).tolerance.highest);
  const Evidence low = row_of(Check::kLateralAcceleration, "accel_y", 0.1);
  EXPECT_EQ(low.outcome, Outcome::kFailed);
  EXPECT_EQ(low.limit, info_of(Check::kLateralAcceleration).tolerance.lowest);
  EXPECT_EQ(row_of(Check::kAirspeedScale, "airspeed", 1.05, 0.02).outcome, Outcome::kPassed)
      << "1.05 is no more than three standard errors of 0.02 above 1.02";
}

TEST(LimitInWords, HasTheSenseOfTheTableOrOfWhatCameOfTheRow) {
  EXPECT_EQ(limit_in_words(row_of(Check::kClippedSamples, "gyro", 0.2)),
            fmt::format("at most {:.4g}", info_of(Check::kClippedSamples).tolerance.highest));
  EXPECT_EQ(limit_in_words(row_of(Check::kHoldOut, "yaw_rate", 0.9)), "at least 0.5");
  EXPECT_EQ(limit_in_words(row_of(Check::kAirspeedScale, "airspeed", 0.9, 0.03)), "0.98 to 1.02");
  EXPECT_EQ(limit_in_words(row_of(Check::kSamples, "recording", Outcome::kPassed)), "–");
  Evidence row = row_of(Check::kUnmodelledCoefficient, "Cm", Outcome::kPassed);
  row.value = 0.02;
  row.limit = 0.1;
  EXPECT_EQ(limit_in_words(row), "at most 0.1");
  EXPECT_EQ(limit_in_words(row, 100.0), "at most 10");
  row.value = 0.2;
  row.outcome = Outcome::kFailed;
  EXPECT_EQ(limit_in_words(row), "at most 0.1");
}

TEST(Says, FillsThePhraseOfTheTableWithTheRowsNumbers) {
  EXPECT_EQ(advice_of(row_of(Check::kHeldSamples, "gyro", 4.0)),
            "give the recording with the sensor's own stamps, one a measurement");
  EXPECT_EQ(advice_of(row_of(Check::kHeldSamples, "gyro", 1.0)), "") << "of a row that passed";
}

}  // namespace
}  // namespace veridyn::estimation
