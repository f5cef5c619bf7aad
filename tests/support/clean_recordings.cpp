#include "tests/support/clean_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace veridyn::test {

using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

void CleanRecordings::add(std::span<const Evidence> rows, const estimation::Judgement& judgement) {
  ++count;
  const bool yes = judgement.data.grade == estimation::Grade::kYes;
  data_yes += yes ? 1 : 0;
  std::map<Check, Outcome> worst;
  for (const Evidence& row : rows) {
    if (row.bears_on.empty()) continue;
    const Outcome outcome = row.outcome == Outcome::kMissing ? Outcome::kPassed : row.outcome;
    Outcome& so_far = worst[row.check];
    so_far = std::max(so_far, outcome);
    if (!yes && outcome >= Outcome::kCare && row.bears_on.contains(estimation::Purpose::kData))
      sentences.push_back(fmt::format("{}: {}: {}", count, name_of(row), says(row)));
  }
  for (const auto& [check, outcome] : worst) {
    Alarms& of_check = alarms[check];
    of_check.care += outcome == Outcome::kCare ? 1 : 0;
    of_check.failed += outcome == Outcome::kFailed ? 1 : 0;
  }
}

std::string CleanRecordings::table() const {
  std::string table = "| row | with care | failed |\n|---|---|---|\n";
  for (const auto& [check, n] : alarms)
    if (n.care + n.failed > 0) table += fmt::format("| {} | {} | {} |\n", to_string(check), n.care, n.failed);
  return table + fmt::format("\n{} of {} recordings with data yes, {} refused\n", data_yes, count, refused);
}

}  // namespace veridyn::test
