#include "veridyn/aircraft/identification/validation/evaluated_estimate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"

namespace veridyn::aircraft {
namespace {

/// "this flight", or "these 3 flights (a.csv 91 %, b.csv 88 %, c.csv 12 %)".
std::string flights_text(std::span<const FlightFit> fits) {
  if (fits.empty()) return "this flight";
  std::vector<std::string> each;
  for (const FlightFit& f : fits) each.push_back(fmt::format("{} {:.0f} %", f.flight, 100.0 * std::max(0.0, f.fit.r2)));
  return fmt::format("{} flight{} ({})", fits.size(), fits.size() == 1 ? "" : "s", fmt::join(each, ", "));
}

/// A given model against the excited segments of the flights.
CoefficientResult evaluate_coefficient(const CoefficientModel& model, std::span<const PreparedFlight> flights,
                                       const Subject& subject, const IdentifyOptions& options) {
  CoefficientResult result = internal::described(model, flights, subject);
  if (!result.reason.empty()) return result;
  const std::string& name = result.name;
  const FlightRows rows = coefficient_rows(model, flights, RowUse::kExcited, subject);
  if (rows.data.rows() < static_cast<Eigen::Index>(10 * model.size())) {
    result.verdict = estimation::GroupVerdict::kNotExcited;
    result.reason = fmt::format("{} cannot be judged: {}", name, segments_text(flights, result.axis));
    return result;
  }
  const Eigen::Map<const Eigen::VectorXd> values(model.values.data(), model.size());
  result.holdout_fit = internal::fit_on(rows.data, values);
  result.flight_fits = internal::fits_by_flight(rows, flights, values);
  const double explained = 100.0 * std::max(0.0, result.holdout_fit.r2);
  const double least = options.min_holdout_r2;
  const estimation::Outcome outcome = estimation::outcome_of_hold_out(result.holdout_fit.r2, least);
  const bool holds = outcome != estimation::Outcome::kFailed;
  const std::string where = flights_text(result.flight_fits);
  result.verdict = holds ? estimation::GroupVerdict::kIdentified : estimation::GroupVerdict::kRejected;
  estimation::Evidence row = estimation::row_of(estimation::Check::kAnotherFlight, name, outcome);
  row.value = result.holdout_fit.r2;
  row.limit = outcome == estimation::Outcome::kCare ? estimation::kHoldOutCare : least;
  result.evidence = {std::move(row).with("explained", 0.01 * explained).with("flights", where)};
  result.judgement = estimation::judge(result.evidence);
  result.reason = holds ? fmt::format("{} holds: it explains {:.0f} % of {}", name, explained, where)
                        : fmt::format(
                              "{} does not hold: it explains {:.0f} % of the coefficient's variance in {}, "
                              "less than {:.0f} %",
                              name, explained, where, 100.0 * least);
  return internal::with_series(std::move(result), flights, subject);
}

}  // namespace

std::vector<CoefficientResult> evaluate_estimate(std::span<const PreparedFlight> flights, const Subject& subject,
                                                 const IdentifyOptions& options, const estimation::Estimate& estimate) {
  std::vector<CoefficientResult> results;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel* structure = subject.model.find(c);
    if (structure == nullptr) continue;
    std::vector<std::string> names;
    for (const Term& term : structure->terms)
      names.push_back(regressed_parameter_name(structure->coefficient, term, subject));
    const CoefficientModel model = estimated_coefficient(*structure, names, estimate);
    if (model.size() > 0) {
      results.push_back(evaluate_coefficient(model, flights, subject, options));
    } else if (std::ranges::any_of(names, [&](const std::string& n) { return estimate.find(n) != nullptr; })) {
      CoefficientResult result = internal::described(*structure, flights, subject);
      result.reason = fmt::format("{} is not validated: it was rejected where it was identified", result.name);
      results.push_back(std::move(result));
    }
  }
  if (std::ranges::all_of(results,
                          [](const CoefficientResult& r) { return r.model.values.empty() || !r.model.known(); })) {
    throw InputError(estimate.subject, "the estimate holds no usable parameter of the study's model");
  }
  return results;
}

}  // namespace veridyn::aircraft
