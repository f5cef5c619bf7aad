#include "veridyn/aircraft/identification/validation/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/aircraft/model/wind_axes.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

/// Beyond these the prediction has left what any linear model is about.
constexpr double kLargestAngle_rad = 60.0 * kDegree;
constexpr double kLeastAirspeed_mps = 2.0;

using State = std::array<double, 3>;  // Va, alpha, beta

/// The inputs at one grid point.
struct GridInputs {
  FlightSample<double> sample;
  double roll = 0.0;
  double pitch = 0.0;
  double rho = 1.225;
  [[nodiscard]] bool complete() const {
    for (const FlightSignal s :
         {FlightSignal::kAlpha, FlightSignal::kBeta, FlightSignal::kAirspeed, FlightSignal::kAx, FlightSignal::kAy,
          FlightSignal::kAz, FlightSignal::kP, FlightSignal::kQ, FlightSignal::kR, FlightSignal::kElevator,
          FlightSignal::kAileron, FlightSignal::kRudder, FlightSignal::kThrust}) {
      if (!std::isfinite(sample[s])) return false;
    }
    return std::isfinite(roll) && std::isfinite(pitch);
  }
};

GridInputs middle(const GridInputs& a, const GridInputs& b) {
  GridInputs m;
  for (std::size_t i = 0; i < kFlightSignals; ++i) m.sample.value[i] = 0.5 * (a.sample.value[i] + b.sample.value[i]);
  m.roll = 0.5 * (a.roll + b.roll);
  m.pitch = 0.5 * (a.pitch + b.pitch);
  m.rho = 0.5 * (a.rho + b.rho);
  return m;
}

/// View of a flight over which a model is simulated.
class Predictor {
 public:
  Predictor(const FlightSignals& signals, const Subject& subject, std::span<const Coefficient> known)
      : signals_(signals), subject_(subject) {
    for (const Coefficient c : known) known_[c] = true;
  }

  [[nodiscard]] bool knows(Coefficient c) const { return known_[c]; }

  [[nodiscard]] GridInputs inputs(std::size_t k) const {
    return {signals_.sample(k), signals_.roll[k], signals_.pitch[k], signals_.air_density[k]};
  }

  [[nodiscard]] State measured(std::size_t k) const {
    const FlightSample<double> s = signals_.sample(k);
    return {s[FlightSignal::kAirspeed], s[FlightSignal::kAlpha], s[FlightSignal::kBeta]};
  }

  [[nodiscard]] State step(const State& x, const GridInputs& begin, const GridInputs& end) const {
    const double h = signals_.grid.step;
    const GridInputs half = middle(begin, end);
    const State k1 = rate(x, begin);
    const State k2 = rate(advance(x, k1, 0.5 * h), half);
    const State k3 = rate(advance(x, k2, 0.5 * h), half);
    const State k4 = rate(advance(x, k3, h), end);
    State next = x;
    for (std::size_t i = 0; i < 3; ++i) next[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    if (!knows(Coefficient::kCD)) next[0] = end.sample[FlightSignal::kAirspeed];
    return next;
  }

 private:
  static State advance(const State& x, const State& rate, double h) {
    return {x[0] + h * rate[0], x[1] + h * rate[1], x[2] + h * rate[2]};
  }

  [[nodiscard]] State rate(const State& x, const GridInputs& inputs) const {
    FlightSample<double> predicted = inputs.sample;
    predicted[FlightSignal::kAirspeed] = x[0];
    predicted[FlightSignal::kAlpha] = x[1];
    predicted[FlightSignal::kBeta] = x[2];
    const AeroCoefficients<double> model = subject_.model.evaluate(aero_variables(predicted, subject_, inputs.rho));
    // What is not modelled is taken as measured: without thrust and drag, their sum.
    const AeroCoefficients<double> measured = measured_coefficients(inputs.sample, subject_, inputs.rho);
    const auto pick = [&](Coefficient c) { return knows(c) ? select(model, c) : select(measured, c); };
    const WindAxesInput<double> input{.CL = pick(Coefficient::kCL),
                                      .CD = pick(Coefficient::kCD),
                                      .CY = pick(Coefficient::kCY),
                                      .p = inputs.sample[FlightSignal::kP],
                                      .q = inputs.sample[FlightSignal::kQ],
                                      .r = inputs.sample[FlightSignal::kR],
                                      .phi = inputs.roll,
                                      .theta = inputs.pitch,
                                      .thrust = inputs.sample[FlightSignal::kThrust],
                                      .dynamic_pressure_area = 0.5 * inputs.rho * subject_.wing_area * x[0] * x[0],
                                      .mass = subject_.mass};
    const WindAxesRate<double> r = wind_axes_rate(x[0], x[1], x[2], input);
    return {r.Va, r.alpha, r.beta};
  }

  const FlightSignals& signals_;
  const Subject& subject_;
  EnumArray<Coefficient, bool, kCoefficients> known_{};
};

/// What was done, in one sentence.
std::string text_of(const Validation& v) {
  if (!v.available()) return "no validation: neither CL nor CY was identified, or there was no hold-out";
  return fmt::format(
      "{} window{} of {:.1f} s ({:.0f} s in all) flown by the model on data that identification did not see, each "
      "started from the reconstructed state{}{}",
      v.windows, v.windows == 1 ? "" : "s", v.period_s, v.simulated_s,
      v.with_airspeed ? "" : "; airspeed was taken from the measurement, since CD was not identified",
      v.diverged > 0 ? fmt::format("; {} diverged and were cut", v.diverged) : "");
}

/// A quantity in one more flight, after what there is of it.
void append(std::vector<PredictedQuantity>& all, const PredictedQuantity& more, double shift_s) {
  auto found = std::ranges::find(all, more.name, &PredictedQuantity::name);
  if (found == all.end()) {
    all.push_back({.name = more.name, .unit = more.unit});
    found = all.end() - 1;
  }
  // Of all samples: squares add up.
  const double before = std::pow(found->last_value_rmse, 2.0) * static_cast<double>(found->fit.count);
  const double now = std::pow(more.last_value_rmse, 2.0) * static_cast<double>(more.fit.count);
  for (const double t : more.time) found->time.push_back(t + shift_s);
  found->measured.insert(found->measured.end(), more.measured.begin(), more.measured.end());
  found->predicted.insert(found->predicted.end(), more.predicted.begin(), more.predicted.end());
  const double scale = more.unit == "deg" ? 1.0 / kDegree : 1.0;
  std::vector<double> measured = found->measured, predicted = found->predicted;
  for (double& v : measured) v *= scale;
  for (double& v : predicted) v *= scale;
  found->fit = numerics::fit_measures(measured, predicted);
  found->last_value_rmse = std::sqrt((before + now) / std::max(1.0, static_cast<double>(found->fit.count)));
}

}  // namespace

const KeyTable<ValidationOptions>& ValidationOptions::keys() {
  using O = ValidationOptions;
  static const auto table = KeyTable<O>("validate", "How the model's predictions are compared with what was flown.")
                                .number("period", &O::period_s, "s", kPositive,
                                        "the simulation starts again from the measured state this often")
                                .with(&O::open_loop, OpenLoopOptions::keys());
  return table;
}

Validation validate_flight(const FlightSignals& signals, std::span<const TimeSpan> longitudinal,
                           std::span<const TimeSpan> lateral, const Subject& subject,
                           std::span<const Coefficient> known, const ValidationOptions& options) {
  Validation result;
  result.period_s = options.period_s;
  const Predictor predictor(signals, subject, known);
  result.with_airspeed = predictor.knows(Coefficient::kCD);

  const auto predict = [&](std::span<const TimeSpan> spans, std::vector<std::size_t> which) {
    static constexpr std::array<const char*, 3> kNames{"airspeed", "alpha", "beta"};
    std::vector<PredictedQuantity> quantities;
    for (const std::size_t i : which) quantities.push_back({.name = kNames[i], .unit = i == 0 ? "m/s" : "deg"});
    std::vector<double> time, held(which.size(), 0.0);
    const auto per_window = static_cast<std::size_t>(std::max(1.0, std::round(options.period_s / signals.grid.step)));
    for (const TimeSpan& span : spans) {
      const auto [first, last] = signals.indices(span);
      for (std::size_t begin = first; begin < last; begin += per_window) {
        const std::size_t end = std::min(begin + per_window, last);
        // A short remainder would make the figures look better than they are.
        if (end - begin < per_window / 2) continue;
        GridInputs now = predictor.inputs(begin);
        if (!now.complete()) continue;
        const State start = predictor.measured(begin);
        State x = start;
        ++result.windows;
        for (std::size_t k = begin; k < end; ++k) {
          const State truth = predictor.measured(k);
          time.push_back(signals.grid.at(k));
          for (std::size_t j = 0; j < which.size(); ++j) {
            quantities[j].measured.push_back(truth[which[j]]);
            quantities[j].predicted.push_back(x[which[j]]);
            held[j] += std::pow(truth[which[j]] - start[which[j]], 2.0);
          }
          if (k + 1 == end) break;
          const GridInputs next = predictor.inputs(k + 1);
          if (!next.complete()) break;
          x = predictor.step(x, now, next);
          now = next;
          const bool sane =
              x[0] > kLeastAirspeed_mps && std::abs(x[1]) < kLargestAngle_rad && std::abs(x[2]) < kLargestAngle_rad;
          if (!sane) {
            ++result.diverged;
            break;
          }
        }
        result.simulated_s += signals.grid.step * static_cast<double>(end - begin);
        // A gap between windows, so that no line is drawn across the restart.
        time.push_back(signals.grid.at(end - 1));
        for (PredictedQuantity& q : quantities) {
          q.measured.push_back(kNaN);
          q.predicted.push_back(kNaN);
        }
      }
    }
    for (std::size_t j = 0; j < quantities.size(); ++j) {
      PredictedQuantity& q = quantities[j];
      const double scale = q.unit == "deg" ? 1.0 / kDegree : 1.0;
      std::vector<double> measured = q.measured;
      std::vector<double> predicted = q.predicted;
      for (double& v : measured) v *= scale;
      for (double& v : predicted) v *= scale;
      q.fit = numerics::fit_measures(measured, predicted);
      q.last_value_rmse = scale * std::sqrt(held[j] / std::max(1.0, static_cast<double>(q.fit.count)));
      q.time = time;
      if (q.fit.count > 0) result.quantities.push_back(std::move(q));
    }
  };
  if (predictor.knows(Coefficient::kCL)) {
    predict(longitudinal, result.with_airspeed ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{1});
  }
  if (predictor.knows(Coefficient::kCY)) predict(lateral, {2});
  result.text = text_of(result);
  return result;
}

Validation validate_flights(std::span<const PreparedFlight> flights, RowUse use, const Subject& subject,
                            std::span<const Coefficient> known, const ValidationOptions& options) {
  const auto of = [&](const PreparedFlight& flight) {
    return validate_flight(flight.signals, spans_of(flight.segments.longitudinal, use),
                           spans_of(flight.segments.lateral, use), subject, known, options);
  };
  if (flights.size() == 1) return of(flights.front());
  Validation all;
  all.period_s = options.period_s;
  all.with_airspeed = std::ranges::find(known, Coefficient::kCD) != known.end();
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    Validation one = of(flight);
    all.windows += one.windows;
    all.diverged += one.diverged;
    all.simulated_s += one.simulated_s;
    for (const PredictedQuantity& q : one.quantities) append(all.quantities, q, flight.shift_s);
    if (one.available()) all.by_flight.push_back({flight.name, std::move(one.quantities)});
  }
  all.text = text_of(all);
  return all;
}

}  // namespace veridyn::aircraft
