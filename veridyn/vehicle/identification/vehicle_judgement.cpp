#include "veridyn/vehicle/identification/vehicle_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/estimation/judgement/agreement.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Method;
using estimation::Parameter;
using estimation::ParameterStatus;

/// Factor within which the noise of the sensors is known.
constexpr double kNoiseDoubt = 2.0;
/// Correlation of neighbouring residuals from which they count as autocorrelated.
constexpr double kAutocorrelated = 0.3;
/// Residual over what noise leaves, from which its autocorrelation is more than that of the inputs' noise.
constexpr double kBeyondNoise = 1.5;
/// Relative difference between the methods that small angles may make.
constexpr double kSmallAngles = 0.01;

double percent_explained(const estimation::PredictedQuantity& q) { return 100.0 * std::max(0.0, q.fit.r2); }

/// A residual's autocorrelation, and the share of the output's power that is neither modelled nor noise.
struct ResidualFinding {
  Evidence check;
  double unmodelled = 0.0;
};

ResidualFinding check_residual(const estimation::PredictedQuantity& q, double sensor_sigma,
                               const estimation::PredictedQuantity* by_noise) {
  const double sigma = std::hypot(sensor_sigma, by_noise != nullptr ? by_noise->fit.rmse : 0.0);
  const double beyond = std::max(0.0, 1.0 - kNoiseDoubt * kNoiseDoubt * sigma * sigma / (q.fit.rmse * q.fit.rmse));
  const bool white = !(q.lag1 > kAutocorrelated) || !(q.fit.rmse > kBeyondNoise * sigma);
  std::string text =
      white ? fmt::format("the residual of {} is {} (autocorrelation at one sample {:.2f})", q.name,
                          q.lag1 > kAutocorrelated ? "no larger than sensors and noisy steering leave" : "white enough",
                          q.lag1)
            : fmt::format(
                  "the residual of {} is autocorrelated (autocorrelation at one sample {:.2f}, rms {:.3g} {} against "
                  "{:.3g} of the sensor): something that moves this vehicle is not in the bicycle model",
                  q.name, q.lag1, q.fit.rmse, q.unit, sigma);
  return {{fmt::format("residual autocorrelation of {}", q.name), white, q.lag1, kAutocorrelated, std::move(text)},
          std::max(0.0, 1.0 - q.fit.r2) * beyond};
}

/// The checks as they are made.
struct Checks {
  std::vector<Evidence> all;
  std::vector<std::string> warnings;
  void add(Evidence check) {
    if (!check.passed) warnings.push_back(check.text);
    all.push_back(std::move(check));
  }
  void add(const std::optional<Evidence>& check) {
    if (check) add(*check);
  }
};

/// All residuals; the last check is that of the unmodelled share.
Checks check_residuals(const VehicleProblem& problem, const VehicleFindings& findings) {
  Checks checks;
  double unmodelled = 0.0;
  std::string worst;
  for (const estimation::PredictedQuantity& q : findings.fit.quantities) {
    const auto signal = std::find(kDriveSignalNames.begin(), kDriveSignalNames.end(), q.name);
    if (signal == kDriveSignalNames.end() || q.name == "yaw") continue;
    const double sigma = problem.signals.signals[static_cast<std::size_t>(signal - kDriveSignalNames.begin())].sigma;
    const ResidualFinding found = check_residual(q, sigma, findings.by_noise.find(q.name));
    if (found.unmodelled > unmodelled) {
      unmodelled = found.unmodelled;
      worst = q.name;
    }
    checks.add(found.check);
  }
  const double limit = problem.options.max_unmodelled;
  checks.add(
      Evidence{"unmodelled share", unmodelled <= limit, unmodelled, limit,
               unmodelled <= limit
                   ? fmt::format("{:.1f} % of the outputs' variance is neither modelled nor noise", 100.0 * unmodelled)
                   : fmt::format("{:.0f} % of the variance of {} is neither modelled nor noise of the sensors",
                                 100.0 * unmodelled, worst)});
  return checks;
}

Evidence check_prediction(const estimation::PredictedQuantity& yaw_rate, double least_r2) {
  return {"hold-out", yaw_rate.fit.r2 >= least_r2, yaw_rate.fit.r2, least_r2,
          fmt::format("it explains {:.1f} % of the yaw rate's variance on the hold-out", percent_explained(yaw_rate))};
}

Evidence check_residual_on_holdout(const estimation::PredictedQuantity& there,
                                   const estimation::PredictedQuantity& here) {
  const bool systematic = there.lag1 > kAutocorrelated && there.fit.rmse > kBeyondNoise * here.fit.rmse;
  const bool autocorrelated_there = there.lag1 > kAutocorrelated && !(here.lag1 > kAutocorrelated);
  const bool holds = !systematic && !autocorrelated_there;
  return {"residual on the hold-out", holds, there.fit.rmse, kBeyondNoise * here.fit.rmse,
          fmt::format("the yaw rate's residual on the hold-out is {:.3g} rad/s rms (identification {:.3g}), "
                      "autocorrelation at one sample {:.2f} ({:.2f}){}",
                      there.fit.rmse, here.fit.rmse, there.lag1, here.lag1,
                      holds ? "" : ": the model is systematically off where it was not identified")};
}

/// A check by the p value of "they agree".
Evidence by_p(const char* name, double p, double level, std::string agree, std::string contradict) {
  return {name, p >= level, p, level, p >= level ? std::move(agree) : std::move(contradict)};
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
    const auto row = static_cast<Eigen::Index>(i);
    difference(row) = p->value - axle.value(row);
  }
  // Both come from the same data, so the sum of covariances is more than their difference has: a weak test, but one
  // without false alarms.
  Eigen::Matrix3d covariance = axle.covariance;
  covariance += output_error->raw.covariance.topLeftCorner(3, 3);
  // Small angles, which only equation error takes.
  covariance.diagonal() += (kSmallAngles * axle.value).cwiseAbs2();
  const double p = estimation::agreement_p(difference, covariance);
  return by_p("agreement of methods", p, problem.options.contradiction_level,
              fmt::format("equation error and output error agree (p = {:.2g})", p),
              fmt::format("equation error and output error contradict each other beyond their error bars (p = "
                          "{:.1e}): the model is incomplete for this drive",
                          p));
}

/// The estimate from the hold-out against that of the identification segments.
std::optional<Evidence> check_data_parts(const VehicleProblem& problem, const AxleEstimate& axle) {
  if (problem.segments.holdout.empty()) return std::nullopt;
  const DriveRegressionResult of_holdout = regress(problem, problem.segments.holdout, problem.start);
  const AxleEstimate* other = of_holdout.find(axle.method);
  if (other == nullptr || !other->usable) return std::nullopt;
  const double p = estimation::agreement_p(other->value - axle.value, other->covariance + axle.covariance);
  return by_p("agreement of data parts", p, problem.options.contradiction_level,
              fmt::format("identification and hold-out data, estimated separately, agree (p = {:.2g})", p),
              fmt::format("estimates from two parts of the drive contradict each other beyond their error bars (p = "
                          "{:.1e}): the vehicle, the road or the range of motion is not the same in both",
                          p));
}

/// Why the estimate must not be used; nothing where it may.
std::optional<std::string> objection(const VehicleProblem& problem, const Evidence& unmodelled,
                                     const AgreementChecks& agreement, bool simulated,
                                     const estimation::PredictedQuantity* holdout) {
  const VehicleIdentifyOptions& o = problem.options;
  if (!simulated) return "rejected: the identified model cannot be simulated over the drive";
  if (!unmodelled.passed) return fmt::format("rejected: {}", unmodelled.text);
  if (holdout != nullptr && !(holdout->fit.r2 >= o.min_holdout_r2)) {
    return fmt::format("rejected: it explains {:.0f} % of the yaw rate's variance on the hold-out, less than {:.0f} %",
                       percent_explained(*holdout), 100.0 * o.min_holdout_r2);
  }
  // No bicycle moves like this: error bars then mean nothing, however well the yaw rate is predicted.
  // (Equation error has linear tyres only: with the Magic Formula its contradictions say no more than that.)
  if (o.model.tyre != DriveTyre::kLinear) return std::nullopt;
  for (const auto& check : {agreement.consistency, agreement.methods, agreement.data_parts}) {
    if (check && !check->passed) {
      return fmt::format(
          "rejected: {}. Rolling is not in the model: record roll or give signals.roll_gradient, and a lower "
          "signals.pass_band",
          check->text);
    }
  }
  return std::nullopt;
}

bool of_the_vehicle(const Parameter& p) {
  return p.name == "C_f" || p.name == "C_r" || p.name == "I_z" || p.name == "mu" || p.name == "a" ||
         p.name == "understeer_gradient";
}

}  // namespace

AgreementChecks check_agreement(const VehicleProblem& problem, const VehicleFindings& findings) {
  AgreementChecks checks;
  if (findings.equation_error == nullptr) return checks;
  const DriveRegressionResult& regression = findings.equation_error->regression;
  const AxleEstimate* axle = regression.find(regression.recommends ? regression.recommended : Method::kGtls);
  if (axle == nullptr || !axle->usable) return checks;
  const double p = axle->consistency_p;
  checks.consistency =
      by_p("consistency equation", p, problem.options.contradiction_level,
           fmt::format("the four coefficients of the regressions belong to one bicycle (p = {:.2g})", p),
           fmt::format("the four coefficients of the regressions belong to no bicycle (p = {:.1e}): the model is "
                       "incomplete for this vehicle, or a, b or a sensor's place is wrong",
                       p));
  checks.methods = check_methods(problem, *axle, findings.output_error);
  checks.data_parts = check_data_parts(problem, *axle);
  return checks;
}

VehicleJudgement judge_vehicle(const VehicleProblem& problem, const VehicleFindings& findings) {
  Checks checks = check_residuals(problem, findings);
  const Evidence unmodelled = checks.all.back();
  const AgreementChecks agreement = check_agreement(problem, findings);
  for (const auto& check : {agreement.consistency, agreement.methods, agreement.data_parts}) checks.add(check);
  const estimation::PredictedQuantity* there = findings.validation.find("yaw_rate");
  const estimation::PredictedQuantity* here = findings.fit.find("yaw_rate");
  if (there != nullptr) {
    checks.add(check_prediction(*there, problem.options.min_holdout_r2));
  } else {
    checks.warnings.emplace_back("there was no hold-out to validate on");
  }
  if (there != nullptr && here != nullptr) checks.add(check_residual_on_holdout(*there, *here));

  VehicleJudgement out{estimation::GroupVerdict::kRejected, "", std::move(checks.all), std::move(checks.warnings)};
  if (const auto why = objection(problem, unmodelled, agreement, here != nullptr, there)) {
    out.reason = *why;
    return out;
  }
  std::vector<std::string> identified, unexcited;
  for (const Parameter& p : findings.chosen.parameters) {
    if (of_the_vehicle(p)) (p.status == ParameterStatus::kNotExcited ? unexcited : identified).push_back(p.name);
  }
  if (identified.empty()) {
    out.verdict = estimation::GroupVerdict::kNotExcited;
    out.reason = fmt::format("not excited: the drive does not determine {}", fmt::join(unexcited, ", "));
    return out;
  }
  out.verdict = estimation::GroupVerdict::kIdentified;
  out.reason = fmt::format(
      "{} identified by {}{}", fmt::join(identified, ", "), to_string(findings.chosen.method),
      there != nullptr ? fmt::format(": {:.1f} % of the yaw rate's variance on the hold-out", percent_explained(*there))
                       : ", without a hold-out to validate on");
  if (!unexcited.empty()) out.reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  const auto failed = std::count_if(out.checks.begin(), out.checks.end(), [](const auto& c) { return !c.passed; });
  if (failed > 0) out.reason += fmt::format("; {} of {} checks failed, see the warnings", failed, out.checks.size());
  return out;
}

}  // namespace veridyn::vehicle
