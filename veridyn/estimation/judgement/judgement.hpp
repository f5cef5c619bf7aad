#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::estimation {

/// Whether a result may be used for a purpose.
enum class Grade { kYes, kWithCare, kNotJudged, kNo };
/// "yes", "with care", "not judged", "no".
[[nodiscard]] std::string_view to_string(Grade grade);

/// The grade for one purpose and why.
struct PurposeGrade {
  Grade grade = Grade::kNotJudged;
  std::vector<std::string> decided_by = {};  ///< texts of the rows that made it less than "yes"
};

/// What a result may be used for.
struct Judgement {
  PurposeGrade data = {};
  PurposeGrade parameters = {};
  PurposeGrade prediction = {};

  [[nodiscard]] const PurposeGrade& of(Purpose purpose) const;
  [[nodiscard]] PurposeGrade& of(Purpose purpose);
};

/// The grade that the worst row gives for each purpose that it bears on; "not judged" where no row bears on it.
[[nodiscard]] Judgement judge(std::span<const Evidence> rows);

/// The lower of two grades with its reasons; the other where one is not judged because no row bears on it.
[[nodiscard]] PurposeGrade worse(const PurposeGrade& a, const PurposeGrade& b);

/// What may be said of several groups together: for a purpose that all share, their grade; "with care" where they
/// differ and one of them may be used; `decided_by` of all that are less than "yes".
[[nodiscard]] Judgement judge_together(std::span<const Judgement> parts);

/// The three grades in one sentence: "The recording agrees with itself and with physics; the parameters may be used
/// with care; prediction was not judged."
[[nodiscard]] std::string sentence_of(const Judgement& judgement);

}  // namespace veridyn::estimation
