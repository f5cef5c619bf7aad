#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"

#include <fmt/format.h>

#include <utility>

#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {

std::string_view to_string(AirDataSource source) { return source == AirDataSource::kSensors ? "sensors" : "filter"; }

TrackOptions TrackOptions::read(const StudyTable& table) {
  TrackOptions o;
  o.read_keys(table);
  if (table.has("coefficients")) {
    const std::vector<std::string> names(kCoefficientNames.begin(), kCoefficientNames.end());
    for (const std::string& name : table.texts("coefficients")) {
      const std::optional<Coefficient> c = find_coefficient(name);
      if (!c) table.fail("coefficients", fmt::format("'{}' is not a coefficient{}", name, suggestion(name, names)));
      o.coefficients.push_back(*c);
    }
  }
  const std::string_view estimate = table.renamed("estimate_file", "estimate");
  if (table.has(estimate)) o.estimate_file = table.file(estimate).string();
  const std::vector<std::string> sources{"filter", "sensors"};
  const bool by_sensors = table.choice_or("air_data", sources, "filter") == "sensors";
  o.air_data = by_sensors ? AirDataSource::kSensors : AirDataSource::kFilter;
  return o;
}

CoefficientTracker::CoefficientTracker(const CoefficientModel& model, const Eigen::MatrixXd& error_covariance,
                                       const TrackOptions& options, double rate_Hz, std::vector<std::string> names)
    : RegressionTracker(names.empty() ? model.parameter_names() : std::move(names), error_covariance, options, rate_Hz),
      model_(model) {}

}  // namespace veridyn::aircraft
