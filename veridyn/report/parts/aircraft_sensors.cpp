#include "veridyn/report/parts/aircraft_sensors.hpp"

#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/report/figures/curves.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

Status badge_of(Observability observability) {
  return observability == Observability::kObservable ? Status::kGood
         : observability == Observability::kWeak     ? Status::kCaution
                                                     : Status::kBad;
}

Table sensor_error_table(const Reconstruction& rec) {
  Table table{.title = "Errors of the sensors and of the model",
              .caption =
                  "What was to be estimated: how much of it this flight determines, and with what it is entangled. "
                  "Information: share of the precision that the flight adds to what was assumed beforehand.",
              .columns = {{.name = "Error"},
                          {.name = "Value", .digits = 3},
                          {.name = "Sigma", .digits = 2},
                          {.name = "Assumed beforehand", .digits = 3},
                          {.name = "Unit"},
                          {.name = "Information", .unit = "%", .digits = 3},
                          {.name = "Most correlated with"},
                          {.name = "Correlation", .digits = 2},
                          {.name = "Verdict"}}};
  for (const SensorErrorReport& e : rec.sensor_errors) {
    const Status status = badge_of(e.observability);
    const std::string unit = display_unit(e.unit);
    table.rows.push_back({.cells = {text_cell(e.name), number_cell(aircraft::display_value(e.value, e.unit)),
                                    number_cell(aircraft::display_value(e.sigma, e.unit)),
                                    number_cell(aircraft::display_value(e.prior_sigma, e.unit)),
                                    text_cell(unit.empty() ? unit : unit.substr(1)), number_cell(100.0 * e.information),
                                    text_cell(e.correlated_with), number_cell(e.correlation),
                                    status_cell(status, to_string(e.observability))}});
  }
  return table;
}

/// Error over signal variance, the source's figure, as numbers.
Table comparison_table(const Reconstruction& rec) {
  Table table{.title = "Model-free against model-based filter",
              .caption =
                  "Root mean square errors against the truth of the simulated flight, the information bound of a "
                  "filter that knows the aircraft, and the share of the signal's variance that is error.",
              .columns = {{.name = "Quantity"},
                          {.name = "Unit"},
                          {.name = "Model-free filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Model-based filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Bound, filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Error/signal, model-free", .unit = "%", .digits = 3},
                          {.name = "model-based", .unit = "%", .digits = 3}}};
  for (const FilterError& e : rec.comparison) {
    const auto value = [&](double v) {
      return number_cell(v > 0.0 ? aircraft::display_value(v, e.unit) : std::nan(""));
    };
    const auto share = [&](double rms) { return number_cell(100.0 * std::pow(rms / e.signal_sd, 2)); };
    const std::string unit = display_unit(e.unit);
    table.rows.push_back(
        {.cells = {text_cell(e.quantity), text_cell(unit.substr(unit.empty() ? 0 : 1)), value(e.model_free.filter_rms),
                   value(e.model_free.smoother_rms), value(e.model_based.filter_rms), value(e.model_based.smoother_rms),
                   value(e.model_based.filter_bound), value(e.model_based.smoother_bound),
                   share(e.model_free.smoother_rms), share(e.model_based.smoother_rms)}});
  }
  return table;
}

Table channel_table(const PreparedFlight& flight) {
  Table channels{
      .title = "Channels",
      .columns = {
          {.name = "Channel"}, {.name = "From"}, {.name = "Rate", .unit = "Hz", .digits = 3}, {.name = "Note"}}};
  for (const ChannelOrigin& o : flight.aligned.origins) {
    channels.rows.push_back(
        {.cells = {text_cell(o.channel), text_cell(o.source), number_cell(o.rate_Hz), text_cell(o.note)}});
  }
  return channels;
}

Table delay_table(const PreparedFlight& flight) {
  Table delays{.title = "Delays",
               .caption = "Positive: the sensor reports late.",
               .columns = {{.name = "Group"},
                           {.name = "Compared with"},
                           {.name = "Delay", .unit = "ms"},
                           {.name = "Sigma", .unit = "ms"},
                           {.name = "Correlation", .digits = 2},
                           {.name = "Result"}}};
  for (const DelayReport& d : flight.delays) {
    delays.rows.push_back(
        {.cells = {text_cell(d.group), text_cell(d.reference), number_cell(1e3 * d.delay_s, 1),
                   number_cell(1e3 * d.sigma_s, 1), number_cell(d.correlation), text_cell(recording::says(d))}});
  }
  return delays;
}

Table innovation_table(const Reconstruction& rec) {
  Table sensors{
      .title = "Innovations",
      .caption =
          "Noise: the sensor's, as assumed (1 sigma). NIS: mean square of the innovations in units of what the filter "
          "expected; 1 when the assumed noise is right, above when the sensor is worse than assumed. Lag 1: "
          "autocorrelation, 0 when white. Mean, rms and the rms that the filter expected are in the sensor's unit.",
      .columns = {{.name = "Sensor"},
                  {.name = "Noise", .digits = 3},
                  {.name = "Mean", .digits = 2},
                  {.name = "Rms", .digits = 3},
                  {.name = "Expected", .digits = 3},
                  {.name = "Unit"},
                  {.name = "Samples"},
                  {.name = "Refused"},
                  {.name = "NIS", .digits = 3},
                  {.name = "Lag 1", .digits = 2}}};
  for (const SensorReport& s : rec.sensors) {
    const double scale = s.unit == "rad" ? 1.0 / kDegree : 1.0;
    const auto size = [&](double v) { return number_cell(s.innovations.count > 0 ? v * scale : kNaN); };
    sensors.rows.push_back({.cells = {text_cell(s.channel), number_cell(s.sigma * scale), size(s.innovations.mean_size),
                                      size(s.innovations.rms_size), size(s.innovations.expected_size),
                                      text_cell(s.unit == "rad" ? "deg" : s.unit),
                                      number_cell(static_cast<double>(s.innovations.count), 0),
                                      number_cell(static_cast<double>(s.innovations.rejected), 0),
                                      number_cell(s.innovations.nis), number_cell(s.innovations.lag1)}});
  }
  return sensors;
}

/// Innovations over time, a panel for each sensor, over the band in which 95 % of them should lie.
TimeSeries innovation_figure(const Reconstruction& rec) {
  TimeSeries figure{
      .title = "Innovations over time",
      .caption =
          "Each sample less what the filter expected of it just before; 95 % should lie between the dashed "
          "lines, and dots are beyond the gate. All of them are in innovations.csv."};
  for (const SensorReport& s : rec.sensors) {
    const Channel* innovation = rec.innovations.find(s.channel);
    if (innovation == nullptr || innovation->empty()) continue;
    const double scale = s.unit == "rad" ? 1.0 / kDegree : 1.0;
    const std::vector<double> time(innovation->times().begin(), innovation->times().end());
    std::vector<double> half = scaled(rec.innovations.at("sigma_" + s.channel).value, numerics::kNormal95 * scale);
    // What the first samples, before anything is known, would do to the panel's range.
    const double most = 4.0 * numerics::median(half);
    for (double& value : half)
      if (value > most) value = kNaN;
    Line above{.name = "97.5 %", .y = half, .x = time, .role = Role::kReference};
    Line below{.name = "2.5 %", .y = scaled(half, -1.0), .x = time, .role = Role::kReference};
    Line seen{.name = "innovation", .y = scaled(innovation->value, scale), .x = time, .role = Role::kMeasured};
    Line refused{.name = "refused", .style = Style::kMarkers};
    const std::vector<double>& gate = rec.innovations.at("refused_" + s.channel).value;
    for (std::size_t i = 0; i < gate.size(); ++i) {
      if (gate[i] == 0.0) continue;
      refused.x.push_back(time[i]);
      refused.y.push_back(seen.y[i]);
    }
    Panel panel{.label = s.channel, .unit = s.unit == "rad" ? "deg" : s.unit, .height = 100};
    panel.lines = {std::move(seen), std::move(above), std::move(below)};
    if (!refused.x.empty()) panel.lines.push_back(std::move(refused));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Table quantity_table(const Reconstruction& rec) {
  Table quantities{.title = "What the sensors determine",
                   .columns = {{.name = "Quantity"},
                               {.name = "Sigma", .digits = 3},
                               {.name = "Assumed beforehand", .digits = 3},
                               {.name = "Unit"},
                               {.name = "Verdict"},
                               {.name = "In words"}}};
  for (const QuantityReport& q : rec.quantities) {
    const double scale = q.unit == "rad" ? 1.0 / kDegree : 1.0;
    const Status status = badge_of(q.observability);
    quantities.rows.push_back(
        {.cells = {text_cell(q.quantity), number_cell(q.sigma * scale), number_cell(q.prior_sigma * scale),
                   text_cell(q.unit == "rad" ? "deg" : q.unit), status_cell(status, to_string(q.observability)),
                   text_cell(q.statement)}});
  }
  return quantities;
}

}  // namespace

Section sensors_section(const PreparedFlight& flight) {
  Section section{.title = "Sensors and state estimation", .id = "sensors", .folded = true};
  const Reconstruction& rec = flight.reconstruction;
  FactList facts{{{"Filter", to_string(rec.filter)},
                  {"Turbulence assumed", rec.turbulence_origin},
                  {"Air density from", rec.density_origin}}};
  if (rec.guard) facts.facts.push_back({"Guard", rec.guard->statement});
  section.blocks.emplace_back(std::move(facts));
  section.blocks.emplace_back(channel_table(flight));
  if (!flight.delays.empty()) section.blocks.emplace_back(delay_table(flight));
  section.blocks.emplace_back(innovation_table(rec));
  if (TimeSeries figure = innovation_figure(rec); !figure.panels.empty())
    section.blocks.emplace_back(std::move(figure));
  section.blocks.emplace_back(quantity_table(rec));
  if (!rec.sensor_errors.empty()) section.blocks.emplace_back(sensor_error_table(rec));
  if (!rec.comparison.empty()) section.blocks.emplace_back(comparison_table(rec));
  return section;
}

}  // namespace veridyn::report
