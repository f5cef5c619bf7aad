#include "veridyn/aircraft/reproduction/reproduction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;

constexpr double kUnbiasedSigmas = 0.1;
constexpr double kUnbiasedShare = 0.01;
constexpr double kBiasedSigmas = 3.0;
constexpr double kLeastCoverage = 0.93, kLargestCoverage = 0.97;
constexpr double kHeldShare = 0.9;

std::vector<Method> read_methods(const StudyTable& experiment) {
  constexpr Method all[] = {Method::kOls, Method::kTls, Method::kGtls, Method::kPcaGtls};
  std::vector<Method> methods;
  for (const std::string& text : experiment.texts("methods")) {
    const auto* found =
        std::find_if(std::begin(all), std::end(all), [&](Method m) { return estimation::to_string(m) == text; });
    if (found == std::end(all)) {
      const std::vector<std::string> names{"OLS", "TLS", "GTLS", "PCA-GTLS"};
      experiment.fail("methods", fmt::format("'{}' is not a method{}", text, suggestion(text, names)));
    }
    methods.push_back(*found);
  }
  return methods;
}

/// View of an experiment and of what its study expects.
class Expectations {
 public:
  Expectations(const StudyTable& expect, const Reproduction& result) : expect_(expect), result_(result) {}

  std::vector<Check> check() {
    if (result_.batch) check_batch();
    if (result_.tracking) check_tracking();
    return std::move(checks_);
  }

 private:
  void add(bool passed, std::string text) { checks_.push_back({passed, std::move(text)}); }

  const BatchStatistics& method_of(const char* key, const std::string& name) const {
    for (const BatchStatistics& s : result_.batch->methods) {
      if (estimation::to_string(s.method) == name) return s;
    }
    expect_.fail(key, fmt::format("'{}' is not among experiment.methods", name));
  }

  std::size_t tracker_of(const char* key, const std::string& name) const {
    const auto& trackers = result_.tracking->trackers;
    for (std::size_t i = 0; i < trackers.size(); ++i) {
      if (trackers[i].name == name) return i;
    }
    expect_.fail(key, fmt::format("'{}' is not the name of a tracker", name));
  }

  void check_batch() {
    const Eigen::VectorXd& truth = result_.batch->rows.truth;
    const std::vector<std::string>& names = result_.batch->rows.names;
    if (expect_.has("unbiased")) {
      const std::string method = expect_.text("unbiased");
      const BatchStatistics& s = method_of("unbiased", method);
      double worst_sigma = 0.0, worst_share = 0.0;
      for (Eigen::Index i = 0; i < truth.size(); ++i) {
        worst_sigma = std::max(worst_sigma, s.bias(i, truth));
        if (std::abs(truth(i)) > 10.0 * s.sd(i))
          worst_share = std::max(worst_share, std::abs(s.mean(i) / truth(i) - 1.0));
      }
      add(worst_sigma <= kUnbiasedSigmas && worst_share <= kUnbiasedShare,
          fmt::format(
              "{}: means over {} seeds at most {:.3f} sigma from the truth (limit {}), {:.2f} % where the truth "
              "exceeds ten sigma (limit {:.0f} %)",
              method, s.estimates, worst_sigma, kUnbiasedSigmas, 100.0 * worst_share, 100.0 * kUnbiasedShare));
    }
    if (expect_.has("covers")) {
      const std::string method = expect_.text("covers");
      const BatchStatistics& s = method_of("covers", method);
      add(s.coverage.minCoeff() >= kLeastCoverage && s.coverage.maxCoeff() <= kLargestCoverage,
          fmt::format("{}: 95 % intervals hold the truth in {:.1f} to {:.1f} % of {} seeds (93 to 97 %)", method,
                      100.0 * s.coverage.minCoeff(), 100.0 * s.coverage.maxCoeff(), s.estimates));
    }
    if (expect_.has("covers_on_average")) {
      const std::string method = expect_.text("covers_on_average");
      const BatchStatistics& s = method_of("covers_on_average", method);
      add(s.coverage.mean() >= kLeastCoverage && s.coverage.mean() <= kLargestCoverage,
          fmt::format("{}: 95 % intervals hold the truth in {:.1f} % of {} seeds and parameters (93 to 97 %)", method,
                      100.0 * s.coverage.mean(), s.estimates));
    }
    if (expect_.has("biased")) {
      const std::string method = expect_.text("biased");
      const BatchStatistics& s = method_of("biased", method);
      Eigen::Index worst = 0;
      for (Eigen::Index i = 0; i < truth.size(); ++i) {
        if (s.bias(i, truth) > s.bias(worst, truth)) worst = i;
      }
      add(s.bias(worst, truth) > kBiasedSigmas,
          fmt::format("{}: the mean of {} is {:.4f}, the truth {:.4f}: {:.0f} times the scatter of an estimate away",
                      method, names[static_cast<std::size_t>(worst)], s.mean(worst), truth(worst),
                      s.bias(worst, truth)));
    }
    for (const auto& [key, below] : {std::pair{"output_error_below", true}, std::pair{"output_error_above", false}}) {
      const StudyTable limits = expect_.table_or_empty(key);
      for (const BatchStatistics& s : result_.batch->methods) {
        const std::string method(estimation::to_string(s.method));
        if (!limits.has(method)) continue;
        const double limit = limits.number(method, "1");
        const double largest = s.output_error.maxCoeff();
        const bool all = s.estimates == s.output_error.size();
        add(all && (below ? largest < limit : largest > limit),
            fmt::format("{}: output error |z_true - X_true theta| / max |z_true| reaches {:.2f} % over {} seeds ({} "
                        "{:.0f} %)",
                        method, 100.0 * largest, s.estimates, below ? "below" : "above", 100.0 * limit));
      }
    }
  }

  void check_tracking() {
    const TrackingExperiment& e = *result_.tracking;
    const auto names = [&](const char* key) {
      return expect_.has(key) ? expect_.texts(key) : std::vector<std::string>{};
    };
    for (const std::string& name : names("never_settles")) {
      const std::vector<double> times = e.settling(tracker_of("never_settles", name), 0);
      const auto never = std::count_if(times.begin(), times.end(), [](double t) { return std::isinf(t); });
      add(never == static_cast<long>(times.size()),
          fmt::format("{}: does not settle in {} of {} repetitions", name, never, times.size()));
    }
    for (const std::string& name : names("settles")) {
      const std::vector<double> times = e.settling(tracker_of("settles", name), 0);
      add(std::isfinite(times.back()),
          fmt::format("{}: settles in every repetition, after {:.0f} to {:.0f} s", name, times.front(), times.back()));
    }
    if (expect_.has("settles_when_excited")) {
      const std::string name = expect_.text("settles_when_excited");
      const TrackingRun& run = e.runs[tracker_of("settles_when_excited", name)][0];
      const double excited = fully_excited(run);
      const double settled = e.phase_s[0] + run.settling_s[0];
      const double after = expect_.number_or("settles_after", "s", 0.0);
      add(std::isfinite(excited) && std::isfinite(settled) && settled >= after,
          fmt::format("{}: every direction is excited at {:.0f} s, the estimate has settled at {:.0f} s{}", name,
                      excited, settled, after > 0.0 ? fmt::format(" (not before {:.0f} s)", after) : std::string{}));
    }
    if (expect_.has("faster")) {
      const StudyTable faster = expect_.table("faster");
      const std::string fast = faster.text("tracker"), slow = faster.text("than");
      const double factor = faster.number("factor", "1");
      const double a = median(e.settling(tracker_of("faster", fast), 1));
      const double b = median(e.settling(tracker_of("faster", slow), 1));
      add(std::isfinite(a) && b >= factor * a,
          fmt::format("{} settles within 5 % of the new value {:.1f} s after the change, {} {} (medians of {}): {:.1f} "
                      "times sooner (at least {:g})",
                      fast, a, slow, std::isinf(b) ? "never does" : fmt::format("after {:.1f} s", b), e.runs[0].size(),
                      b / a, factor));
    }
    const double window = expect_.positive_or("detection_window", "s", 30.0);
    for (const std::string& name : names("no_false_alarm")) {
      const std::size_t tracker = tracker_of("no_false_alarm", name);
      const int alarms = e.false_alarms(tracker, window);
      const double hours =
          static_cast<double>(e.runs[tracker].size()) * (e.rows.time.back() - e.rows.time.front()) / 3600.0;
      add(alarms == 0, fmt::format("{}: {} false alarms in {} flights, {:.2f} hours; the stated rate allows {:.2f}",
                                   name, alarms, e.runs[tracker].size(), hours,
                                   hours * 3600.0 / e.trackers[tracker].options.detection.false_alarm_interval_s));
    }
    for (const std::string& name : names("detects")) {
      for (std::size_t phase = 1; phase < e.phase_s.size(); ++phase) {
        const double share = e.detected(tracker_of("detects", name), phase, window);
        add(share == 1.0, fmt::format("{}: the change at {:.0f} s ({}) is detected within {:.0f} s in {:.0f} % of the "
                                      "repetitions",
                                      name, e.phase_s[phase], e.phase_text[phase], window, 100.0 * share));
      }
    }
    for (const std::string& name : names("settles_last")) {
      const std::size_t last = e.phase_s.size() - 1;
      const std::vector<double> times = e.settling(tracker_of("settles_last", name), last);
      add(std::isfinite(times.back()),
          fmt::format("{}: after {:.0f} s it settles in every repetition, within {:.0f} to {:.0f} s", name,
                      e.phase_s[last], times.front(), times.back()));
    }
    if (expect_.has("cut_off")) {
      const StudyTable cut = expect_.table("cut_off");
      const std::string name = cut.text("tracker");
      const double rate = result_.options.rate_Hz;
      const estimation::ForgettingOptions f = e.trackers[tracker_of("cut_off", name)].options.forgetting_at(rate);
      const double seconds = estimation::cut_off_time(f.square_weight(), rate), published = cut.number("seconds", "s");
      add(std::abs(seconds - published) < 0.1,
          fmt::format("lambda {} at {:g} Hz: a sample counts 5 % after {:.1f} s (published {:g} s)", f.lambda, rate,
                      seconds, published));
    }
    if (expect_.has("loses")) check_lost(expect_.table("loses"));
    if (expect_.has("holds")) check_held(expect_.table("holds"));
  }

  /// First time at which every direction stood above the threshold.
  double fully_excited(const TrackingRun& run) const {
    const auto n = static_cast<int>(result_.tracking->rows.names.size());
    for (std::size_t k = 0; k < run.history.time.size(); ++k) {
      if (run.history.excited[k] >= n) return run.history.time[k];
    }
    return kInfinity;
  }

  /// Largest share of the coefficient's deviation that some parameter's error amounts to at a stored moment.
  double error_share(const TrackHistory& h, std::size_t k) const {
    const ExactRows& rows = result_.tracking->rows;
    const auto after = std::lower_bound(rows.time.begin(), rows.time.end(), h.time[k] - 1e-9);
    const auto row = std::min<Eigen::Index>(after - rows.time.begin(), rows.truth_at.rows() - 1);
    const double deviation = std::sqrt((rows.regressand.array() - rows.regressand.mean()).square().mean());
    double worst = 0.0;
    for (std::size_t i = 0; i < h.value.size(); ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      const double rms = std::sqrt(rows.regressors.col(j).array().square().mean());
      worst = std::max(worst, std::abs(h.value[i][k] - rows.truth_at(row, j)) * rms / deviation);
    }
    return worst;
  }

  void check_lost(const StudyTable& loses) {
    const std::string name = loses.text("tracker");
    const double from = loses.number("from", "s"), to = loses.number("to", "s");
    const TrackHistory& h = result_.tracking->runs[tracker_of("loses", name)][0].history;
    double worst = 0.0;
    for (std::size_t k = 0; k < h.time.size(); ++k) {
      if (h.time[k] >= from && h.time[k] <= to) worst = std::max(worst, error_share(h, k));
    }
    add(worst > 0.5,
        fmt::format("{}: between {:.0f} and {:.0f} s an error of its parameters moves the coefficient by up to "
                    "{:.1f} times its standard deviation (more than 0.5)",
                    name, from, to, worst));
  }

  void check_held(const StudyTable& holds) {
    const TrackingExperiment& e = *result_.tracking;
    const std::string name = holds.text("tracker");
    const double to = holds.number("to", "s");
    const TrackHistory& h = e.runs[tracker_of("holds", name)][0].history;
    const auto n = static_cast<int>(e.rows.names.size());
    const double from = holds.number("from", "s");
    const auto first = static_cast<std::size_t>(std::lower_bound(h.time.begin(), h.time.end(), from) - h.time.begin());
    std::size_t poor = 0, held = 0, all = 0;
    double worst = 0.0;
    for (std::size_t k = first; k < h.time.size() && h.time[k] <= to; ++k) {
      ++all;
      poor += h.excited[k] < n;
      const double error = error_share(h, k);
      held += error <= 0.05;
      worst = std::max(worst, error);
    }
    const auto share = [&](std::size_t part) {
      return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(1, all));
    };
    add(share(held) >= kHeldShare && share(poor) > 0.1,
        fmt::format("{}: from {:.0f} to {:.0f} s it says that a direction is not excited in {:.0f} % of the time, and "
                    "no parameter's "
                    "error moves the coefficient by more than 5 % of its deviation in {:.1f} % of it (worst {:.1f} %)",
                    name, from, to, 100.0 * share(poor), 100.0 * share(held), 100.0 * worst));
  }

  static double median(const std::vector<double>& sorted) { return sorted[sorted.size() / 2]; }

  const StudyTable& expect_;
  const Reproduction& result_;
  std::vector<Check> checks_;
};

}  // namespace

bool Reproduction::passed() const {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const auto& c) { return c.passed; });
}

Reproduction reproduce(const StudyTable& root, Progress& progress) {
  Reproduction result;
  result.title = root.text("title");
  result.finding = root.text_or("finding", "");
  result.options = ExperimentOptions::read(root);
  const StudyTable experiment = root.table("experiment");
  const StudyTable expect = root.table("expect");
  const StudyTable published = root.table_or_empty("published");
  const CoefficientModel& model = result.options.flight.subject.model.at(result.options.coefficient);
  for (const char* method : {"OLS", "TLS", "GTLS"}) {
    const StudyTable values = published.table_or_empty(method);
    for (const std::string& name : model.parameter_names()) {
      if (values.has(name)) result.published[method][name] = values.number(name, "1");
    }
  }
  const std::vector<TrackerSetting> trackers = read_trackers(experiment);
  if (trackers.empty()) {
    result.batch = run_batch_experiment(result.options, read_methods(experiment), progress);
    result.interrupted = result.batch->interrupted;
  } else {
    result.tracking = run_tracking_experiment(result.options, trackers, progress);
    result.interrupted = result.tracking->interrupted;
  }
  if (result.interrupted) return result;
  result.checks = Expectations(expect, result).check();
  root.finish();
  return result;
}

}  // namespace veridyn::aircraft
