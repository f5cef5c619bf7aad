#include "veridyn/vehicle/identification/evidence/vehicle_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"
#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"
#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Method;
using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::passed_or;
using estimation::Purpose;

/// Factor within which the noise of the sensors is known.
constexpr double kNoiseDoubt = 2.0;
/// Correlation of neighbouring residuals from which they count as autocorrelated.
constexpr double kAutocorrelated = 0.3;
/// Residual over what noise leaves, from which its autocorrelation is more than that of the inputs' noise.
constexpr double kBeyondNoise = 1.5;

double percent_explained(const estimation::PredictedQuantity& q) { return 100.0 * std::max(0.0, q.fit.r2); }

/// A residual's autocorrelation, and the share of the output's power that is neither modelled nor noise.
struct ResidualFinding {
  Evidence row;
  double unmodelled = 0.0;
};

/// Normalised chi-square of a residual: what it is over what sensors and noisy steering leave. Noise is known to a
/// factor of two; what exceeds it and is autocorrelated is motion that the bicycle does not have.
ResidualFinding check_residual(const estimation::PredictedQuantity& q, double sensor_sigma,
                               const estimation::PredictedQuantity* by_noise) {
  const double sigma = std::hypot(sensor_sigma, by_noise != nullptr ? by_noise->fit.rmse : 0.0);
  const double times = q.fit.rmse / sigma;
  const double beyond = std::max(0.0, 1.0 - kNoiseDoubt * kNoiseDoubt / (times * times));
  const bool autocorrelated = q.lag1 > kAutocorrelated;
  Evidence row{.name = "residual beyond the sensors",
               .about = q.name,
               .value = times * times,
               .limit = kBeyondNoise * kBeyondNoise,
               .scale = "normalised chi-square",
               .bears_on = Purpose::kParameters};
  if (autocorrelated && times > kBeyondNoise) row.outcome = times > kNoiseDoubt ? Outcome::kFailed : Outcome::kCare;
  if (row.passed()) {
    row.text = fmt::format(
        "the residual of {} is {:.2g} times what sensors and noisy steering leave "
        "(autocorrelation at one sample {:.2f})",
        q.name, times, q.lag1);
  } else {
    row.text = fmt::format(
        "the residual of {} is {:.2g} times what sensors and noisy steering leave (rms {:.3g} {} against {:.3g}, "
        "autocorrelation at one sample {:.2f}): something that moves this vehicle is not in the model",
        q.name, times, q.fit.rmse, q.unit, sigma, q.lag1);
    row.advice =
        "where identify.structure fixes the model, leave it to the data; if the body rolls, record roll or give "
        "signals.roll_gradient; the values still predict what the hold-out says";
  }
  return {std::move(row), std::max(0.0, 1.0 - q.fit.r2) * beyond};
}

/// All residuals, and the share of the outputs' power that nothing explains.
std::vector<Evidence> check_residuals(const VehicleProblem& problem, const VehicleFindings& findings) {
  std::vector<Evidence> rows;
  double unmodelled = 0.0;
  std::string worst;
  for (const estimation::PredictedQuantity& q : findings.fit.quantities) {
    const auto signal = std::find(kDriveSignalNames.begin(), kDriveSignalNames.end(), q.name);
    if (signal == kDriveSignalNames.end() || q.name == "yaw") continue;
    const double sigma = problem.signals.signals[signal - kDriveSignalNames.begin()].sigma;
    ResidualFinding found = check_residual(q, sigma, findings.by_noise.find(q.name));
    if (found.unmodelled > unmodelled) {
      unmodelled = found.unmodelled;
      worst = q.name;
    }
    rows.push_back(std::move(found.row));
  }
  const double limit = problem.options.max_unmodelled;
  const bool passed = unmodelled <= limit;
  rows.push_back(
      {.name = "unmodelled share",
       .outcome = passed_or(passed, Outcome::kFailed),
       .value = unmodelled,
       .limit = limit,
       .scale = "share of the variance",
       .text = passed
                   ? fmt::format("{:.1f} % of the outputs' variance is neither modelled nor noise", 100.0 * unmodelled)
                   : fmt::format("{:.0f} % of the variance of {} is neither modelled nor noise of the sensors",
                                 100.0 * unmodelled, worst),
       .bears_on = Purpose::kParameters});
  return rows;
}

Evidence check_simulation(bool simulated) {
  return {.name = "simulation",
          .outcome = passed_or(simulated, Outcome::kFailed),
          .value = simulated ? 1.0 : 0.0,
          .limit = 1.0,
          .text = simulated ? "the identified model was simulated over the drive"
                            : "the identified model cannot be simulated over the drive",
          .bears_on = Purpose::kParameters | Purpose::kPrediction};
}

/// `yaw_rate` is null where nothing was held out.
Evidence check_prediction(const estimation::PredictedQuantity* yaw_rate, double least_r2) {
  Evidence row{.name = "hold-out", .value = std::nan(""), .limit = least_r2, .scale = "R2"};
  if (yaw_rate == nullptr) {
    row.outcome = Outcome::kMissing;
    row.text = "there was no hold-out to validate on, so prediction is not judged";
    row.bears_on = Purpose::kPrediction;
    row.advice = "drive the manoeuvres at least twice, so that some of them can be held out";
    return row;
  }
  const bool passed = yaw_rate->fit.r2 >= least_r2;
  row.value = yaw_rate->fit.r2;
  row.outcome = passed_or(passed, Outcome::kFailed);
  row.text = passed ? fmt::format("it explains {:.1f} % of the yaw rate's variance on the hold-out",
                                  percent_explained(*yaw_rate))
                    : fmt::format("it explains {:.0f} % of the yaw rate's variance on the hold-out, less than {:.0f} %",
                                  percent_explained(*yaw_rate), 100.0 * least_r2);
  row.bears_on = Purpose::kParameters | Purpose::kPrediction;
  return row;
}

Evidence check_residual_on_holdout(const estimation::PredictedQuantity& there,
                                   const estimation::PredictedQuantity& here) {
  const bool systematic = there.lag1 > kAutocorrelated && there.fit.rmse > kBeyondNoise * here.fit.rmse;
  const bool autocorrelated_there = there.lag1 > kAutocorrelated && !(here.lag1 > kAutocorrelated);
  const bool holds = !systematic && !autocorrelated_there;
  return {.name = "residual on the hold-out",
          .outcome = passed_or(holds, Outcome::kCare),
          .value = there.fit.rmse,
          .limit = kBeyondNoise * here.fit.rmse,
          .scale = "rad/s",
          .text = fmt::format("the yaw rate's residual on the hold-out is {:.3g} rad/s rms (identification {:.3g}), "
                              "autocorrelation at one sample {:.2f} ({:.2f}){}",
                              there.fit.rmse, here.fit.rmse, there.lag1, here.lag1,
                              holds ? "" : ": the model is systematically off where it was not identified"),
          .bears_on = Purpose::kPrediction};
}

/// A check by the p value of "they agree". Equation error has linear tyres only: with the Magic Formula its
/// contradictions say no more than that.
Evidence by_p(const char* name, double p, const VehicleIdentifyOptions& options, std::string agree,
              std::string contradict) {
  const bool agrees = p >= options.contradiction_level;
  const Outcome otherwise = options.model.tyre == kDriveTyre<LinearTyre> ? Outcome::kFailed : Outcome::kCare;
  return {.name = name,
          .outcome = passed_or(agrees, otherwise),
          .value = p,
          .limit = options.contradiction_level,
          .scale = "p",
          .text = agrees ? std::move(agree) : std::move(contradict),
          .bears_on = Purpose::kParameters};
}

/// Equation error against output error, where that has all three parameters.
std::optional<Evidence> check_methods(const VehicleProblem& problem, const AxleEstimate& axle,
                                      const OutputErrorResult* output_error) {
  if (output_error == nullptr || !output_error->estimate.usable) return std::nullopt;
  const std::array<const char*, 3> names{"C_f", "C_r", "I_z"};
  Eigen::Vector3d difference;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Parameter* p = output_error->estimate.find(names[i]);
    if (p == nullptr) return std::nullopt;
    difference(i) = p->value - axle.value(i);
  }
  // Both come from the same data, so the sum of covariances is more than their difference has: a weak test, but one
  // without false alarms.
  Eigen::Matrix3d covariance = axle.covariance;
  covariance += output_error->raw.covariance.topLeftCorner(3, 3);
  // Small angles, which only equation error takes.
  covariance.diagonal() += (kSmallAngleError * axle.value).cwiseAbs2();
  const double p = estimation::agreement_p(difference, covariance);
  return by_p("agreement of methods", p, problem.options,
              fmt::format("equation error and output error agree (p = {:.2g})", p),
              fmt::format("equation error and output error contradict each other beyond their error bars (p = "
                          "{:.1e}): the model is incomplete for this drive",
                          p));
}

bool of_the_vehicle(const Parameter& p) {
  return p.name == "C_f" || p.name == "C_r" || p.name == "I_z" || p.name == "mu" || p.name == "a" ||
         p.name == "understeer_gradient";
}

}  // namespace

std::vector<Evidence> not_excited_rows(std::span<const std::string> unexcited) {
  Evidence parameters{
      .name = "excitation",
      .about = "steer",
      .outcome = Outcome::kFailed,
      .value = 0.0,
      .limit = 1.0,
      .scale = "determined parameters",
      .text = fmt::format("the drive does not determine {}", fmt::join(unexcited, ", ")),
      .bears_on = Purpose::kParameters,
      .advice = "drive with more steering: to and fro at 0.2 to 1 Hz, 1 to 3 m/s^2 of lateral acceleration"};
  Evidence prediction = parameters;
  prediction.outcome = Outcome::kMissing;
  prediction.text = "nothing was identified that could predict";
  prediction.bears_on = Purpose::kPrediction;
  prediction.advice.clear();
  return {std::move(parameters), std::move(prediction)};
}

AgreementChecks check_agreement(const VehicleProblem& problem, const VehicleFindings& findings) {
  AgreementChecks checks;
  // The regressions are of the bicycle.
  if (findings.equation_error == nullptr || has_roll(problem.options.model.structure)) return checks;
  const DriveRegressionResult& regression = findings.equation_error->regression;
  const AxleEstimate* axle = regression.find(regression.recommends ? regression.recommended : Method::kGtls);
  if (axle == nullptr || !axle->usable) return checks;
  const double p = axle->consistency_p;
  checks.consistency =
      by_p("consistency equation", p, problem.options,
           fmt::format("the four coefficients of the regressions belong to one bicycle (p = {:.2g})", p),
           fmt::format("the four coefficients of the regressions belong to no bicycle (p = {:.1e}): the model is "
                       "incomplete for this vehicle, or a, b or a sensor's place is wrong",
                       p));
  checks.methods = check_methods(problem, *axle, findings.output_error);
  return checks;
}

VehicleJudgement judge_vehicle(const VehicleProblem& problem, const VehicleFindings& findings) {
  const estimation::PredictedQuantity* there = findings.validation.find("yaw_rate");
  const estimation::PredictedQuantity* here = findings.fit.find("yaw_rate");
  VehicleJudgement out;
  out.checks = estimation::unfinished_rows(findings.unfinished);
  // A contradiction in the recording is the cause of others.
  for (const Evidence& row : problem.recording)
    out.checks.push_back(
        in_time_of_model(explained_by_roll(row, findings.chosen.find("roll_gradient"), problem.signal_options.gravity),
                         findings.steer_delay ? &*findings.steer_delay : nullptr));
  for (Evidence& row : check_residuals(problem, findings)) out.checks.push_back(std::move(row));
  out.checks.push_back(check_simulation(here != nullptr));
  const AgreementChecks agreement = check_agreement(problem, findings);
  for (const auto& check : {agreement.consistency, agreement.methods})
    if (check) out.checks.push_back(*check);
  if (findings.parts) out.checks.push_back(parts_row(*findings.parts, problem.options.contradiction_level));
  if (std::optional<Evidence> row = doubt_row(findings.structure_doubts, findings.chosen))
    out.checks.push_back(std::move(*row));
  for (Evidence& row : plausibility(findings.chosen.parameters, problem.start)) out.checks.push_back(std::move(row));
  for (Evidence& row : bound_rows(findings.chosen.parameters)) out.checks.push_back(std::move(row));
  out.checks.push_back(check_prediction(there, problem.options.min_holdout_r2));
  if (there != nullptr && here != nullptr) out.checks.push_back(check_residual_on_holdout(*there, *here));
  std::vector<std::string> identified, unexcited;
  for (const Parameter& p : findings.chosen.parameters) {
    if (of_the_vehicle(p)) (p.status == ParameterStatus::kNotExcited ? unexcited : identified).push_back(p.name);
  }
  const bool excited = !identified.empty();
  if (!excited)
    for (Evidence& row : not_excited_rows(unexcited)) out.checks.push_back(std::move(row));
  out.judgement = estimation::judge(out.checks);
  out.verdict = excited ? estimation::verdict_of(out.judgement) : estimation::GroupVerdict::kNotExcited;
  if (!excited) {
    out.reason = fmt::format("not excited: the drive does not determine {}", fmt::join(unexcited, ", "));
    return out;
  }

  const std::string holdout =
      there != nullptr ? fmt::format(": {:.1f} % of the yaw rate's variance on the hold-out", percent_explained(*there))
                       : ", without a hold-out to validate on";
  if (out.verdict != estimation::GroupVerdict::kIdentified) {
    const std::vector<std::string>& why = out.judgement.parameters.decided_by;
    const std::string first = why.empty() ? "it could not be judged" : why.front();
    out.reason = out.verdict == estimation::GroupVerdict::kEffective
                     ? fmt::format("predicts{}, but its values are no physical constants: {}", holdout.substr(1), first)
                     : fmt::format("rejected: {}", first);
    return out;
  }
  out.reason =
      fmt::format("{} identified by {}{}", fmt::join(identified, ", "), to_string(findings.chosen.method), holdout);
  if (!unexcited.empty()) out.reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  return out;
}

}  // namespace veridyn::vehicle
