#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// The words of a list, each of which must be one of `choices`.
std::vector<std::string> words_of(const StudyTable& table, const char* key, std::span<const std::string> choices) {
  if (!table.has(key)) return {};
  std::vector<std::string> words = table.texts(key);
  for (const std::string& word : words) {
    if (std::find(choices.begin(), choices.end(), word) == choices.end())
      table.fail(key, fmt::format("does not know '{}'; choices: {}", word, fmt::join(choices, ", ")));
  }
  return words;
}

double not_negative_or(const StudyTable& table, const char* key, const char* unit, double otherwise) {
  const double value = table.number_or(key, unit, otherwise);
  if (!(value >= 0.0)) table.fail(key, fmt::format("= {} must be >= 0", value));
  return value;
}

/// One number for each of CL, CD and CY.
std::array<double, 3> read_force_errors(const StudyTable& table, const char* key, std::array<double, 3> otherwise) {
  if (!table.has(key)) return otherwise;
  const std::vector<double> v = table.numbers(key, "1");
  if (v.size() != 3) table.fail(key, fmt::format("has {} numbers, expected [CL, CD, CY]", v.size()));
  for (const double value : v) {
    if (!(value >= 0.0)) table.fail(key, fmt::format("holds {}; all must be >= 0", value));
  }
  return {v[0], v[1], v[2]};
}

FilterKind read_filter(const StudyTable& table) {
  const std::array<std::string, 4> filters{"model-free", "model-based", "guarded", "none"};
  const std::string filter = table.choice_or("filter", filters, "model-free");
  return filter == "guarded"       ? FilterKind::kGuarded
         : filter == "model-based" ? FilterKind::kModelBased
         : filter == "none"        ? FilterKind::kNone
                                   : FilterKind::kModelFree;
}

std::optional<AssumedTurbulence> read_turbulence(const StudyTable& table) {
  if (table.is_table("turbulence")) return AssumedTurbulence{"study", read_dryden(table, "turbulence")};
  const std::array<std::string, 6> settings{"auto",         "none",         "low_light",
                                            "low_moderate", "medium_light", "medium_moderate"};
  const std::string setting = table.choice_or("turbulence", settings, "auto");
  return setting == "auto" ? std::nullopt : std::optional(named_turbulence(setting));
}

Eigen::Vector3d read_vane_position(const StudyTable& table) {
  if (!table.has("vane_position")) return Eigen::Vector3d::Zero();
  const std::vector<double> p = table.numbers("vane_position", "m");
  if (p.size() != 3) table.fail("vane_position", fmt::format("has {} numbers, expected [x, y, z]", p.size()));
  return {p[0], p[1], p[2]};
}

ReconstructOptions::Sigma read_sigma(const StudyTable& table) {
  const auto read = [&](const char* key, const char* unit) {
    return table.has(key) ? std::optional(table.positive(key, unit)) : std::nullopt;
  };
  return {.accelerometer = read("accelerometer", "m/s^2"),
          .gyro = read("gyro", "rad/s"),
          .attitude = read("attitude", "rad"),
          .velocity = read("velocity", "m/s"),
          .velocity_down = read("velocity_down", "m/s"),
          .dynamic_pressure = read("dynamic_pressure", "Pa"),
          .airspeed = read("airspeed", "m/s"),
          .alpha = read("alpha", "rad"),
          .beta = read("beta", "rad")};
}

ReconstructOptions::Delay read_delay(const StudyTable& table) {
  const auto read = [&](const char* key) { return table.number_or(key, "s", 0.0); };
  return {.velocity = read("velocity"),
          .attitude = read("attitude"),
          .pitot = read("pitot"),
          .alpha = read("alpha"),
          .beta = read("beta")};
}

}  // namespace

const char* to_string(FilterKind kind) {
  switch (kind) {
    case FilterKind::kModelFree:
      return "model-free";
    case FilterKind::kModelBased:
      return "model-based";
    case FilterKind::kGuarded:
      return "guarded";
    case FilterKind::kNone:
      return "none";
  }
  return "";
}

ReconstructOptions ReconstructOptions::read(const StudyTable& table) {
  ReconstructOptions o;
  o.filter = read_filter(table);
  if (table.has("estimate_file")) o.estimate_file = table.files("estimate_file").at(0);
  o.compare = table.flag_or("compare", o.compare);
  o.model_error = read_force_errors(table, "model_error", o.model_error);
  o.model_error_walk = read_force_errors(table, "model_error_walk", o.model_error_walk);
  o.guard = estimation::GuardOptions::read(table.table_or_empty("guard"));
  if (table.has("rate")) o.rate_Hz = table.positive("rate", "1/s");
  const std::array<std::string, 2> sensors{"auto", "reference"};
  const bool reference = table.choice_or("sensors", sensors, "auto") == "reference";
  o.sensors = reference ? NoiseSource::kReference : NoiseSource::kMeasured;
  o.turbulence = read_turbulence(table);
  o.turbulence_scale = table.positive_or("turbulence_scale", "1", o.turbulence_scale);

  const std::array<std::string, 9> errors{"gyro_bias", "accel_bias",  "gyro_scale",  "accel_scale", "alpha_bias",
                                          "beta_bias", "alpha_scale", "pitot_scale", "pitot_bias"};
  const std::vector<std::string> estimated = words_of(table, "estimate", errors);
  const auto listed = [](const std::vector<std::string>& words, const char* word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  o.gyro_bias = listed(estimated, "gyro_bias");
  o.accel_bias = listed(estimated, "accel_bias");
  o.gyro_scale = listed(estimated, "gyro_scale");
  o.accel_scale = listed(estimated, "accel_scale");
  o.alpha_bias = listed(estimated, "alpha_bias");
  o.beta_bias = listed(estimated, "beta_bias");
  o.alpha_scale = listed(estimated, "alpha_scale");
  o.pitot_scale = listed(estimated, "pitot_scale");
  o.pitot_bias = listed(estimated, "pitot_bias");
  const std::array<std::string, 3> air_sensors{"alpha", "beta", "pitot"};
  const std::vector<std::string> without = words_of(table, "without", air_sensors);
  o.use_alpha = !listed(without, "alpha");
  o.use_beta = !listed(without, "beta");
  o.use_pitot = !listed(without, "pitot");
  const std::array<std::string, 2> speeds{"true", "equivalent"};
  o.airspeed_is_true = table.choice_or("airspeed_is", speeds, "true") == "true";
  const std::array<std::string, 2> vanes{"sideslip", "flank"};
  o.beta_is_flank = table.choice_or("beta_vane", vanes, "sideslip") == "flank";
  o.vane_position = read_vane_position(table);

  o.wind_walk = not_negative_or(table, "wind_walk", "1", o.wind_walk);
  o.wind_down_walk = not_negative_or(table, "wind_down_walk", "1", o.wind_down_walk);
  o.initial_wind = table.positive_or("initial_wind", "m/s", o.initial_wind);
  o.initial_wind_down = table.positive_or("initial_wind_down", "m/s", o.initial_wind_down);
  o.min_airspeed = not_negative_or(table, "min_airspeed", "m/s", o.min_airspeed);
  o.max_gap = table.positive_or("max_gap", "s", o.max_gap);
  o.gate.threshold = table.positive_or("gate", "1", o.gate.threshold);
  o.gate.recovery_s = table.positive_or("gate_recovery", "s", o.gate.recovery_s);
  o.gate.dead_reckoning_s = table.positive_or("dead_reckoning", "s", o.gate.dead_reckoning_s);
  o.keep_innovations = table.flag_or("innovations", o.keep_innovations);
  o.sigma = read_sigma(table.table_or_empty("sigma"));
  o.delay = read_delay(table.table_or_empty("delay"));
  return o;
}

SensorSigma autopilot_floor() {
  return {.accelerometer = 0.15,
          .gyro = 0.5 * kDegree,
          .attitude = 2.0 * kDegree,
          .velocity = 0.15,
          .velocity_down = 0.25,
          .dynamic_pressure = 4.0,
          .airspeed = 0.3,
          .alpha = 0.4 * kDegree,
          .beta = 0.4 * kDegree};
}

DrydenSettings gust_spectrum(const std::string& setting, double scale) {
  DrydenSettings settings = dryden_settings(setting, "reconstruct.turbulence");
  settings.sigma_u *= scale;
  settings.sigma_v *= scale;
  settings.sigma_w *= scale;
  return settings;
}

AssumedTurbulence named_turbulence(const std::string& setting) { return {setting, gust_spectrum(setting)}; }

}  // namespace veridyn::aircraft
