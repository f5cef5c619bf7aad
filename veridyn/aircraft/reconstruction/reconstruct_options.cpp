#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace veridyn::aircraft {
namespace {

constexpr double kDeg = M_PI / 180.0;

/// Sets the flags that a list of words names.
void set_flags(const StudyTable& table, const char* key, std::span<const std::pair<std::string, bool*>> words,
               bool value) {
  if (!table.has(key)) return;
  for (const std::string& word : table.texts(key)) {
    bool known = false;
    std::string choices;
    for (const auto& [name, flag] : words) {
      if (word == name) {
        *flag = value;
        known = true;
      }
      choices += (choices.empty() ? "" : ", ") + name;
    }
    if (!known) table.fail(key, fmt::format("does not know '{}'; choices: {}", word, choices));
  }
}

double not_negative_or(const StudyTable& table, const char* key, const char* unit, double otherwise) {
  const double value = table.number_or(key, unit, otherwise);
  if (!(value >= 0.0)) table.fail(key, fmt::format("= {} must be >= 0", value));
  return value;
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
  }
  return "";
}

ReconstructOptions ReconstructOptions::read(const StudyTable& table) {
  ReconstructOptions o;
  const std::array<std::string, 3> filters{"model-free", "model-based", "guarded"};
  const std::string filter = table.choice_or("filter", filters, "model-free");
  o.filter = filter == "guarded"       ? FilterKind::kGuarded
             : filter == "model-based" ? FilterKind::kModelBased
                                       : FilterKind::kModelFree;
  if (table.has("estimate_file")) o.estimate_file = table.files("estimate_file").at(0);
  o.compare = table.flag_or("compare", o.compare);
  const auto read_three = [&](const char* key, std::array<double, 3>& value) {
    if (!table.has(key)) return;
    const std::vector<double> v = table.numbers(key, "1");
    if (v.size() != 3) table.fail(key, fmt::format("has {} numbers, expected [CL, CD, CY]", v.size()));
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(v[i] >= 0.0)) table.fail(key, fmt::format("holds {}; all must be >= 0", v[i]));
      value[i] = v[i];
    }
  };
  read_three("model_error", o.model_error);
  read_three("model_error_walk", o.model_error_walk);
  o.guard = estimation::GuardOptions::read(table.table_or_empty("guard"));
  if (table.has("rate")) o.rate_Hz = table.positive("rate", "1/s");
  const std::array<std::string, 2> sensors{"auto", "reference"};
  o.sensors = table.choice_or("sensors", sensors, o.sensors);
  const std::array<std::string, 6> settings{"auto",         "none",         "low_light",
                                            "low_moderate", "medium_light", "medium_moderate"};
  if (table.is_table("turbulence")) {
    o.turbulence = "study";
    o.own_turbulence = read_dryden(table, "turbulence");
  } else {
    o.turbulence = table.choice_or("turbulence", settings, o.turbulence);
  }
  o.turbulence_scale = table.positive_or("turbulence_scale", "1", o.turbulence_scale);
  const std::array<std::pair<std::string, bool*>, 9> errors{{{"gyro_bias", &o.gyro_bias},
                                                             {"accel_bias", &o.accel_bias},
                                                             {"gyro_scale", &o.gyro_scale},
                                                             {"accel_scale", &o.accel_scale},
                                                             {"alpha_bias", &o.alpha_bias},
                                                             {"beta_bias", &o.beta_bias},
                                                             {"alpha_scale", &o.alpha_scale},
                                                             {"pitot_scale", &o.pitot_scale},
                                                             {"pitot_bias", &o.pitot_bias}}};
  set_flags(table, "estimate", errors, true);
  const std::array<std::pair<std::string, bool*>, 3> without{
      {{"alpha", &o.use_alpha}, {"beta", &o.use_beta}, {"pitot", &o.use_pitot}}};
  set_flags(table, "without", without, false);
  const std::array<std::string, 2> speeds{"true", "equivalent"};
  o.airspeed_is_true = table.choice_or("airspeed_is", speeds, "true") == "true";
  const std::array<std::string, 2> vanes{"sideslip", "flank"};
  o.beta_is_flank = table.choice_or("beta_vane", vanes, "sideslip") == "flank";
  if (table.has("vane_position")) {
    const std::vector<double> p = table.numbers("vane_position", "m");
    if (p.size() != 3) table.fail("vane_position", fmt::format("has {} numbers, expected [x, y, z]", p.size()));
    o.vane_position = Eigen::Vector3d(p[0], p[1], p[2]);
  }
  o.wind_walk = not_negative_or(table, "wind_walk", "1", o.wind_walk);
  o.wind_down_walk = not_negative_or(table, "wind_down_walk", "1", o.wind_down_walk);
  o.initial_wind = table.positive_or("initial_wind", "m/s", o.initial_wind);
  o.initial_wind_down = table.positive_or("initial_wind_down", "m/s", o.initial_wind_down);
  o.min_airspeed = not_negative_or(table, "min_airspeed", "m/s", o.min_airspeed);
  o.max_gap = table.positive_or("max_gap", "s", o.max_gap);
  o.gate.threshold = table.positive_or("gate", "1", o.gate.threshold);
  o.gate.recovery_s = table.positive_or("gate_recovery", "s", o.gate.recovery_s);

  const StudyTable sigma = table.table_or_empty("sigma");
  const auto read_sigma = [&](const char* key, const char* unit, std::optional<double>& value) {
    if (sigma.has(key)) value = sigma.positive(key, unit);
  };
  read_sigma("accelerometer", "m/s^2", o.sigma.accelerometer);
  read_sigma("gyro", "rad/s", o.sigma.gyro);
  read_sigma("attitude", "rad", o.sigma.attitude);
  read_sigma("velocity", "m/s", o.sigma.velocity);
  read_sigma("velocity_down", "m/s", o.sigma.velocity_down);
  read_sigma("dynamic_pressure", "Pa", o.sigma.dynamic_pressure);
  read_sigma("airspeed", "m/s", o.sigma.airspeed);
  read_sigma("alpha", "rad", o.sigma.alpha);
  read_sigma("beta", "rad", o.sigma.beta);

  const StudyTable delay = table.table_or_empty("delay");
  o.delay.velocity = delay.number_or("velocity", "s", 0.0);
  o.delay.attitude = delay.number_or("attitude", "s", 0.0);
  o.delay.pitot = delay.number_or("pitot", "s", 0.0);
  o.delay.alpha = delay.number_or("alpha", "s", 0.0);
  o.delay.beta = delay.number_or("beta", "s", 0.0);
  return o;
}

SensorSigma autopilot_floor() {
  return {.accelerometer = 0.15,
          .gyro = 0.5 * kDeg,
          .attitude = 2.0 * kDeg,
          .velocity = 0.15,
          .velocity_down = 0.25,
          .dynamic_pressure = 4.0,
          .airspeed = 0.3,
          .alpha = 0.4 * kDeg,
          .beta = 0.4 * kDeg};
}

DrydenSettings gust_spectrum(const std::string& setting, double scale) {
  DrydenSettings settings = dryden_settings(setting, "reconstruct.turbulence");
  settings.sigma_u *= scale;
  settings.sigma_v *= scale;
  settings.sigma_w *= scale;
  return settings;
}

}  // namespace veridyn::aircraft
