#include "veridyn/estimation/recursive/tracking_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::estimation {
namespace {

/// Residual variance over what the sensors explain, up to which their noise, known to a factor of two, explains all.
constexpr double kSensorNoiseAlone = 4.0;
/// Share of the variance that may be neither modelled nor sensor noise, as in batch identification.
constexpr double kUnmodelled = 0.1;
/// Share of the next rows' variance that a model must predict, as of a hold-out.
constexpr double kPredicted = 0.3;

Evidence chi_square_row(const RegressionTracker& tracker) {
  const double ratio = tracker.error_ratio();
  const TrackedPower& power = tracker.power();
  const double residual = tracker.regression().residual_sd();
  const double unexplained = power.deviation > 0.0 ? residual * residual * power.weight / power.deviation : 1.0;
  const double unmodelled = unexplained * std::max(0.0, 1.0 - kSensorNoiseAlone / ratio);
  Evidence row{.name = "residual beyond the sensors",
               .value = ratio,
               .limit = kSensorNoiseAlone,
               .scale = "normalised chi-square",
               .bears_on = Purpose::kParameters};
  row.outcome = unmodelled > kUnmodelled        ? Outcome::kFailed
                : !(ratio <= kSensorNoiseAlone) ? Outcome::kCare
                                                : Outcome::kPassed;
  row.text = fmt::format("the residual's variance over the memory is {:.2g} times what the sensors explain{}", ratio,
                         row.passed() ? ""
                                      : fmt::format(", {:.0f} % of the variance is neither modelled nor sensor noise; "
                                                    "the rest is taken for error of the equation, with wider intervals",
                                                    100.0 * unmodelled));
  if (!row.passed()) row.advice = "look for what the model lacks, or for a sensor that is noisier than was measured";
  return row;
}

Evidence autocorrelation_row(const RegressionTracker& tracker, const RegressionEstimate& estimate) {
  double worst = 1.0;
  for (const Parameter& p : estimate.parameters)
    if (p.sigma_white > 0.0 && std::isfinite(p.sigma)) worst = std::max(worst, p.sigma / p.sigma_white);
  const double lag1 = tracker.power().lag1();
  // Beyond chance for the rows in memory; for information: the intervals allow for it.
  const double limit = 3.0 / std::sqrt(std::max(1.0, tracker.regression().effective_samples()));
  return {
      .name = "residual autocorrelation",
      .outcome = passed_or(!(std::abs(lag1) > limit), Outcome::kCare),
      .value = lag1,
      .limit = limit,
      .scale = "correlation of neighbouring rows",
      .text = fmt::format("neighbouring innovations correlate by {:.2f}, which the error bars allow for: they are up "
                          "to {:.1f} times those of white noise",
                          lag1, worst)};
}

Evidence excitation_row(const RecursiveRegression& regression) {
  const std::string held = regression.unexcited_text();
  const auto excited = static_cast<double>(regression.excited_directions());
  const auto all = static_cast<double>(regression.parameters());
  Evidence row{.name = "excitation",
               .value = excited,
               .limit = all,
               .scale = "excited combinations",
               .bears_on = Purpose::kParameters};
  if (held.empty()) {
    // Methods that do not hold directions only say how many stand above the noise.
    row.outcome = passed_or(excited >= all, Outcome::kCare);
    row.text = excited >= all ? std::string("every combination of parameters is excited")
                              : fmt::format("only {:.0f} of {:.0f} combinations of parameters stand above the noise",
                                            excited, all);
  } else {
    row.outcome = excited > 0.0 ? Outcome::kCare : Outcome::kMissing;
    row.text = fmt::format("not excited at the end, and held at what was known before: {}", held);
  }
  if (!row.passed()) row.advice = "fly or drive a manoeuvre that moves them";
  return row;
}

Evidence scatter_row(const RegressionTracker& tracker) {
  constexpr double kCare = 1e-3, kFailed = 1e-6;
  const TrackedScatter scatter = tracker.scatter();
  Evidence row{.name = "agreement of the recording's parts",
               .value = scatter.p,
               .limit = kCare,
               .scale = "p",
               .bears_on = Purpose::kParameters};
  if (scatter.parts < 2) {
    row.outcome = Outcome::kNotVerified;
    row.value = std::nan("");
    row.text = "there are no two parts of the recording, a memory apart and without a change, to compare";
    return row;
  }
  row.outcome = scatter.p < kFailed ? Outcome::kFailed : passed_or(scatter.p >= kCare, Outcome::kCare);
  row.text = fmt::format(
      "estimates from {} parts of the recording {} (p = {:.2g}){}", scatter.parts,
      row.passed() ? "agree" : "scatter beyond their error bars", scatter.p,
      scatter.ratio > 1.0 ? fmt::format("; intervals are widened by {:.2f}", std::sqrt(scatter.ratio)) : "");
  if (!row.passed()) row.advice = "parameters that drift, or terms that are missing: compare the parts in the history";
  return row;
}

Evidence change_row(const RegressionTracker& tracker) {
  const std::size_t count = tracker.changes().size();
  Evidence row{.name = "changes",
               .outcome = passed_or(count == 0, Outcome::kCare),
               .value = static_cast<double>(count),
               .limit = 0.0,
               .scale = "changes found",
               .bears_on = Purpose::kParameters};
  row.text = count == 0 ? std::string("no change was found")
                        : fmt::format("{} change{} found, the last at {:.1f} s: the values are those after it", count,
                                      count == 1 ? " was" : "s were", tracker.changes().back().detected_s);
  if (!tracker.options().detect_changes) {
    row.outcome = Outcome::kNotVerified;
    row.text = "changes were not looked for";
  }
  return row;
}

Evidence prediction_row(const RegressionTracker& tracker) {
  const double share = tracker.power().predicted_share();
  const bool passed = share >= kPredicted;
  return {.name = "prediction of the next row",
          .outcome = passed_or(passed, Outcome::kFailed),
          .value = share,
          .limit = kPredicted,
          .scale = "R2",
          .text = fmt::format("the estimates predicted {:.0f} % of the variance of held-out rows{}",
                              100.0 * std::max(0.0, share),
                              passed ? "" : fmt::format(", less than {:.0f} %", 100.0 * kPredicted)),
          .bears_on = Purpose::kPrediction};
}

}  // namespace

std::vector<Evidence> tracking_evidence(const std::string& about, const RegressionTracker& tracker,
                                        const RegressionEstimate& estimate) {
  std::vector<Evidence> rows;
  if (!estimate.usable()) {
    rows.push_back({.name = "estimate",
                    .about = about,
                    .outcome = Outcome::kMissing,
                    .value = static_cast<double>(tracker.regression().rows()),
                    .limit = static_cast<double>(tracker.regression().parameters()),
                    .scale = "rows",
                    .text = estimate.message,
                    .bears_on = Purpose::kParameters | Purpose::kPrediction});
    return rows;
  }
  const bool against_noise = std::isfinite(tracker.error_ratio());
  if (against_noise) rows.push_back(chi_square_row(tracker));
  rows.push_back(autocorrelation_row(tracker, estimate));
  rows.push_back(collinearity(estimate));
  if (against_noise && !rows.back().passed() && tracker.error_ratio() < kSensorNoiseAlone) {
    rows.back().outcome = Outcome::kPassed;
    rows.back().text += "; the residual is no larger than sensor noise, so the intervals hold all the same";
    rows.back().advice.clear();
  }
  rows.push_back(excitation_row(tracker.regression()));
  rows.push_back(scatter_row(tracker));
  for (const Parameter& p : estimate.parameters) {
    if (p.status == ParameterStatus::kFixed || (p.sigma > 0.0 && std::isfinite(p.sigma))) continue;
    rows.push_back({.name = "standard error",
                    .outcome = Outcome::kFailed,
                    .value = p.sigma,
                    .limit = 0.0,
                    .scale = "sigma",
                    .text = fmt::format("{} has no standard error ({}): nothing is known of it", p.name, p.sigma),
                    .bears_on = Purpose::kParameters});
  }
  rows.push_back(change_row(tracker));
  rows.push_back(prediction_row(tracker));
  for (Evidence& row : rows) row.about = about;
  return rows;
}

}  // namespace veridyn::estimation
