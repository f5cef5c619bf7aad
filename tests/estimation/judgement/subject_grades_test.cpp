#include "veridyn/estimation/judgement/subject_grades.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Judgement judgement_of(Grade parameters, Grade prediction) {
  Judgement j;
  j.data.grade = Grade::kYes;
  j.parameters.grade = parameters;
  j.prediction.grade = prediction;
  return j;
}

/// What is said of a subject that was written with these grades and is read again.
std::string warning_of(Grade parameters, Grade prediction, const std::string& more = "") {
  const std::string text = graded_toml("[subject]\nname = \"car\"\n" + more, judgement_of(parameters, prediction));
  const Study study = Study::parse(text, "subject.toml");
  const StudyTable subject = study.root().table("subject");
  static_cast<void>(subject.text("name"));
  std::string warning = grades_warning(subject);
  study.root().finish();
  return warning;
}

TEST(SubjectGrades, AreWrittenAsASentenceAndAsATable) {
  const std::string text =
      graded_toml("[subject]\nname = \"car\"\n", judgement_of(Grade::kWithCare, Grade::kNotJudged));
  EXPECT_THAT(text, StartsWith("# The recording agrees with itself and with physics; "));
  EXPECT_THAT(text, HasSubstr("[subject.grades]\ndata = \"yes\"\nparameters = \"with care\"\nprediction = \"not "
                              "judged\"\n"));
}

TEST(SubjectGrades, LetPassWhatMayBeUsedAndWarnOfWhatOnlyPredicts) {
  EXPECT_EQ(warning_of(Grade::kYes, Grade::kYes), "");
  EXPECT_EQ(warning_of(Grade::kWithCare, Grade::kNo), "");
  EXPECT_EQ(warning_of(Grade::kNotJudged, Grade::kNotJudged), "");
  EXPECT_THAT(warning_of(Grade::kNo, Grade::kWithCare), HasSubstr("no physical constants"));
  const Study bare = Study::parse("[subject]\nmass = 1\n", "s.toml");
  EXPECT_EQ(grades_warning(bare.root().table("subject")), "");
}

TEST(SubjectGrades, RefuseWhatWasRejectedUnlessItIsAskedFor) {
  for (const Grade prediction : {Grade::kNo, Grade::kNotJudged}) {
    try {
      static_cast<void>(warning_of(Grade::kNo, prediction));
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith("subject.toml:"));
      EXPECT_THAT(error.what(), HasSubstr("subject.grades: the identification that wrote this subject rejected its "));
    }
    EXPECT_THAT(warning_of(Grade::kNo, prediction, "accept_rejected = true\n"), HasSubstr("rejected its parameters"));
  }
  const Study wrong = Study::parse("[subject.grades]\nparameters = \"perhaps\"\n", "s.toml");
  EXPECT_THROW(static_cast<void>(grades_warning(wrong.root().table("subject"))), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
