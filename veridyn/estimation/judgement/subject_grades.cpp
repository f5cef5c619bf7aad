#include "veridyn/estimation/judgement/subject_grades.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace veridyn::estimation {
namespace {

constexpr std::array kGrades{Grade::kYes, Grade::kWithCare, Grade::kNotJudged, Grade::kNo};

Grade grade_of(const StudyTable& grades, Purpose purpose) {
  std::vector<std::string> words;
  for (const Grade grade : kGrades) words.emplace_back(to_string(grade));
  const std::string word = grades.choice_or(to_string(purpose), words, to_string(Grade::kNotJudged));
  return kGrades[std::ranges::find(words, word) - words.begin()];
}

/// `grade` of every purpose as a table.
template <typename GradeOf>
std::string table_of(const GradeOf& grade) {
  std::string text = "\n[subject.grades]\n";
  for (const Purpose purpose : kPurposes)
    text += fmt::format("{} = \"{}\"\n", to_string(purpose), to_string(grade(purpose)));
  return text;
}

}  // namespace

std::string grades_table(const StudyTable& subject) {
  if (!subject.has("grades")) return "";
  const StudyTable grades = subject.table("grades");
  return table_of([&](Purpose purpose) { return grade_of(grades, purpose); });
}

std::string graded_toml(const std::string& toml, const Judgement& judgement) {
  return fmt::format("# {}\n{}{}", sentence_of(judgement), toml,
                     table_of([&](Purpose purpose) { return judgement.of(purpose).grade; }));
}

std::string grades_warning(const StudyTable& subject) {
  const bool accepted = subject.flag_or("accept_rejected", false);
  if (!subject.has("grades")) return "";
  const StudyTable grades = subject.table("grades");
  const Grade parameters = grade_of(grades, Purpose::kParameters), prediction = grade_of(grades, Purpose::kPrediction);
  static_cast<void>(grade_of(grades, Purpose::kData));
  if (parameters != Grade::kNo) return "";
  if (prediction == Grade::kYes || prediction == Grade::kWithCare)
    return "the parameters of this subject predicted held-out data, but are no physical constants: their "
           "identification graded them \"no\"";
  std::string what =
      "the identification that wrote this subject rejected its parameters (grades: parameters \"no\", prediction \"" +
      std::string(to_string(prediction)) + "\")";
  if (!accepted) subject.fail("grades", what + "; identify again, or say accept_rejected = true in the subject");
  return what;
}

}  // namespace veridyn::estimation
