#include "veridyn/aircraft/identification/signals/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

/// What is left of a block, less than this is no block [s].
constexpr double kShortestBlock_s = 1.0;
/// Interruptions of a flight up to this are one flight [s], and the shortest flight.
constexpr double kMergeFlights_s = 2.0;
constexpr double kShortestFlight_s = 5.0;

/// The larger of two, of which either may be missing.
std::vector<double> larger(std::vector<double> a, const std::vector<double>& b) {
  if (a.empty()) return b;
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = std::fmax(a[i], b[i]);
  return a;
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
};

Airborne airborne(const SegmentSignals& signals, const numerics::UniformGrid& grid, double min_airspeed_mps) {
  Airborne found;
  found.spans = recording::merged(
      recording::stretches(grid, grid.count, [&](std::size_t i) { return signals.airspeed[i] > min_airspeed_mps; }),
      kMergeFlights_s);
  recording::drop_shorter(found.spans, kShortestFlight_s);
  for (std::size_t i = 0; i < grid.count; ++i) {
    found.inside.push_back(
        std::any_of(found.spans.begin(), found.spans.end(), [&](const TimeSpan& s) { return s.contains(grid.at(i)); }));
  }
  return found;
}

/// A transport aircraft's manoeuvres move the elevator by tenths of a degree.
constexpr recording::LeastActivity kLeastInput{.usual = 0.01, .least = 0.05 * kDegree};
constexpr recording::LeastActivity kLeastRate{.usual = 0.035, .least = 0.1 * kDegree};

/// One axis: `input` is the activity of its surfaces, `rate` that of the body.
AxisSegments find_axis(Axis axis, const std::vector<TimeSpan>& given, const std::vector<double>& input,
                       const std::vector<double>& rate, const Airborne& flight, const numerics::UniformGrid& grid,
                       const SegmentOptions& options) {
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
    found.ambient_input_rad = recording::quantile_inside(input, flight.inside, 0.2);
    found.input_threshold_rad = std::max(options.min_input_rad.value_or(kLeastInput.of(input, flight.inside)),
                                         options.ambient_factor * found.ambient_input_rad);
    found.rate_threshold_radps = options.min_rate_radps.value_or(kLeastRate.of(rate, flight.inside));
    const auto excited = [&](std::size_t i) {
      return flight.inside[i] && input[i] > found.input_threshold_rad && rate[i] > found.rate_threshold_radps;
    };
    found.excited = recording::merged(recording::stretches(grid, grid.count, excited), options.merge_s);
    recording::drop_shorter(found.excited, options.min_duration_s);
    found.text = fmt::format(
        "{} segments: {} found, {:.0f} s of {:.0f} s in the air, where {} activity over {:.0f} s exceeds {:.2f} deg "
        "(calmest fifth of the flight: {:.2f} deg) and the body rate answers with more than {:.2g} deg/s",
        to_string(axis), found.excited.size(), found.excited_s(), recording::total_s(flight.spans),
        axis == Axis::kLongitudinal ? "elevator" : "aileron or rudder", options.window_s,
        found.input_threshold_rad / kDegree, found.ambient_input_rad / kDegree, found.rate_threshold_radps / kDegree);
  }
  recording::AssignedBlocks blocks =
      recording::assign_blocks(found.excited, options, recording::Neighbours::kJoined, kShortestBlock_s);
  found.identification = std::move(blocks.identification);
  found.holdout = std::move(blocks.holdout);
  return found;
}

}  // namespace

Segments find_segments(const SegmentSignals& signals, const SegmentOptions& options) {
  const numerics::UniformGrid grid{signals.begin, signals.step, signals.airspeed.size()};
  const Airborne flight = airborne(signals, grid, options.min_airspeed_mps);
  const auto half = static_cast<std::size_t>(0.5 * options.window_s / signals.step);
  const auto of = [&](std::span<const double> x) {
    return x.empty() ? std::vector<double>{} : recording::activity(x, half);
  };
  Segments result;
  result.airborne = flight.spans;
  result.longitudinal =
      find_axis(Axis::kLongitudinal, options.longitudinal, of(signals.elevator), of(signals.q), flight, grid, options);
  result.lateral = find_axis(Axis::kLateral, options.lateral, larger(of(signals.aileron), of(signals.rudder)),
                             larger(of(signals.p), of(signals.r)), flight, grid, options);
  return result;
}

}  // namespace veridyn::aircraft
