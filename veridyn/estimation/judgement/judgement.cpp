#include "veridyn/estimation/judgement/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

/// Of a judgement that is const or not.
template <typename AnyJudgement>
auto& grade_in(AnyJudgement& judgement, Purpose purpose) {
  switch (purpose) {
    case Purpose::kData:
      return judgement.data;
    case Purpose::kParameters:
      return judgement.parameters;
    case Purpose::kPrediction:
      break;
  }
  return judgement.prediction;
}

Grade grade_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed:
    case Outcome::kNotVerified:
      return Grade::kYes;
    case Outcome::kCare:
      return Grade::kWithCare;
    case Outcome::kMissing:
      return Grade::kNotJudged;
    case Outcome::kFailed:
      break;
  }
  return Grade::kNo;
}

PurposeGrade grade_for(Purpose purpose, std::span<const Evidence> rows) {
  PurposeGrade result;
  bool judged = false;
  Outcome worst = Outcome::kPassed;
  for (const Evidence& row : rows) {
    if (!row.bears_on.contains(purpose)) continue;
    // What the recording cannot tell is no reason to call a purpose judged.
    judged = judged || row.outcome != Outcome::kNotVerified;
    worst = std::max(worst, row.outcome);
  }
  if (!judged) return result;
  result.grade = grade_of(worst);
  if (result.grade == Grade::kYes) return result;
  for (const Evidence& row : rows) {
    if (row.bears_on.contains(purpose) && row.outcome == worst) result.decided_by.push_back(says(row));
  }
  return result;
}

PurposeGrade together(Purpose purpose, std::span<const Judgement> parts) {
  PurposeGrade result;
  if (parts.empty()) return result;
  const auto grade = [purpose](const Judgement& j) { return j.of(purpose).grade; };
  const auto [best, worst] = std::ranges::minmax(parts, {}, grade);
  if (grade(best) == grade(worst)) {
    result.grade = grade(best);
  } else {
    const bool usable = grade(best) == Grade::kYes || grade(best) == Grade::kWithCare;
    result.grade = usable ? Grade::kWithCare : Grade::kNo;
  }
  for (const Judgement& part : parts) {
    for (const std::string& text : part.of(purpose).decided_by) {
      if (std::ranges::find(result.decided_by, text) == result.decided_by.end()) result.decided_by.push_back(text);
    }
  }
  return result;
}

}  // namespace

std::string_view to_string(Purpose purpose) {
  switch (purpose) {
    case Purpose::kData:
      return "data";
    case Purpose::kParameters:
      return "parameters";
    case Purpose::kPrediction:
      return "prediction";
  }
  return "";
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed:
      return "passed";
    case Outcome::kNotVerified:
      return "not verified";
    case Outcome::kCare:
      return "with care";
    case Outcome::kMissing:
      return "missing";
    case Outcome::kFailed:
      return "failed";
  }
  return "";
}

std::string_view to_string(Grade grade) {
  switch (grade) {
    case Grade::kYes:
      return "yes";
    case Grade::kWithCare:
      return "with care";
    case Grade::kNotJudged:
      return "not judged";
    case Grade::kNo:
      return "no";
  }
  return "";
}

const PurposeGrade& Judgement::of(Purpose purpose) const { return grade_in(*this, purpose); }

PurposeGrade& Judgement::of(Purpose purpose) { return grade_in(*this, purpose); }

Judgement judge(std::span<const Evidence> rows) {
  Judgement judgement;
  for (const Purpose purpose : kPurposes) judgement.of(purpose) = grade_for(purpose, rows);
  return judgement;
}

PurposeGrade worse(const PurposeGrade& a, const PurposeGrade& b) {
  const auto no_row = [](const PurposeGrade& g) { return g.grade == Grade::kNotJudged && g.decided_by.empty(); };
  if (no_row(a) || no_row(b)) return no_row(a) ? b : a;
  return a.grade < b.grade ? b : a;
}

Judgement judge_together(std::span<const Judgement> parts) {
  Judgement judgement;
  for (const Purpose purpose : kPurposes) judgement.of(purpose) = together(purpose, parts);
  return judgement;
}

std::string sentence_of(const Judgement& judgement) {
  const auto one_of = [](const PurposeGrade& g, const char* yes, const char* care, const char* unknown,
                         const char* no) {
    switch (g.grade) {
      case Grade::kYes:
        return yes;
      case Grade::kWithCare:
        return care;
      case Grade::kNotJudged:
        return unknown;
      case Grade::kNo:
        break;
    }
    return no;
  };
  return fmt::format(
      "{}; {}; {}.",
      one_of(judgement.data, "The recording agrees with itself and with physics",
             "The recording agrees with itself with reservations", "The recording was not judged",
             "The recording contradicts itself"),
      one_of(judgement.parameters, "the parameters may be used as physical constants",
             "the parameters may be used with care", "the parameters were not judged",
             "the parameters must not be taken for physical constants"),
      one_of(judgement.prediction, "the model predicts held-out data", "the model predicts held-out data, with care",
             "prediction was not judged", "the model does not predict held-out data"));
}

}  // namespace veridyn::estimation
