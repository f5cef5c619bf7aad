#include "tests/aircraft/campaign/campaign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::aircraft::testing {
namespace {

using estimation::Grade;
using estimation::Outcome;

constexpr std::array kFindings{Finding::kNamed, Finding::kMisnamed, Finding::kHarmless, Finding::kNotVerified,
                               Finding::kMissed};

class OneThread : public Progress {
 public:
  [[nodiscard]] int threads() const override { return 1; }
};

Grade parameters_grade(const Identified& flight, const std::string& group) {
  for (const CoefficientResult& result : flight.analysis.coefficients)
    if (result.name == group && result.chosen) return result.judgement.parameters.grade;
  return Grade::kNotJudged;
}

/// Whether the program says less of this flight than of the clean one.
bool is_found(const Identified& flight, const Identified& clean) {
  if (flight.refused || flight.analysis.estimate.judgement.data.grade > clean.analysis.estimate.judgement.data.grade)
    return true;
  return std::ranges::any_of(clean.analysis.coefficients, [&](const CoefficientResult& result) {
    return parameters_grade(flight, result.name) > parameters_grade(clean, result.name);
  });
}

/// Of the rows of the recording and of the coefficients, those of the worst outcome that the clean flight does not
/// have.
std::vector<estimation::Evidence> deciding_rows(const Identified& flight, const Identified& clean) {
  std::vector<estimation::Evidence> rows;
  Outcome worst = Outcome::kCare;
  bool of_recording = false;
  for (const estimation::Evidence& row : flight.analysis.estimate.evidence) {
    if (row.outcome < Outcome::kCare || row.outcome == Outcome::kMissing) continue;
    const bool on_data = row.bears_on.contains(estimation::Purpose::kData);
    if (of_recording && !on_data) continue;
    const bool same = std::ranges::any_of(clean.analysis.estimate.evidence, [&](const estimation::Evidence& e) {
      return e.name == row.name && e.about == row.about && e.outcome >= row.outcome;
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

bool names(const Fault& fault, std::string_view text) {
  return std::ranges::any_of(fault.rows,
                             [&](const std::string& row) { return text.find(row) != std::string_view::npos; });
}

bool is_not_verified(const Identified& flight, const Fault& fault) {
  return std::ranges::any_of(flight.analysis.estimate.evidence, [&](const estimation::Evidence& row) {
    return row.outcome == Outcome::kNotVerified && names(fault, row.about);
  });
}

}  // namespace

std::string_view to_string(Finding finding) {
  switch (finding) {
    case Finding::kHarmless:
      return "harmless";
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

FlightStudy campaign_flight(const std::string& aircraft, std::uint64_t seed, double duration_s,
                            const std::string& turbulence, Assumed assumed) {
  OneThread silent;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = {}\naltitude = 300\nwind = [4, -3, 0]\n"
      "turbulence = \"{}\"\n{}",
      seed, aircraft, duration_s, turbulence,
      assumed == Assumed::kNothing
          ? std::string()
          : fmt::format("[reconstruct]\nsensors = \"reference\"\nturbulence = \"{}\"\n", turbulence));
  return read_study(Study::parse(text, aircraft + ".toml"), silent);
}

Identified identified(const FlightStudy& study) {
  OneThread silent;
  Identified flight;
  try {
    flight.analysis = identify(study, silent);
  } catch (const InputError& e) {
    flight.refused = true;
    flight.message = e.what();
    return flight;
  }
  for (const estimation::ParameterGroup& group : flight.analysis.groups) {
    if (group.judgement.parameters.grade != Grade::kYes) continue;
    for (const estimation::Parameter& p : group.parameters) {
      const auto truth = flight.analysis.truth.find(p.name);
      if (p.status != estimation::ParameterStatus::kIdentified || truth == flight.analysis.truth.end()) continue;
      ++flight.confident;
      const double error = std::abs(p.value - truth->second);
      if (truth->second >= p.low95 && truth->second <= p.high95) ++flight.covered;
      if (error > 3.0 * p.sigma && error > kWrongBy * std::abs(truth->second))
        flight.wrong[p.name] = fmt::format("{} {:.3g} +- {:.2g} ({:.3g})", p.name, p.value, p.sigma, truth->second);
    }
  }
  return flight;
}

Trial try_fault(const FlightStudy& study, const Identified& clean, const Fault& fault) {
  FlightStudy faulty = study;
  fault.apply(faulty);
  const Identified flight = identified(faulty);
  Trial trial{.aircraft = study.subject.name, .fault = fault.name};
  if (flight.refused) {
    trial.finding = names(fault, flight.message) ? Finding::kNamed : Finding::kMisnamed;
    trial.data = trial.parameters = "refused";
    trial.reason = flight.message;
    return trial;
  }
  trial.data = to_string(flight.analysis.estimate.judgement.data.grade);
  trial.parameters = to_string(flight.analysis.estimate.judgement.parameters.grade);
  std::vector<std::string> wrong;
  // What was wrong without the fault is the noise of this flight.
  for (const auto& [name, text] : flight.wrong)
    if (!clean.wrong.contains(name)) wrong.push_back(text);
  const std::vector<estimation::Evidence> rows = deciding_rows(flight, clean);
  if (!wrong.empty()) {
    trial.finding = is_not_verified(flight, fault) ? Finding::kNotVerified : Finding::kMissed;
    trial.reason = fmt::format("{}", fmt::join(wrong, ", "));
  } else if (!is_found(flight, clean)) {
    trial.finding = Finding::kHarmless;
  } else {
    const bool named = std::ranges::any_of(
        rows, [&](const estimation::Evidence& row) { return names(fault, row.about) || names(fault, row.advice); });
    trial.finding = named ? Finding::kNamed : Finding::kMisnamed;
    if (!rows.empty()) trial.reason = fmt::format("{}: {}", rows.front().name, rows.front().text);
  }
  return trial;
}

std::string confusion_table(const std::vector<Trial>& trials) {
  std::string table = "| fault | named | misnamed | harmless | not verified | missed |\n|---|---|---|---|---|---|\n";
  for (const Fault& fault : faults()) {
    std::array<std::size_t, kFindings.size()> count{};
    for (const Trial& trial : trials) {
      if (trial.fault != fault.name) continue;
      ++count[static_cast<std::size_t>(std::ranges::find(kFindings, trial.finding) - kFindings.begin())];
    }
    table += fmt::format("| {} |", fault.name);
    for (const std::size_t n : count) table += n == 0 ? std::string(" |") : fmt::format(" {} |", n);
    table += "\n";
  }
  return table;
}

}  // namespace veridyn::aircraft::testing
