#include "bench/reproduction/aircraft/reproduction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/numerics/statistics.hpp"

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

/// "204 s", "228 to 376 s", "never" where there is no time.
std::string range_text(double first, double last) {
  if (!std::isfinite(first) || !std::isfinite(last)) return "never";
  const std::string from = fmt::format("{:.0f}", first), to = fmt::format("{:.0f}", last);
  return from == to ? from + " s" : fmt::format("{} to {} s", from, to);
}

/// Upper 95 % bound of a Poisson rate of which `count` events were seen in `hours`: 3/hours for none.
double most_alarms_per_hour(int count, double hours) {
  return 0.5 * numerics::chi_square_quantile(0.95, 2.0 * (count + 1.0)) / hours;
}

std::string alarm_text(const std::string& name, int alarms, double hours, double stated_per_hour) {
  const double bound = most_alarms_per_hour(alarms, hours);
  const bool shown = bound <= stated_per_hour;
  return fmt::format(
      "{}: {} false alarm{} in {:.1f} hours in which nothing changed: at most {:.2g} an hour (95 %); "
      "the stated rate is {:.2g} an hour{}",
      name, alarms, alarms == 1 ? "" : "s", hours, bound, stated_per_hour,
      shown ? "" : fmt::format(", which takes {:.0f} hours without an alarm to show", 3.0 / stated_per_hour));
}

/// View of an experiment and of what its study expects.
class Expectations {
 public:
  Expectations(const StudyTable& expect, const Reproduction& result) : expect_(expect), result_(result) {}

  std::vector<CheckOutcome> check() {
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
                      method, names[worst], s.mean(worst), truth(worst), s.bias(worst, truth)));
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
    if (expect_.has("settles_when_excited")) check_order("settles_when_excited", false);
    if (expect_.has("known_when_excited")) check_order("known_when_excited", true);
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
      add(alarms == 0, alarm_text(name, alarms, e.unchanged_hours(tracker, window), stated_per_hour(tracker)));
    }
    for (const std::string& name : names("false_alarm_rate")) {
      const std::size_t tracker = tracker_of("false_alarm_rate", name);
      const int alarms = e.false_alarms(tracker, window);
      const double hours = e.unchanged_hours(tracker, window), rate = stated_per_hour(tracker);
      // Fewer hours could not show the rate with no alarm at all, and so many alarms would come by chance at that rate.
      const bool enough = most_alarms_per_hour(0, hours) <= rate;
      const bool by_chance = alarms == 0 || numerics::chi_square_upper_p(2.0 * rate * hours, 2.0 * alarms) <= 0.95;
      add(enough && by_chance, alarm_text(name, alarms, hours, rate));
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

  [[nodiscard]] double stated_per_hour(std::size_t tracker) const {
    return 3600.0 / result_.tracking->trackers[tracker].options.detection.false_alarm_interval_s;
  }

  /// Does the estimate settle (or is it known) once every direction is excited, in this order, in every repetition?
  void check_order(const char* key, bool known) {
    const TrackingExperiment& e = *result_.tracking;
    const std::string name = expect_.text(key);
    double first_excited = kInfinity, last_excited = -kInfinity, first = kInfinity, last = -kInfinity;
    double earliest_error = kInfinity;
    std::size_t in_order = 0, before = 0;
    const std::vector<TrackingRun>& runs = e.runs[tracker_of(key, name)];
    for (const TrackingRun& run : runs) {
      const double settled = e.phase_s[0] + run.settling_s[0];
      const double then = known ? run.known_s : settled;
      first_excited = std::min(first_excited, run.excited_s), last_excited = std::max(last_excited, run.excited_s);
      first = std::min(first, then), last = std::max(last, then);
      earliest_error = std::min(earliest_error, settled);
      in_order += std::isfinite(run.excited_s) && std::isfinite(then) && then >= run.excited_s;
      before += then < run.excited_s;
    }
    std::string text = fmt::format(
        "{}: every direction is excited at {}, the estimate {} from {} on; in this order in "
        "{} of {} repetitions",
        name, range_text(first_excited, last_excited), known ? "is known to 5 %" : "has settled",
        range_text(first, last), in_order, runs.size());
    if (before > 0) text += fmt::format(", {} before what is claimed to be its cause", before);
    if (known && earliest_error < first_excited) {
      text += fmt::format(
          ". Its errors are below 5 % from {:.0f} s on already: what is excited last hardly moves the "
          "coefficient, and its held value does no harm",
          earliest_error);
    }
    add(in_order == runs.size(), std::move(text));
  }

  /// Largest share of the coefficient's deviation that some parameter's error amounts to at a stored moment.
  double error_share(const TrackHistory& h, std::size_t k) const {
    const ExactRows& rows = result_.tracking->rows;
    const auto after = std::lower_bound(rows.time.begin(), rows.time.end(), h.time[k] - 1e-9);
    const auto row = std::min<Eigen::Index>(after - rows.time.begin(), rows.truth_at.rows() - 1);
    const double deviation = std::sqrt((rows.regressand.array() - rows.regressand.mean()).square().mean());
    double worst = 0.0;
    for (std::size_t i = 0; i < h.value.size(); ++i) {
      const double rms = std::sqrt(rows.regressors.col(i).array().square().mean());
      worst = std::max(worst, std::abs(h.value[i][k] - rows.truth_at(row, i)) * rms / deviation);
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
  std::vector<CheckOutcome> checks_;
};

}  // namespace

bool Reproduction::passed() const {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const auto& c) { return c.passed; });
}

Reproduction reproduce(const StudyTable& root, Progress& progress) {
  Reproduction result;
  result.title = root.text("title");
  result.finding = root.text_or("finding", "");
  result.conditions = root.text_or("conditions", "");
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
