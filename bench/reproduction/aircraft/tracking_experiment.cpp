#include "bench/reproduction/aircraft/tracking_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kSettled = 0.05;
constexpr double kNormal95 = 1.96;

/// First time at which every direction stands above the threshold.
double fully_excited(const TrackHistory& history, std::size_t parameters) {
  for (std::size_t k = 0; k < history.time.size(); ++k)
    if (history.excited[k] >= static_cast<int>(parameters)) return history.time[k];
  return kNaN;
}

/// Index of the phase that a time belongs to.
std::size_t phase_at(const std::vector<double>& begins, double t) {
  std::size_t phase = 0;
  while (phase + 1 < begins.size() && t >= begins[phase + 1] - 1e-9) ++phase;
  return phase;
}

/// View of an experiment whose settling times it finds.
class Settling {
 public:
  explicit Settling(const TrackingExperiment& experiment) : e_(experiment) {
    const ExactRows& rows = e_.rows;
    const Eigen::Index n = rows.regressors.cols();
    const double deviation = std::sqrt((rows.regressand.array() - rows.regressand.mean()).square().mean());
    at_start_ = Eigen::VectorXd(n);
    for (Eigen::Index j = 0; j < n; ++j)
      at_start_(j) = kSettled * deviation / std::sqrt(rows.regressors.col(j).array().square().mean());
    Eigen::Index row = 0;
    for (const double begin : e_.phase_s) {
      while (row + 1 < rows.truth_at.rows() && rows.time[row] < begin - 1e-9) ++row;
      truth_.push_back(rows.truth_at.row(row).transpose());
    }
  }

  std::vector<double> times(const TrackHistory& history) const {
    std::vector<double> result(e_.phase_s.size(), kNaN);
    for (std::size_t k = 0; k < history.time.size(); ++k) {
      const std::size_t phase = phase_at(e_.phase_s, history.time[k]);
      if (!settled(history, k, phase))
        result[phase] = kNaN;
      else if (std::isnan(result[phase]))
        result[phase] = history.time[k] - e_.phase_s[phase];
    }
    return result;
  }

  double known_from(const TrackHistory& history) const {
    double from = kNaN;
    for (std::size_t k = 0; k < history.time.size() && phase_at(e_.phase_s, history.time[k]) == 0; ++k) {
      bool known = settled(history, k, 0);
      for (std::size_t i = 0; i < history.sigma.size() && known; ++i)
        known = kNormal95 * history.sigma[i][k] <= at_start_(i);
      if (!known)
        from = kNaN;
      else if (std::isnan(from))
        from = history.time[k];
    }
    return from;
  }

 private:
  bool settled(const TrackHistory& history, std::size_t k, std::size_t phase) const {
    for (std::size_t i = 0; i < history.value.size(); ++i) {
      const double error = std::abs(history.value[i][k] - truth_[phase](i));
      if (phase == 0 || truth_[phase] == truth_[phase - 1]) {
        if (!(error <= at_start_(i))) return false;
      } else if (truth_[phase](i) != truth_[phase - 1](i)) {
        if (!(error <= kSettled * std::abs(truth_[phase](i)))) return false;
      }
    }
    return true;
  }

  const TrackingExperiment& e_;
  Eigen::VectorXd at_start_;
  std::vector<Eigen::VectorXd> truth_;
};

}  // namespace

std::vector<TrackerSetting> read_trackers(const StudyTable& experiment) {
  std::vector<TrackerSetting> settings;
  for (const StudyTable& table : experiment.tables("tracker")) {
    settings.push_back({table.text("name"), TrackOptions::keys().read(table)});
  }
  return settings;
}

std::vector<double> TrackingExperiment::settling(std::size_t tracker, std::size_t phase) const {
  std::vector<double> times;
  for (const TrackingRun& run : runs[tracker]) {
    const double t = run.settling_s[phase];
    times.push_back(std::isnan(t) ? kInfinity : t);
  }
  std::sort(times.begin(), times.end());
  return times;
}

int TrackingExperiment::false_alarms(std::size_t tracker, double window_s) const {
  int count = 0;
  for (const TrackingRun& run : runs[tracker]) {
    for (const estimation::Change& change : run.changes) {
      const std::size_t phase = phase_at(phase_s, change.detected_s);
      if (phase == 0 || change.detected_s > phase_s[phase] + window_s) ++count;
    }
  }
  return count;
}

double TrackingExperiment::unchanged_hours(std::size_t tracker, double window_s) const {
  double seconds = 0.0;
  for (std::size_t phase = 0; phase < phase_s.size(); ++phase) {
    const double end = phase + 1 < phase_s.size() ? phase_s[phase + 1] : rows.time.back();
    const double blind = phase == 0 ? trackers[tracker].options.detection.learn_s : window_s;
    seconds += std::max(0.0, end - phase_s[phase] - blind);
  }
  return seconds * static_cast<double>(runs[tracker].size()) / 3600.0;
}

double TrackingExperiment::detected(std::size_t tracker, std::size_t phase, double window_s) const {
  double count = 0.0;
  for (const TrackingRun& run : runs[tracker]) {
    count += std::any_of(run.changes.begin(), run.changes.end(), [&](const estimation::Change& c) {
      return c.detected_s >= phase_s[phase] && c.detected_s <= phase_s[phase] + window_s;
    });
  }
  return count / static_cast<double>(runs[tracker].size());
}

TrackingExperiment run_tracking_experiment(const ExperimentOptions& o, const std::vector<TrackerSetting>& trackers,
                                           Progress& progress) {
  TrackingExperiment out;
  out.rows = exact_rows(o, progress);
  out.trackers = trackers;
  out.phase_s = {out.rows.time.front()};
  out.phase_text = {"start"};
  std::map<double, std::string> phases;
  for (const double event : o.events_s) phases[event] = "event";
  for (const ModelChange& change : o.flight.changes) phases[change.time] = change.text;
  for (const auto& [time, text] : phases) {
    out.phase_s.push_back(time);
    out.phase_text.push_back(text);
  }
  const auto seeds = static_cast<std::size_t>(o.seeds);
  out.runs.assign(trackers.size(), std::vector<TrackingRun>(seeds));
  const CoefficientModel& model = o.flight.subject.model.at(o.coefficient);
  const Eigen::MatrixXd W = out.rows.error_covariance();
  const Settling settling(out);
  progress.stage("tracking");
  const auto track = [&](std::size_t seed) {
    const estimation::RegressionData data = noisy_rows(out.rows, o, seed);
    const auto n = static_cast<std::size_t>(data.regressors.cols());
    for (std::size_t m = 0; m < trackers.size(); ++m) {
      CoefficientTracker tracker(model, W, trackers[m].options, o.rate_Hz);
      for (Eigen::Index i = 0; i < data.regressors.rows(); ++i) {
        tracker.update(out.rows.time[i], {data.regressors.row(i).data(), n}, data.regressand(i));
      }
      TrackingRun& run = out.runs[m][seed];
      run.settling_s = settling.times(tracker.history());
      run.known_s = settling.known_from(tracker.history());
      run.excited_s = fully_excited(tracker.history(), n);
      run.changes = tracker.changes();
      run.triggers = tracker.regression().triggers();
      if (seed == 0) run.history = tracker.history();
    }
  };
  out.interrupted = !numerics::parallel_for(seeds, progress.threads(), track, [&](std::size_t done) {
    return progress.update(static_cast<double>(done) / static_cast<double>(seeds));
  });
  return out;
}

}  // namespace veridyn::aircraft
