#include "veridyn/aircraft/tracking/tracked_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/tracking/tracking_judgement.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/result/analysis.hpp"

namespace veridyn::aircraft {
namespace {

/// Whether the rows in the tracker's memory measure every parameter, and their evidence lets them be used.
bool is_identified(const TrackedCoefficient& c, const Subject& subject) {
  const estimation::RecursiveRegression& regression = c.tracker->regression();
  if (!regression.usable() || regression.excited_directions() < regression.parameters()) return false;
  return estimation::verdict_of(estimation::judge(tracked_evidence(c, subject))) ==
         estimation::GroupVerdict::kIdentified;
}

/// Root of d' M d: the rms over the rows with moment M of what d in the parameters does to the coefficient.
double seen_by_rows(const Eigen::VectorXd& d, const Eigen::MatrixXd& moment) {
  return std::sqrt(std::max(0.0, d.dot(moment * d)));
}

}  // namespace

std::string_view to_string(ModelSource source) {
  switch (source) {
    case ModelSource::kNone:
      return "none";
    case ModelSource::kStudy:
      return "study";
    case ModelSource::kTracked:
      return "tracked";
  }
  return "";
}

TrackedModel::TrackedModel(const Subject& known, const TrackOptions& track, const ReconstructOptions& reconstruct)
    : stall_(known.model.stall),
      model_error_(reconstruct.model_error),
      walk_(reconstruct.model_error_walk),
      settling_s_(track.detection.settle_s) {
  if (!track.starts_from_study) return;
  for (std::size_t i = 0; i < kForceCoefficients.size(); ++i) {
    const CoefficientModel* model = known.model.find(kForceCoefficients[i]);
    if (model != nullptr && model->known()) known_[i] = {.source = ModelSource::kStudy, .model = *model};
  }
}

FilterModel TrackedModel::model_at(double time, std::string reason) const {
  FilterModel model;
  model.from_s = time;
  model.reason = std::move(reason);
  model.error.walk = walk_;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    model.source[i] = known_[i].source;
    model.error.modelled[i] = known_[i].source != ModelSource::kNone;
    model.error.initial[i] = std::hypot(model_error_[i], known_[i].sigma);
  }
  // Lift is what tells the angle of attack from the accelerometer.
  if (known_[0].source == ModelSource::kNone) return model;
  model.aero.emplace();
  model.aero->stall = stall_;
  for (const Known& k : known_)
    if (k.source != ModelSource::kNone) model.aero->set(k.model);
  return model;
}

FilterModel TrackedModel::start() const {
  const bool any = known_[0].source != ModelSource::kNone;
  return model_at(-kInfinity, any ? "values of the study" : "CL is not known");
}

std::string TrackedModel::look_at(const TrackedCoefficient& c, const Subject& subject, double time, std::size_t index) {
  Known& known = known_[index];
  const std::string_view name = name_of(c.model.coefficient);
  if (const std::vector<estimation::Change>& changes = c.tracker->changes(); changes.size() > known.changes) {
    known.changes = changes.size();
    known.not_before = changes.back().detected_s + settling_s_;
    if (known.source == ModelSource::kNone) return {};
    known = {.changes = known.changes, .not_before = known.not_before};
    return fmt::format("{} changed at {:.1f} s", name, changes.back().detected_s);
  }
  if (time < known.not_before || !is_identified(c, subject)) return {};
  const Eigen::VectorXd theta = c.tracker->regression().theta();
  const Eigen::MatrixXd P = c.tracker->regression().covariance();
  const double sigma = std::sqrt((P * c.regressor_moment).trace());
  // Not measured well enough to be worth more than the accelerometer; NaN is no measure at all.
  if (!(sigma <= std::max(model_error_[index], ModelError{}.initial[index]))) return {};
  std::string reason = fmt::format("{} identified", name);
  if (known.source == ModelSource::kTracked) {
    const Eigen::VectorXd moved = theta - Eigen::Map<const Eigen::VectorXd>(known.model.values.data(), theta.size());
    const double by = seen_by_rows(moved, c.regressor_moment);
    if (by > sigma) {
      reason = fmt::format("{} moved by {:.2g}, {:.1f} times its error bar", name, by, by / sigma);
    } else if (sigma < 0.5 * known.sigma) {
      reason = fmt::format("{} known to {:.2g}", name, sigma);
    } else {
      return {};
    }
  }
  known.source = ModelSource::kTracked;
  known.model = c.model;
  known.model.values.assign(theta.data(), theta.data() + theta.size());
  known.sigma = sigma;
  return reason;
}

std::optional<FilterModel> TrackedModel::look(const FlightTracker& tracker, double time) {
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    for (const TrackedCoefficient& c : tracker.coefficients()) {
      if (c.model.coefficient != kForceCoefficients[i] || !c.tracker) continue;
      std::string reason = look_at(c, tracker.subject(), time, i);
      if (!reason.empty()) reasons.push_back(std::move(reason));
    }
  }
  if (reasons.empty()) return std::nullopt;
  return model_at(time, fmt::format("{}", fmt::join(reasons, "; ")));
}

}  // namespace veridyn::aircraft
