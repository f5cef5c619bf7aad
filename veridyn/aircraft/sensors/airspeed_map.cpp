#include "veridyn/aircraft/sensors/airspeed_map.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft::internal {
namespace {

bool is_given(const MapBuilder& builder) {
  return builder.given("airspeed") || builder.given("dynamic_pressure") || builder.mapped("airspeed") ||
         builder.mapped("dynamic_pressure");
}

/// ARSPD_RATIO as the log's own airspeed and pressure have it.
struct MeasuredRatio {
  double ratio = kNaN;
  double scatter = kNaN;  ///< share of it
};

/// Where the aircraft flies: below, offset and filter make up most of it.
std::optional<MeasuredRatio> measured_ratio(const Channel& pressure, const Channel& airspeed) {
  constexpr double kFlying_mps = 8.0;
  constexpr std::size_t kFew = 20;
  if (pressure.size() != airspeed.size()) return std::nullopt;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < airspeed.size(); ++i)
    if (airspeed.value[i] > kFlying_mps && pressure.value[i] > 0.0)
      ratios.push_back(airspeed.value[i] * airspeed.value[i] / pressure.value[i]);
  if (ratios.size() < kFew) return std::nullopt;
  const double ratio = numerics::median(ratios);
  return MeasuredRatio{ratio, numerics::robust_sd(ratios) / ratio};
}

struct ChosenRatio {
  double ratio;
  std::string note;
};

std::optional<ChosenRatio> chosen_ratio(const MapBuilder& builder, const std::optional<MeasuredRatio>& measured) {
  constexpr double kSame = 0.1, kSteady = 0.2;
  const auto parameter = builder.log().parameters.find("ARSPD_RATIO");
  const bool known = parameter != builder.log().parameters.end() && parameter->second > 0.0;
  if (known && (!measured || std::abs(measured->ratio / parameter->second - 1.0) < kSame))
    return ChosenRatio{parameter->second, fmt::format("times ARSPD_RATIO {:.4g}", parameter->second)};
  if (!measured || !(measured->scatter < kSteady)) return std::nullopt;
  return ChosenRatio{measured->ratio, fmt::format("times {:.4g}, the ratio of ARSP.Airspeed^2 to it{}", measured->ratio,
                                                  known ? ", which is not ARSPD_RATIO" : "")};
}

}  // namespace

void map_airspeed(MapBuilder& builder, std::span<const AirspeedSource> sources) {
  for (const AirspeedSource& one : sources) {
    if (!builder.log().has(one.source)) continue;
    if (is_given(builder)) {
      builder.leave(one.source, one.kind == AirspeedKind::kTrue ? "airspeed" : "dynamic_pressure");
      continue;
    }
    const Channel* raw = builder.alive(one.source);
    if (raw == nullptr) continue;
    std::vector<double> value = recording::in_si(*raw, 0.0, 1.0, one.unit);
    if (one.kind == AirspeedKind::kTrue) {
      builder.put("airspeed", "m/s", raw->time, std::move(value), one.source, one.note);
      continue;
    }
    if (one.kind == AirspeedKind::kEquivalent)
      for (double& v : value) v = 0.5 * kSeaLevelDensity * v * std::abs(v);
    builder.put("dynamic_pressure", "Pa", raw->time, std::move(value), one.source, one.note);
  }
}

void map_ardupilot_pressure(MapBuilder& builder) {
  if (is_given(builder) || !builder.log().has("ARSP.DiffPress")) return;
  const Channel* pressure = builder.alive("ARSP.DiffPress");
  if (pressure == nullptr) return;
  const Channel* airspeed = builder.alive("ARSP.Airspeed");
  const auto ratio = chosen_ratio(builder, airspeed != nullptr ? measured_ratio(*pressure, *airspeed) : std::nullopt);
  if (!ratio) return;
  std::vector<double> value = recording::in_si(*pressure, 0.0, 1.0, "Pa");
  for (double& v : value) v *= 0.5 * kSeaLevelDensity * ratio->ratio;
  builder.put("dynamic_pressure", "Pa", pressure->time, std::move(value), "ARSP.DiffPress", ratio->note);
}

}  // namespace veridyn::aircraft::internal
