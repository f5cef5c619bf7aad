#include "veridyn/aircraft/reconstruction/sensor_errors.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

const char* to_string(Observability observability) {
  switch (observability) {
    case Observability::kObservable:
      return "observable";
    case Observability::kWeak:
      return "weakly observable";
    case Observability::kNotObservable:
      return "not observable";
  }
  return "";
}

Observability observability_of(double sigma, double prior_sigma) {
  const double ratio = sigma / prior_sigma;
  return ratio < 0.35 ? Observability::kObservable : ratio < 0.8 ? Observability::kWeak : Observability::kNotObservable;
}

double display_value(double value, const std::string& unit) {
  return unit.starts_with("rad") ? value / kDegree : value;
}

std::string display_unit(const std::string& unit) {
  if (unit == "rad") return " deg";
  if (unit == "rad/s") return " deg/s";
  return unit == "1" ? "" : " " + unit;
}

std::vector<SensorErrorReport> judge_sensor_errors(const std::vector<SensorErrorEstimate>& errors,
                                                   const Eigen::MatrixXd& covariance) {
  std::vector<SensorErrorReport> reports;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const SensorErrorEstimate& e = errors[i];
    SensorErrorReport r{.name = e.name,
                        .unit = e.unit,
                        .value = e.value,
                        .prior_sigma = e.prior_sigma,
                        .sigma = e.sigma,
                        .information = 1.0 - std::pow(e.sigma / e.prior_sigma, 2),
                        .correlated_with = {},
                        .observability = observability_of(e.sigma, e.prior_sigma),
                        .statement = {}};
    const auto a = static_cast<Eigen::Index>(i);
    for (Eigen::Index b = 0; b < covariance.cols(); ++b) {
      if (b == a) continue;
      const double scale = std::sqrt(covariance(a, a) * covariance(b, b));
      const double correlation = scale > 0.0 ? covariance(a, b) / scale : 0.0;
      if (std::abs(correlation) <= std::abs(r.correlation)) continue;
      r.correlation = correlation;
      r.correlated_with = errors[b].name;
    }
    const auto text = [&](double v) { return fmt::format("{:.3g}{}", display_value(v, e.unit), display_unit(e.unit)); };
    switch (r.observability) {
      case Observability::kObservable:
        r.statement = fmt::format("{} is {} +- {}: determined by this flight ({} was assumed beforehand)", e.name,
                                  text(e.value), text(e.sigma), text(e.prior_sigma));
        break;
      case Observability::kWeak:
        r.statement = fmt::format("{} is {} +- {}: weakly observable, {:.0f} % of that is the assumption of {}", e.name,
                                  text(e.value), text(e.sigma), 100.0 * (1.0 - r.information), text(e.prior_sigma));
        break;
      case Observability::kNotObservable:
        r.statement =
            fmt::format("{} is not observable in this flight: kept at its prior, +- {}", e.name, text(e.prior_sigma));
        break;
    }
    constexpr double kEntangled = 0.9;
    if (std::abs(r.correlation) > kEntangled) {
      r.statement +=
          fmt::format("; distinguishable from {} only poorly (correlation {:.2f})", r.correlated_with, r.correlation);
    }
    reports.push_back(std::move(r));
  }
  return reports;
}

}  // namespace veridyn::aircraft
