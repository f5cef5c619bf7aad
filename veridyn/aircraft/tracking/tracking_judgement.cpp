#include "veridyn/aircraft/tracking/tracking_judgement.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/recursive/tracking_evidence.hpp"

namespace veridyn::aircraft {

using estimation::Evidence;
using estimation::Judgement;

std::vector<Evidence> tracked_evidence(const TrackedCoefficient& c, const Subject& subject) {
  const std::string name = regressed_name(c.model.coefficient, subject);
  const estimation::RegressionEstimate estimate = c.tracker->estimate();
  std::vector<Evidence> rows = estimation::tracking_evidence(name, *c.tracker, estimate);
  // Held values were not measured, and what the subject's model is not of has no signs to expect.
  if (name != name_of(c.model.coefficient)) return rows;
  std::vector<estimation::Parameter> known = estimate.parameters;
  std::erase_if(known, [](const estimation::Parameter& p) {
    return p.status == estimation::ParameterStatus::kNotExcited || p.status == estimation::ParameterStatus::kRejected;
  });
  for (Evidence& row : plausibility(c.model.coefficient, known, subject)) rows.push_back(std::move(row));
  return rows;
}

estimation::Estimate judged_estimate(const FlightTracker& tracker, std::span<const estimation::Evidence> recording) {
  estimation::Estimate estimate = tracker.estimate();
  std::vector<Evidence> of_flight(recording.begin(), recording.end());
  if (of_flight.empty())
    of_flight.push_back(estimation::row_of(estimation::Check::kUncheckedRecording, "", estimation::Outcome::kMissing));
  estimate.evidence = of_flight;
  std::vector<Judgement> parts;
  std::size_t at = 0;
  for (const TrackedCoefficient& c : tracker.coefficients()) {
    if (!c.tracker) continue;
    const auto first = estimate.parameters.begin() + at;
    const auto last = first + signed_index(c.model.size());
    at += c.model.size();
    const std::vector<Evidence> rows = tracked_evidence(c, tracker.subject());
    std::vector<Evidence> all = rows;
    for (const Evidence& row : of_flight)
      if (affects(row, c.model.coefficient)) all.push_back(row);
    parts.push_back(estimation::judge(all));
    estimate.evidence.insert(estimate.evidence.end(), rows.begin(), rows.end());
    const std::vector<estimation::Parameter> marked =
        estimation::marked({first, last}, estimation::verdict_of(parts.back()));
    std::copy(marked.begin(), marked.end(), first);
  }
  estimate.judgement = estimation::judge_together(parts);
  estimate.judgement.data = estimation::judge(of_flight).data;
  return estimate;
}

}  // namespace veridyn::aircraft
