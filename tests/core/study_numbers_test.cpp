#include "veridyn/core/study_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn {
namespace {

template <typename Read>
std::string refusal(const std::string& text, const Read& read) {
  const Study study = Study::parse(text, "s.toml");
  try {
    static_cast<void>(read(study.root()));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StudyNumbers, CountsAreWholeAndWithinTheirRange) {
  const auto read = [](const StudyTable& t) { return count_or(t, "samples", 7, 2); };
  EXPECT_EQ(read(Study::parse("samples = 3\n", "s.toml").root()), 3U);
  EXPECT_EQ(read(Study::parse("", "s.toml").root()), 7U);
  EXPECT_EQ(refusal("samples = 1\n", read), "s.toml:1: samples: = 1 must be from 2 to 10000000");
  EXPECT_THAT(refusal("samples = 10000001\n", read), testing::HasSubstr("must be from 2 to 10000000"));
}

TEST(StudyNumbers, SharesAreAboveZeroAndAtMostTheirLimit) {
  const auto read = [](const StudyTable& t) { return share_or(t, "range", 0.1, 0.5); };
  EXPECT_EQ(read(Study::parse("range = \"5 %\"\n", "s.toml").root()), 0.05);
  EXPECT_EQ(read(Study::parse("", "s.toml").root()), 0.1);
  EXPECT_EQ(read(Study::parse("range = 0.5\n", "s.toml").root()), 0.5);
  EXPECT_THAT(refusal("range = 0\n", read), testing::HasSubstr("= 0 must be above 0 and at most 0.5"));
  EXPECT_THAT(refusal("range = nan\n", read), testing::HasSubstr("expected a finite number"));
  EXPECT_THAT(refusal("range = 0.6\n", read), testing::HasSubstr("= 0.6 must be above 0"));
}

}  // namespace
}  // namespace veridyn
