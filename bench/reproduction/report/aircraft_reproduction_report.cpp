#include "bench/reproduction/report/aircraft_reproduction_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/track_panels.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

std::vector<double> column(const Eigen::MatrixXd& matrix, Eigen::Index j) {
  return {matrix.col(j).data(), matrix.col(j).data() + matrix.rows()};
}

/// NaN where none was published. GTLS is total least squares with the errors' covariance given, published as TLS.
double published_value(const Reproduction& r, estimation::Method method, const std::string& parameter) {
  auto found = r.published.find(std::string(estimation::to_string(method)));
  if (found == r.published.end() && method == estimation::Method::kGtls) found = r.published.find("TLS");
  return found != r.published.end() && found->second.contains(parameter) ? found->second.at(parameter) : kNaN;
}

/// " OLS: CY_beta -0.9803 +- 0.0007 (published -0.9804, true -0.98)." for every method with published values.
std::string side_by_side(const Reproduction& r) {
  std::string text;
  for (const BatchStatistics& s : r.batch->methods) {
    std::string values;
    for (std::size_t i = 0; i < r.batch->rows.names.size(); ++i) {
      const double published = published_value(r, s.method, r.batch->rows.names[i]);
      if (!std::isfinite(published)) continue;
      values += fmt::format("{}{} {:.4g} +- {:.1g} (published {:.4g}, true {:.4g})", values.empty() ? "" : ", ",
                            r.batch->rows.names[i], s.mean(i), s.sd(i), published, r.batch->rows.truth(i));
    }
    if (!values.empty()) text += fmt::format(" {}: {}.", estimation::to_string(s.method), values);
  }
  return text;
}

Table batch_table(const Reproduction& r) {
  const BatchExperiment& e = *r.batch;
  Table table;
  table.title = "Parameters";
  table.caption = fmt::format(
      "Mean and scatter over {} seeds of the noise. \"bias\" is the distance of the mean from the truth in units of "
      "the "
      "scatter; \"covered\" the share of 95 % intervals that hold the truth.",
      r.options.seeds);
  table.columns = {{.name = "parameter", .align = Align::kLeft}, {.name = "truth"}};
  for (const BatchStatistics& s : e.methods) {
    const std::string method(estimation::to_string(s.method));
    table.columns.push_back({.name = "published", .group = method});
    table.columns.push_back({.name = "mean", .group = method});
    table.columns.push_back({.name = "scatter", .digits = 2, .group = method});
    table.columns.push_back({.name = "bias", .group = method});
    table.columns.push_back({.name = "covered", .unit = "%", .group = method});
  }
  for (std::size_t i = 0; i < e.rows.names.size(); ++i) {
    Row row;
    row.cells = {text_cell(e.rows.names[i]), number_cell(e.rows.truth(i))};
    for (const BatchStatistics& s : e.methods) {
      row.cells.push_back(number_cell(published_value(r, s.method, e.rows.names[i])));
      row.cells.push_back(measured_cell(s.mean(i), s.sd(i)));
      row.cells.push_back(number_cell(s.sd(i)));
      row.cells.push_back(number_cell(s.bias(i, e.rows.truth), 2));
      row.cells.push_back(number_cell(100.0 * s.coverage(i), 1));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

TimeSeries batch_figure(const Reproduction& r) {
  const BatchExperiment& e = *r.batch;
  TimeSeries figure;
  figure.title = "True coefficient and what the first seed's estimates make of the true regressors";
  figure.samples = e.rows.time;
  figure.axis = r.title;
  Panel values{.label = std::string(name_of(r.options.coefficient)), .unit = "1"};
  Panel errors{.label = "error", .unit = "% of max"};
  const std::vector<double> truth(e.rows.regressand.data(), e.rows.regressand.data() + e.rows.regressand.size());
  const double largest = e.rows.regressand.cwiseAbs().maxCoeff();
  values.lines.push_back({.name = "truth", .y = truth, .role = Role::kReference});
  for (const BatchStatistics& s : e.methods) {
    if (s.example.empty()) continue;
    const std::string name(estimation::to_string(s.method));
    values.lines.push_back({.name = name, .y = s.example});
    std::vector<double> error(truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) error[k] = 100.0 * std::abs(s.example[k] - truth[k]) / largest;
    errors.lines.push_back({.name = name, .y = std::move(error)});
  }
  figure.panels = {values, errors};
  return figure;
}

Table tracking_table(const Reproduction& r) {
  const TrackingExperiment& e = *r.tracking;
  Table table;
  table.title = "Trackers";
  table.caption = fmt::format(
      "Over {} repetitions. Settling: of every parameter at the start, of what changed later (5 %, for the rest of the "
      "phase). Old samples count 5 % after the cut-off time.",
      r.options.seeds);
  table.columns = {{.name = "tracker", .align = Align::kLeft}, {.name = "cut-off", .unit = "s"}};
  for (std::size_t p = 0; p < e.phase_s.size(); ++p) {
    const std::string group = p == 0 ? "from the start" : fmt::format("change at {:.0f} s", e.phase_s[p]);
    table.columns.push_back({.name = "median", .unit = "s", .group = group});
    table.columns.push_back({.name = "slowest", .unit = "s", .group = group});
  }
  table.columns.push_back({.name = "alarms"});
  table.columns.push_back({.name = "forgetting triggered"});
  const auto seconds = [](double t) { return std::isfinite(t) ? number_cell(t, 1) : text_cell("never"); };
  for (std::size_t m = 0; m < e.trackers.size(); ++m) {
    Row row;
    const estimation::ForgettingOptions f = e.trackers[m].options.forgetting_at(r.options.rate_Hz);
    row.cells = {text_cell(e.trackers[m].name),
                 seconds(estimation::cut_off_time(f.square_weight(), r.options.rate_Hz))};
    for (std::size_t p = 0; p < e.phase_s.size(); ++p) {
      const std::vector<double> times = e.settling(m, p);
      row.cells.push_back(seconds(times[times.size() / 2]));
      row.cells.push_back(seconds(times.back()));
    }
    std::uint64_t alarms = 0, triggers = 0;
    for (const TrackingRun& run : e.runs[m]) alarms += run.changes.size(), triggers += run.triggers;
    row.cells.push_back(number_cell(static_cast<double>(alarms), 0));
    row.cells.push_back(number_cell(static_cast<double>(triggers), 0));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Where every direction stands above the threshold.
std::vector<Span> excited_spans(const TrackHistory& history, int parameters) {
  std::vector<Span> spans;
  for (std::size_t k = 0; k < history.time.size(); ++k) {
    if (history.excited[k] < parameters) continue;
    const bool goes_on = !spans.empty() && k > 0 && history.excited[k - 1] >= parameters;
    if (!goes_on)
      spans.push_back({.from = history.time[k], .to = history.time[k], .label = "excited", .tone = SpanTone::kPrimary});
    spans.back().to = history.time[k];
  }
  return spans;
}

TimeSeries tracking_figure(const Reproduction& r) {
  const TrackingExperiment& e = *r.tracking;
  TimeSeries figure;
  figure.title = "The first repetition";
  figure.caption = "Bands are 95 %. Shaded: every direction stands above the threshold of the last tracker.";
  figure.axis = r.title;
  const TrackHistory& first = e.runs[0][0].history;
  figure.samples = first.time;
  for (std::size_t i = 0; i < e.rows.names.size(); ++i) {
    Panel panel{.label = e.rows.names[i], .unit = "1"};
    panel.lines.push_back(
        {.name = "truth", .y = column(e.rows.truth_at, i), .x = e.rows.time, .role = Role::kReference});
    for (std::size_t m = 0; m < e.trackers.size(); ++m) {
      const TrackHistory& h = e.runs[m][0].history;
      Line line{.name = e.trackers[m].name, .y = h.value[i]};
      // Wild values before there are data would hide everything else.
      const double scale = e.rows.truth_at.col(i).cwiseAbs().maxCoeff();
      const double bound = scale > 0.0 ? 4.0 * scale : 1.0;
      Band band;
      for (std::size_t t = 0; t < line.y.size(); ++t) {
        const double sigma = h.sigma[i][t];
        if (std::abs(line.y[t]) > bound) line.y[t] = kNaN;
        const bool shown = std::isfinite(sigma) && std::isfinite(line.y[t]);
        band.low.push_back(shown ? std::max(-bound, line.y[t] - numerics::kNormal95 * sigma) : kNaN);
        band.high.push_back(shown ? std::min(bound, line.y[t] + numerics::kNormal95 * sigma) : kNaN);
      }
      if (m + 1 == e.trackers.size()) line.band = std::move(band);
      panel.lines.push_back(std::move(line));
    }
    figure.panels.push_back(std::move(panel));
  }
  const TrackHistory& last = e.runs.back()[0].history;
  if (!last.singular_value.empty()) figure.panels.push_back(singular_value_panel(last));
  Panel memory{.label = "lambda", .unit = "1"};
  Panel suspicion{.label = "suspicion (1: alarm)", .unit = "1"};
  for (std::size_t m = 0; m < e.trackers.size(); ++m) {
    memory.lines.push_back({.name = e.trackers[m].name, .y = e.runs[m][0].history.lambda});
    suspicion.lines.push_back({.name = e.trackers[m].name, .y = e.runs[m][0].history.suspicion});
  }
  figure.panels.push_back(std::move(memory));
  figure.panels.push_back(std::move(suspicion));
  figure.spans = excited_spans(last, static_cast<int>(e.rows.names.size()));
  return figure;
}

}  // namespace

ReproducedRow reproduced_row(const Reproduction& r) {
  ReproducedRow row{.title = r.title, .finding = r.finding, .checks = r.checks};
  const ExperimentOptions& o = r.options;
  std::string noise = fmt::format("noise of z {:g} dB below its variance", o.snr_dB);
  noise += o.regressor_snr_dB ? fmt::format(", of each regressor {:g} dB below its own", *o.regressor_snr_dB)
                              : ", regressors exact";
  if (o.noise_time_s > 0.0) noise += fmt::format(", correlated over {:g} s", o.noise_time_s);
  row.ours = fmt::format("{} flown for {:.0f} s, {:g} rows a second, {}, {} seeds.", o.flight.subject.name,
                         o.flight.duration, o.rate_Hz, noise, o.seeds);
  if (r.batch) row.ours += side_by_side(r);
  if (!r.conditions.empty()) row.ours += fmt::format(" {}.", r.conditions);
  if (r.batch) {
    row.blocks.push_back(batch_table(r));
    row.blocks.push_back(batch_figure(r));
  } else if (r.tracking) {
    row.blocks.push_back(tracking_table(r));
    row.blocks.push_back(tracking_figure(r));
  }
  return row;
}

}  // namespace veridyn::report
