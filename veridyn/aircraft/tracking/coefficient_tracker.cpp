#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"

#include <algorithm>
#include <utility>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

std::string_view to_string(AirDataSource source) { return source == AirDataSource::kSensors ? "sensors" : "filter"; }

std::string_view to_string(TrackFilter filter) { return filter == TrackFilter::kGuarded ? "guarded" : "model-free"; }

namespace {

void check(const StudyTable& table, TrackOptions& o) {
  if (o.filter != TrackFilter::kGuarded) {
    if (table.has("start_model")) table.fail("start_model", "is only for filter = \"guarded\": no other has a model");
    return;
  }
  if (o.air_data == AirDataSource::kSensors)
    table.fail("filter", "= \"guarded\" contradicts air_data = \"sensors\", with which no filter is run");
  const auto is_force = [](Coefficient c) {
    return c == Coefficient::kCL || c == Coefficient::kCD || c == Coefficient::kCY;
  };
  if (!o.coefficients.empty() && std::none_of(o.coefficients.begin(), o.coefficients.end(), is_force))
    table.fail("filter", "= \"guarded\" takes CL, CD and CY from the tracker, and coefficients lists none of them");
}

}  // namespace

const KeyTable<TrackOptions>& TrackOptions::keys() {
  using O = TrackOptions;
  static const auto table =
      KeyTable<O>("track", "How coefficients are followed on line.")
          .choices("coefficients", &O::coefficients, choices_of<Coefficient>(kCoefficientNames), "which are followed")
          .otherwise("all that the subject models")
          .file("estimate_file", &O::estimate_file, "an `estimate.json` to start from, with its error bars")
          .was("estimate")
          .choice("air_data", &O::air_data, {{"filter", AirDataSource::kFilter}, {"sensors", AirDataSource::kSensors}},
                  "where airspeed and flow angles come from; `filter`: airspeed of the causal state estimate, and its "
                  "flow angles where there are no vanes; `sensors`: pitot tube and vanes")
          .choice("filter", &O::filter, {{"model-free", TrackFilter::kModelFree}, {"guarded", TrackFilter::kGuarded}},
                  "`guarded`: a model-based filter with the tracked coefficients alongside, as long as its innovations "
                  "allow")
          .choice(
              "start_model", &O::starts_from_study, {{"study", true}, {"none", false}},
              "what the guarded filter knows before anything is tracked; `study`: the subject's values, or those of "
              "`reconstruct.estimate_file`")
          .with(estimation::TrackerOptions::keys())
          .check(check);
  return table;
}

CoefficientTracker::CoefficientTracker(const CoefficientModel& model, const Eigen::MatrixXd& error_covariance,
                                       const TrackOptions& options, double rate_Hz, std::vector<std::string> names)
    : RegressionTracker(names.empty() ? model.parameter_names() : std::move(names), error_covariance, options, rate_Hz),
      model_(model) {}

}  // namespace veridyn::aircraft
