#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

std::string_view to_string(AirDataSource source) { return source == AirDataSource::kSensors ? "sensors" : "filter"; }

std::string_view to_string(TrackFilter filter) { return filter == TrackFilter::kGuarded ? "guarded" : "model-free"; }

TrackOptions TrackOptions::read(const StudyTable& table) {
  TrackOptions o;
  estimation::TrackerOptions::keys().read(table, o);
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
  const std::vector<std::string> filters{"model-free", "guarded"};
  const bool guarded = table.choice_or("filter", filters, "model-free") == "guarded";
  o.filter = guarded ? TrackFilter::kGuarded : TrackFilter::kModelFree;
  const std::vector<std::string> starts{"study", "none"};
  o.starts_from_study = table.choice_or("start_model", starts, "study") == "study";
  if (!guarded) {
    if (table.has("start_model")) table.fail("start_model", "is only for filter = \"guarded\": no other has a model");
    return o;
  }
  if (by_sensors) table.fail("filter", "= \"guarded\" contradicts air_data = \"sensors\", with which no filter is run");
  const auto is_force = [](Coefficient c) {
    return c == Coefficient::kCL || c == Coefficient::kCD || c == Coefficient::kCY;
  };
  if (!o.coefficients.empty() && std::none_of(o.coefficients.begin(), o.coefficients.end(), is_force))
    table.fail("filter", "= \"guarded\" takes CL, CD and CY from the tracker, and coefficients lists none of them");
  return o;
}

CoefficientTracker::CoefficientTracker(const CoefficientModel& model, const Eigen::MatrixXd& error_covariance,
                                       const TrackOptions& options, double rate_Hz, std::vector<std::string> names)
    : RegressionTracker(names.empty() ? model.parameter_names() : std::move(names), error_covariance, options, rate_Hz),
      model_(model) {}

}  // namespace veridyn::aircraft
