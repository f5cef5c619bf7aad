#include "tests/support/fault_campaign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::test {
namespace {

using estimation::Evidence;
using estimation::Outcome;

constexpr std::array kFindings{Finding::kNamed,   Finding::kMisnamed,    Finding::kHarmless,
                               Finding::kInDoubt, Finding::kNotVerified, Finding::kMissed};

/// What is in the first, but not in the second: what was wrong without the fault is the noise of this recording.
std::vector<std::string> new_in(const std::map<std::string, std::string>& faulty,
                                const std::map<std::string, std::string>& clean) {
  std::vector<std::string> texts;
  for (const auto& [name, text] : faulty)
    if (!clean.contains(name)) texts.push_back(text);
  return texts;
}

/// Rows of the worst outcome that the clean recording does not have; those of the recording before others.
std::vector<Evidence> deciding_rows(std::span<const Evidence> faulty, std::span<const Evidence> clean) {
  std::vector<Evidence> rows;
  Outcome worst = Outcome::kCare;
  bool of_recording = false;
  for (const Evidence& row : faulty) {
    if (row.outcome < Outcome::kCare || row.outcome == Outcome::kMissing) continue;
    const bool on_data = row.bears_on.contains(estimation::Purpose::kData);
    if (of_recording && !on_data) continue;
    const bool same = std::ranges::any_of(clean, [&](const Evidence& e) {
      return e.check == row.check && e.about == row.about && e.outcome >= row.outcome;
    });
    if (same) continue;
    if (on_data && !of_recording) {
      rows.clear();
      worst = Outcome::kCare;
      of_recording = true;
    }
    if (row.outcome > worst) rows.clear();
    worst = std::max(worst, row.outcome);
    if (row.outcome == worst) rows.push_back(row);
  }
  return rows;
}

/// Whether a subject, which may be several, "aileron and rudder", or of one of several recordings, holds one of these.
bool holds_one(std::string_view subject, std::span<const std::string> subjects) {
  return std::ranges::any_of(subjects,
                             [&](const std::string& one) { return subject.find(one) != std::string_view::npos; });
}

}  // namespace

std::string_view to_string(Finding finding) {
  switch (finding) {
    case Finding::kHarmless:
      return "harmless";
    case Finding::kInDoubt:
      return "in doubt";
    case Finding::kNamed:
      return "named";
    case Finding::kMisnamed:
      return "misnamed";
    case Finding::kNotVerified:
      return "not verified";
    case Finding::kMissed:
      return "missed";
  }
  return "";
}

void Confidence::add(std::span<const estimation::Parameter> parameters,
                     const std::map<std::string, double, std::less<>>& truth, std::span<const double> doubt) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const estimation::Parameter& p = parameters[i];
    const double beside = doubt.empty() ? 0.0 : doubt[i];
    const auto known = truth.find(p.name);
    const bool identified = p.status == estimation::ParameterStatus::kIdentified;
    const bool weak = p.status == estimation::ParameterStatus::kWeak && beside > 0.0;
    if (!(identified || weak) || known == truth.end()) continue;
    const double error = std::abs(p.value - known->second);
    if (identified) {
      ++confident;
      if (known->second >= p.low95 && known->second <= p.high95) ++covered;
    }
    if (!(error > 3.0 * p.sigma && error > kWrongBy * std::abs(known->second))) continue;
    const bool stated = weak || error <= 3.0 * std::hypot(p.sigma, beside);
    (stated ? in_doubt : wrong)[p.name] =
        fmt::format("{} {:.3g} +- {:.2g}{} ({:.3g})", p.name, p.value, p.sigma,
                    beside > 0.0 ? fmt::format(" +- {:.2g}", beside) : std::string(), known->second);
  }
}

bool NamedBy::names(const Evidence& row) const {
  return holds_one(row.about, about) || std::ranges::find(checks, row.check) != checks.end();
}

Trial tried(const Outcomes& faulty, const Outcomes& clean, bool found, const NamedBy& named_by) {
  Trial trial;
  if (faulty.refused) {
    // What is refused has no rows, but says which channel or key it is about.
    trial.finding = holds_one(faulty.message, named_by.about) ? Finding::kNamed : Finding::kMisnamed;
    trial.data = trial.parameters = "refused";
    trial.reason = faulty.message;
    return trial;
  }
  const std::vector<std::string> wrong = new_in(faulty.confidence.wrong, clean.confidence.wrong);
  if (!wrong.empty()) {
    const bool said = std::ranges::any_of(faulty.evidence, [&](const Evidence& row) {
      return row.outcome == Outcome::kNotVerified && named_by.names(row);
    });
    trial.finding = said ? Finding::kNotVerified : Finding::kMissed;
    trial.reason = fmt::format("{}", fmt::join(wrong, ", "));
    return trial;
  }
  if (!found) {
    const std::vector<std::string> stated = new_in(faulty.confidence.in_doubt, clean.confidence.in_doubt);
    trial.finding = stated.empty() ? Finding::kHarmless : Finding::kInDoubt;
    trial.reason = fmt::format("{}", fmt::join(stated, ", "));
    return trial;
  }
  const std::vector<Evidence> rows = deciding_rows(faulty.evidence, clean.evidence);
  const bool named = std::ranges::any_of(rows, [&](const Evidence& row) { return named_by.names(row); });
  trial.finding = named ? Finding::kNamed : Finding::kMisnamed;
  if (!rows.empty()) trial.reason = fmt::format("{}: {}", name_of(rows.front()), says(rows.front()));
  return trial;
}

std::string confusion_table(std::span<const Trial> trials, std::span<const std::string> faults) {
  std::string table =
      "| fault | named | misnamed | harmless | in doubt | not verified | missed |\n|---|---|---|---|---|---|---|\n";
  for (const std::string& fault : faults) {
    std::array<std::size_t, kFindings.size()> count{};
    for (const Trial& trial : trials) {
      if (trial.fault != fault) continue;
      ++count[std::ranges::find(kFindings, trial.finding) - kFindings.begin()];
    }
    table += fmt::format("| {} |", fault);
    for (const std::size_t n : count) table += n == 0 ? std::string(" |") : fmt::format(" {} |", n);
    table += "\n";
  }
  return table;
}

}  // namespace veridyn::test
