#include "veridyn/aircraft/reconstruction/air_data_check.hpp"

#include <cmath>
#include <optional>

#include "veridyn/aircraft/sensors/air_data_consistency.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// An error as a check of the recording found it, and beyond what it counts.
struct Found {
  Determined error;
  double limit = 0.0;

  [[nodiscard]] bool seen() const { return std::abs(error.value) > 3.0 * error.sigma + limit; }
};

/// Where the airspeed is more than half of its upper tenth.
std::vector<TimeSpan> flying(const FlightStreams& s, std::span<const Segment> segments) {
  const Stream& pitot = s.sensors[kPitot];
  std::vector<double> sorted = pitot.v;
  std::vector<TimeSpan> spans;
  if (sorted.empty()) {
    for (const Segment& segment : segments) spans.push_back({segment.begin, segment.end});
    return spans;
  }
  const double tenth = value_of_rank(sorted, static_cast<std::size_t>(0.9 * static_cast<double>(sorted.size())));
  const double least = tenth * (s.pitot_is_pressure ? 0.25 : 0.5);
  constexpr double kGap_s = 1.0;
  for (std::size_t i = 0; i < pitot.t.size(); ++i) {
    if (!(pitot.v[i] > least)) continue;
    if (!spans.empty() && pitot.t[i] - spans.back().end < kGap_s) {
      spans.back().end = pitot.t[i];
    } else {
      spans.push_back({pitot.t[i], pitot.t[i]});
    }
  }
  return spans;
}

Channel density_of(const FlightStreams& s, const Recording& recording) {
  if (s.density_t.size() > 1 && s.density_t.size() == s.density.size())
    return make_channel("air_density", "kg/m^3", make_time_base(s.density_t), s.density);
  const TimeSpan span = recording.at("gyro_x").span();
  const double density = s.density.empty() ? 1.225 : s.density.front();
  return make_channel("air_density", "kg/m^3", make_time_base({span.begin, span.end}), {density, density});
}

/// Mean dynamic pressure [Pa].
double mean_pressure(const FlightStreams& s) { return numerics::mean(s.sensors[kPitot].v); }

/// What the checks say of an error; nothing where they do not determine it.
std::optional<Found> found_of(int error, const AirDataConsistency& air, const std::optional<VaneSlope>& slope,
                              const SolveTask& task) {
  constexpr double kScale = 0.02, kBias = 0.5 * kDegree, kSlope = 0.1;
  // The error is one of the pressure, which is as the square of the airspeed.
  const auto scale = [&]() -> std::optional<Found> {
    if (!air.airspeed_scale) return std::nullopt;
    const double k = air.airspeed_scale->value;
    return Found{{k * k - 1.0, 2.0 * k * air.airspeed_scale->sigma}, 2.0 * kScale};
  };
  switch (error) {
    case AirDataErrorVector::kAlphaBias:
      if (air.alpha) return Found{air.alpha->bias, kBias};
      break;
    case AirDataErrorVector::kBetaBias:
      if (air.beta) return Found{air.beta->bias, kBias};
      break;
    case AirDataErrorVector::kAlphaScale:
      if (slope) return Found{{slope->slope.value - 1.0, slope->slope.sigma}, kSlope};
      break;
    case AirDataErrorVector::kPitotScale:
      return scale();
    case AirDataErrorVector::kPitotBias:
      if (const std::optional<Found> relative = scale(); relative && !task.options->pitot_scale) {
        const double pressure = mean_pressure(*task.streams) / (1.0 + relative->error.value);
        return Found{{relative->error.value * pressure, relative->error.sigma * pressure}, relative->limit * pressure};
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace

AirDataErrors check_air_data_errors(const RunSetting& base, const SolveTask& task) {
  const ReconstructOptions& o = *task.options;
  const Recording& recording = *task.recording;
  const std::vector<TimeSpan> spans = flying(*task.streams, task.segments);
  const Channel density = density_of(*task.streams, recording);
  const AirDataConsistency air = air_data_consistency(recording, density, o.airspeed_is_true, spans);
  const std::optional<VaneSlope> slope =
      o.alpha_scale ? alpha_slope(recording, density, o.airspeed_is_true, spans) : std::nullopt;
  AirDataErrors result;
  result.index = estimated_air_data_errors(o);
  result.spectrum = base.motion.spectrum;
  const auto m = signed_index(result.index.size());
  result.covariance = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const int error = result.index[i];
    const double prior = air_data_error_priors()[error];
    const std::optional<Found> found = found_of(error, air, slope, task);
    const double precision = 1.0 / (prior * prior) + (found ? 1.0 / (found->error.sigma * found->error.sigma) : 0.0);
    result.covariance(i, i) = 1.0 / precision;
    if (!found) continue;
    result.value(error) = found->error.value / (found->error.sigma * found->error.sigma) / precision;
    if (!found->seen()) continue;
    // What is seen in spite of the prior is not drawn towards it.
    result.applied.push_back(i);
    result.value(error) = found->error.value;
    result.covariance(i, i) = found->error.sigma * found->error.sigma;
  }
  return result;
}

}  // namespace veridyn::aircraft::internal
