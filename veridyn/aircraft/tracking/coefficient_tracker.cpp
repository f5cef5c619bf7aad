#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"

#include <fmt/format.h>

#include <utility>

#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {

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
  if (table.has("estimate")) o.estimate_file = table.files("estimate").at(0).string();
  const std::vector<std::string> sources{"filter", "sensors"};
  o.air_data = table.choice_or("air_data", sources, o.air_data);
  return o;
}

CoefficientTracker::CoefficientTracker(const CoefficientModel& model, const Eigen::MatrixXd& error_covariance,
                                       const TrackOptions& options, double rate_Hz, std::vector<std::string> names)
    : RegressionTracker(names.empty() ? model.parameter_names() : std::move(names), error_covariance, options, rate_Hz),
      model_(model) {}

}  // namespace veridyn::aircraft
