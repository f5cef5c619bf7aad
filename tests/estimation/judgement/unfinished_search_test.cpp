#include "veridyn/estimation/judgement/unfinished_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/estimation/judgement/judgement.hpp"

namespace veridyn::estimation {
namespace {

TEST(UnfinishedSearch, LowersTheGradesByHowFarItGot) {
  const Judgement converged = judge(unfinished_rows({.converged = true, .left_out = {"profiles were not followed"}}));
  EXPECT_EQ(converged.parameters.grade, Grade::kWithCare);
  EXPECT_EQ(converged.prediction.grade, Grade::kWithCare);
  EXPECT_THAT(converged.parameters.decided_by,
              testing::ElementsAre("the search was interrupted after it had converged: profiles were not followed"));

  const Judgement stopped = judge(unfinished_rows({.left_out = {"one thing", "another"}}));
  EXPECT_EQ(stopped.parameters.grade, Grade::kNo);
  EXPECT_EQ(stopped.prediction.grade, Grade::kWithCare);
  EXPECT_THAT(stopped.parameters.decided_by.front(), testing::EndsWith("where it stood: one thing; another"));
  EXPECT_EQ(stopped.data.grade, Grade::kNotJudged);  // it says nothing of the recording
}

TEST(UnfinishedSearch, SaysNothingOfOneThatEnded) {
  EXPECT_TRUE(unfinished_rows({}).empty());
  EXPECT_TRUE(unfinished_rows({.converged = true}).empty());
}

}  // namespace
}  // namespace veridyn::estimation
