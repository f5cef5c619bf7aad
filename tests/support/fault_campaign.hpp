#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/result/parameter.hpp"

/// What becomes of one fault at a time in simulated recordings of known truth: is it caught, is it named, or does it
/// end in numbers that are confident and wrong?
namespace veridyn::test {

/// What became of a fault.
enum class Finding {
  kHarmless,  ///< nothing was found, and every parameter that is graded yes is right
  kInDoubt,   ///< no grade falls; what is wrong is marked weak or wrong by no more than a doubt that is stated with it
  kNamed,     ///< found, and a row that decides is about what is wrong
  kMisnamed,  ///< found, but the rows that decide are about something else
  kNotVerified,  ///< wrong, while a row about what is wrong says that this recording does not verify it
  kMissed        ///< confident and wrong
};
/// "harmless", "in doubt", "named", "misnamed", "not verified", "missed".
[[nodiscard]] std::string_view to_string(Finding finding);

/// A parameter counts as wrong beyond three of its standard errors and this share of the truth.
inline constexpr double kWrongBy = 0.05;

/// One fault in one recording.
struct Trial {
  std::string subject = {}, fault = {};
  Finding finding = Finding::kMissed;
  std::string data = {}, parameters = {};  ///< grades
  std::string reason = {};                 ///< the row that decided, or the parameters that are wrong
};

/// Parameters that are graded yes against the truth.
struct Confidence {
  std::size_t confident = 0;
  std::size_t covered = 0;                   ///< the truth is inside the interval of 95 %
  std::map<std::string, std::string> wrong;  ///< "Cm_alpha -0.9 +- 0.01 (-0.7)", by name
  /// Wrong by its interval alone, but weak for a doubt that is stated with it, or right within three standard
  /// deviations of interval and doubt together.
  std::map<std::string, std::string> in_doubt;

  /// Counts the identified ones of a group; `doubt` are standard deviations that are stated beside the intervals, in
  /// the order of the parameters, or nothing.
  void add(std::span<const estimation::Parameter> parameters, const std::map<std::string, double, std::less<>>& truth,
           std::span<const double> doubt = {});
};

/// What a result is judged by here.
struct Outcomes {
  bool refused = false;  ///< an InputError; `message` says which
  std::string message = {};
  std::span<const estimation::Evidence> evidence = {};
  Confidence confidence = {};
};

/// What names a fault: a row about one of these (sensors, channels, parameters), or of one of these checks.
struct NamedBy {
  std::vector<std::string> about;
  std::vector<estimation::Check> checks = {};

  NamedBy(std::vector<std::string> about_one, std::vector<estimation::Check> of_checks = {})  // NOLINT: subjects alone
      : about(std::move(about_one)), checks(std::move(of_checks)) {}
  [[nodiscard]] bool names(const estimation::Evidence& row) const;
};

/// What became of a fault, against the same recording without it. `found`: the
/// program says less than of the clean recording. Grades and names are left to the caller.
[[nodiscard]] Trial tried(const Outcomes& faulty, const Outcomes& clean, bool found, const NamedBy& named_by);

/// A line a fault, in this order: how many trials each finding had.
[[nodiscard]] std::string confusion_table(std::span<const Trial> trials, std::span<const std::string> faults);

}  // namespace veridyn::test
