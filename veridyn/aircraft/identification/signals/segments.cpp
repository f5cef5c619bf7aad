#include "veridyn/aircraft/identification/signals/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {
namespace {

/// What is left of a block, less than this is no block [s].
constexpr double kShortestBlock_s = 1.0;
/// Interruptions of a flight up to this are one flight [s], and the shortest flight.
constexpr double kMergeFlights_s = 2.0;
constexpr double kShortestFlight_s = 5.0;
/// A recording up to this is a manoeuvre that was cut out of a flight, from so much on [s].
constexpr double kLongestManoeuvre_s = 20.0;
constexpr double kShortestManoeuvre_s = 1.0;

using Activities = std::vector<std::vector<double>>;

/// At each moment the largest of all.
std::vector<double> largest(const Activities& all) {
  if (all.empty()) return {};
  std::vector<double> most = all.front();
  for (const std::vector<double>& one : all)
    for (std::size_t i = 0; i < one.size(); ++i) most[i] = std::fmax(most[i], one[i]);
  return most;
}

/// Integrals of the squares of each.
std::vector<recording::InputShare> shares_of(const Activities& inputs, const numerics::UniformGrid& grid) {
  std::vector<recording::InputShare> shares;
  for (const std::vector<double>& input : inputs) {
    shares.emplace_back([&input, &grid](const TimeSpan& span) {
      const auto [first, last] = recording::grid_indices(grid, span);
      double sum = 0.0;
      for (std::size_t k = first; k < last; ++k)
        if (std::isfinite(input[k])) sum += input[k] * input[k];
      return sum;
    });
  }
  return shares;
}

}  // namespace

const char* to_string(Axis axis) { return axis == Axis::kLongitudinal ? "longitudinal" : "lateral"; }

const KeyTable<SegmentOptions>& SegmentOptions::keys() {
  using O = SegmentOptions;
  const auto spans = [](std::vector<TimeSpan> O::*member) {
    return [member](const StudyTable& t, const std::string& key, O& o) { o.*member = recording::read_spans(t, key); };
  };
  static const auto table =
      KeyTable<O>("segments", "Which stretches of a flight are used, and what for.")
          .number("min_airspeed", &O::min_airspeed_mps, "m/s", kAnyNumber, "below it the aircraft does not fly")
          .otherwise("0.8 of the speed where CL = 1.2 carries the weight")
          .number("min_input", &O::min_input_rad, "rad", kPositive,
                  "activity of the surfaces (rms about the mean over `window`) that counts as excitation, at least")
          .otherwise("0.01 rad, or in a gentle flight less, down to 0.05 deg")
          .number("ambient_factor", &O::ambient_factor, "1", kAnyNumber,
                  "and at least this many times that of the calmest fifth of the flight")
          .number("min_rate", &O::min_rate_radps, "rad/s", kPositive, "activity of the body rates that must answer")
          .otherwise("2 deg/s, or in a gentle flight less, down to 0.1 deg/s")
          .with(recording::SegmentOptions::keys())
          .other(recording::spans_key("longitudinal", "stretches that are used for lift, drag and pitching moment"),
                 spans(&O::longitudinal))
          .other(recording::spans_key("lateral", "stretches that are used for side force, roll and yaw"),
                 spans(&O::lateral));
  return table;
}

namespace {

/// Where the aircraft flies, and at which samples.
struct Airborne {
  std::vector<TimeSpan> spans;
  std::vector<bool> inside;
  bool is_manoeuvre = false;  ///< the recording is no flight, but one manoeuvre of one
};

/// A flight without the roll on the ground, launch and flare: from where it is clear of the ground, which it left at
/// the first of the samples or reached at the last. As it was where it never is.
TimeSpan clear_of_ground(const TimeSpan& span, const SegmentSignals& signals, const numerics::UniformGrid& grid,
                         double min_airspeed_mps) {
  constexpr double kClear_m = 5.0;
  TimeSpan flown = span;
  const auto [first, last] = recording::grid_indices(grid, span);
  if (signals.vel_down.size() < last || last <= first) return flown;
  const auto is_slow = [&](std::size_t k) { return k < grid.count && signals.airspeed[k] <= min_airspeed_mps; };
  const auto climbed = [&](std::size_t k, double sign) {
    return std::isfinite(signals.vel_down[k]) ? sign * signals.vel_down[k] * grid.step : 0.0;
  };
  if (first > 0 && is_slow(first - 1)) {
    double height = 0.0;
    std::size_t k = first;
    while (k < last && height < kClear_m) height += climbed(k++, -1.0);
    if (k < last) flown.begin = grid.at(k);
  }
  if (is_slow(last)) {
    double height = 0.0;
    std::size_t k = last;
    while (k > first && height < kClear_m) height += climbed(--k, 1.0);
    if (grid.at(k) > flown.begin) flown.end = grid.at(k);
  }
  return flown;
}

Airborne airborne(const SegmentSignals& signals, const numerics::UniformGrid& grid, double min_airspeed_mps) {
  Airborne found;
  found.spans = recording::merged(
      recording::stretches(grid, grid.count, [&](std::size_t i) { return signals.airspeed[i] > min_airspeed_mps; }),
      kMergeFlights_s);
  found.is_manoeuvre = grid.step * static_cast<double>(grid.count) <= kLongestManoeuvre_s;
  recording::drop_shorter(found.spans, found.is_manoeuvre ? kShortestManoeuvre_s : kShortestFlight_s);
  if (!found.is_manoeuvre)
    for (TimeSpan& span : found.spans) span = clear_of_ground(span, signals, grid, min_airspeed_mps);
  for (std::size_t i = 0; i < grid.count; ++i) {
    found.inside.push_back(
        std::any_of(found.spans.begin(), found.spans.end(), [&](const TimeSpan& s) { return s.contains(grid.at(i)); }));
  }
  return found;
}

/// A transport aircraft's manoeuvres move the elevator by tenths of a degree.
constexpr recording::LeastActivity kLeastInput{.usual = 0.01, .least = 0.05 * kDegree};
constexpr recording::LeastActivity kLeastRate{.usual = 0.035, .least = 0.1 * kDegree};

/// One axis: `inputs` are the activities of its surfaces, `rates` those of the body.
AxisSegments find_axis(Axis axis, const std::vector<TimeSpan>& given, const Activities& inputs, const Activities& rates,
                       const Airborne& flight, const numerics::UniformGrid& grid, const SegmentOptions& options) {
  const std::vector<double> input = largest(inputs), rate = largest(rates);
  AxisSegments found;
  found.axis = axis;
  found.given = !given.empty();
  if (found.given) {
    found.excited = given;
    found.text =
        fmt::format("{} segments: {} given in the study, {:.0f} s", to_string(axis), given.size(), found.excited_s());
  } else if (input.empty()) {
    found.text = fmt::format("{} segments: none, the log has no surface deflection", to_string(axis));
  } else {
    // The calmest part of a manoeuvre is part of the manoeuvre.
    found.ambient_input_rad = flight.is_manoeuvre ? 0.0 : recording::quantile_inside(input, flight.inside, 0.2);
    found.input_threshold_rad = std::max(options.min_input_rad.value_or(kLeastInput.of(input, flight.inside)),
                                         options.ambient_factor * found.ambient_input_rad);
    found.rate_threshold_radps = options.min_rate_radps.value_or(kLeastRate.of(rate, flight.inside));
    const auto excited = [&](std::size_t i) {
      return flight.inside[i] && input[i] > found.input_threshold_rad && rate[i] > found.rate_threshold_radps;
    };
    found.excited = recording::merged(recording::stretches(grid, grid.count, excited), options.merge_s);
    recording::drop_shorter(found.excited, flight.is_manoeuvre ? kShortestManoeuvre_s : options.min_duration_s);
    if (flight.is_manoeuvre && !found.excited.empty()) found.excited = flight.spans;
    found.text = fmt::format(
        "{} segments: {} found, {:.0f} s of {:.0f} s in the air, where {} activity over {:.0f} s exceeds {:.2f} deg "
        "(calmest fifth of the flight: {:.2f} deg) and the body rate answers with more than {:.2g} deg/s",
        to_string(axis), found.excited.size(), found.excited_s(), recording::total_s(flight.spans),
        axis == Axis::kLongitudinal ? "elevator" : "aileron or rudder", options.window_s,
        found.input_threshold_rad / kDegree, found.ambient_input_rad / kDegree, found.rate_threshold_radps / kDegree);
  }
  recording::AssignedBlocks blocks = recording::assign_blocks(found.excited, options, recording::Neighbours::kJoined,
                                                              kShortestBlock_s, shares_of(inputs, grid));
  found.identification = std::move(blocks.identification);
  found.holdout = std::move(blocks.holdout);
  return found;
}

}  // namespace

Segments find_segments(const SegmentSignals& signals, const SegmentOptions& options) {
  const numerics::UniformGrid grid{signals.begin, signals.step, signals.airspeed.size()};
  const Airborne flight = airborne(signals, grid, options.min_airspeed_mps);
  const auto half = static_cast<std::size_t>(0.5 * options.window_s / signals.step);
  const auto of = [&](std::initializer_list<std::span<const double>> all) {
    Activities activities;
    for (const std::span<const double> x : all)
      if (!x.empty()) activities.push_back(recording::activity(x, half));
    return activities;
  };
  Segments result;
  result.airborne = flight.spans;
  result.longitudinal = find_axis(Axis::kLongitudinal, options.longitudinal, of({signals.elevator}), of({signals.q}),
                                  flight, grid, options);
  result.lateral = find_axis(Axis::kLateral, options.lateral, of({signals.aileron, signals.rudder}),
                             of({signals.p, signals.r}), flight, grid, options);
  return result;
}

}  // namespace veridyn::aircraft
