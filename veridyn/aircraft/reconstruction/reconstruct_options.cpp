#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using O = ReconstructOptions;

void read_turbulence(const StudyTable& table, const std::string& key, O& o) {
  o.turbulence.reset();
  if (table.is_table(key))
    o.turbulence = {"study", read_dryden(table, key)};
  else if (const std::string setting = table.text(key); setting != "auto")
    o.turbulence = {setting, dryden_settings(setting, table.place(key))};
}

const KeyTable<O::Sigma>& sigma_keys() {
  using S = O::Sigma;
  static const auto table =
      KeyTable<S>("sigma", "Standard deviations of white noise per sample, in place of what `sensors` says.")
          .number("accelerometer", &S::accelerometer, "m/s^2", kPositive, "each axis")
          .number("gyro", &S::gyro, "rad/s", kPositive, "each axis")
          .number("attitude", &S::attitude, "rad", kPositive, "each angle")
          .number("velocity", &S::velocity, "m/s", kPositive, "north and east")
          .number("velocity_down", &S::velocity_down, "m/s", kPositive, "down")
          .number("dynamic_pressure", &S::dynamic_pressure, "Pa", kPositive, "pitot tube")
          .number("airspeed", &S::airspeed, "m/s", kPositive, "pitot tube that gives a speed")
          .number("alpha", &S::alpha, "rad", kPositive, "vane")
          .number("beta", &S::beta, "rad", kPositive, "vane");
  return table;
}

const KeyTable<O::Delay>& delay_keys() {
  using D = O::Delay;
  static const auto table = KeyTable<D>("delay", "How late stamps are, on top of `[delays]`.")
                                .number("velocity", &D::velocity, "s", kAnyNumber, "of the ground velocity")
                                .number("attitude", &D::attitude, "s", kAnyNumber, "of the angles")
                                .number("pitot", &D::pitot, "s", kAnyNumber, "of dynamic pressure or airspeed")
                                .number("alpha", &D::alpha, "s", kAnyNumber, "of the vane")
                                .number("beta", &D::beta, "s", kAnyNumber, "of the vane");
  return table;
}

/// What the filter is, and what its model is worth.
KeyTable<O> filter_keys() {
  return KeyTable<O>("reconstruct")
      .choice(
          "filter", &O::filter,
          {{"model-free", FilterKind::kModelFree},
           {"model-based", FilterKind::kModelBased},
           {"guarded", FilterKind::kGuarded},
           {"none", FilterKind::kNone}},
          "`model-based`: the derivatives are known, and the accelerometer is a measurement; `guarded`: both side by "
          "side, the model-based one as long as its innovations allow; `none`: airspeed and flow angles as recorded")
      .file("estimate_file", &O::estimate_file,
            "`estimate.json` whose derivatives of CL, CD and CY the model-based filter takes")
      .otherwise("the subject's values")
      .flag("compare", &O::compare, "simulated flights: both filters are run and compared with the truth")
      .numbers("model_error", &O::model_error, "1", kNotNegative,
               "of CL, CD, CY: 1 sigma of constants by which they may be off; 0: the model is exact")
      .numbers("model_error_walk", &O::model_error_walk, "1", kNotNegative, "how these wander, in 1/sqrt(s)");
}

/// What is assumed of sensors and of the air.
KeyTable<O> assumption_keys() {
  return KeyTable<O>("reconstruct")
      .number("rate", &O::rate_Hz, "Hz", kPositive, "of the results")
      .otherwise("the gyro's stamps")
      .choice("sensors", &O::sensors, {{"auto", NoiseSource::kMeasured}, {"reference", NoiseSource::kReference}},
              "`auto`: the noise floor measured in each channel, but not less than what an ordinary autopilot's errors "
              "amount to; `reference`: the reference set, right for simulated recordings")
      .other(
          turbulence_key({"auto"},
                         "`auto`: spectrum and intensity of the largest likelihood of the innovations; a table as of "
                         "`[flight]`"),
          read_turbulence)
      .number("turbulence_scale", &O::turbulence_scale, "1", kPositive, "on the intensities, where they are given")
      .flags("estimate",
             {{"gyro_bias", &O::gyro_bias},
              {"accel_bias", &O::accel_bias},
              {"gyro_scale", &O::gyro_scale},
              {"accel_scale", &O::accel_scale},
              {"alpha_bias", &O::alpha_bias},
              {"beta_bias", &O::beta_bias},
              {"alpha_scale", &O::alpha_scale},
              {"pitot_scale", &O::pitot_scale},
              {"pitot_bias", &O::pitot_bias}},
             true, "errors of sensors to estimate; `alpha_scale` is the upwash")
      .flags("without", {{"alpha", &O::use_alpha}, {"beta", &O::use_beta}, {"pitot", &O::use_pitot}}, false,
             "sensors that the filter does not use")
      .choice("airspeed_is", &O::airspeed_is_true, {{"true", true}, {"equivalent", false}},
              "what a channel `airspeed` is; `equivalent`: indicated by a calibrated tube. `dynamic_pressure` is "
              "preferred where there is one")
      .choice("beta_vane", &O::beta_is_flank, {{"sideslip", false}, {"flank", true}},
              "what the channel `beta` is: asin(v/Va), or `flank` atan2(v, u)")
      .numbers("vane_position", &O::vane_position, "m", kAnyNumber,
               "of the vanes from the centre of gravity: forward, right, down");
}

/// What the filter goes by.
KeyTable<O> tuning_keys() {
  return KeyTable<O>("reconstruct")
      .number("wind_walk", &O::wind_walk, "1", kNotNegative,
              "random walk of the slow wind, horizontal, in m/s/sqrt(s): 0.02 is 1.2 m/s in an hour")
      .number("wind_down_walk", &O::wind_down_walk, "1", kNotNegative, "and vertical")
      .number("initial_wind", &O::initial_wind, "m/s", kPositive,
              "1 sigma of the slow wind before anything is known, north and east")
      .number("initial_wind_down", &O::initial_wind_down, "m/s", kPositive, "and vertical")
      .number("min_airspeed", &O::min_airspeed, "m/s", kNotNegative, "below it the vanes are not used")
      .number("max_gap", &O::max_gap, "s", kPositive,
              "without gyro or accelerometer for longer the estimate ends and starts again")
      .number(
          "gate", [](O & o) -> auto& { return o.gate.threshold; }, "1", kPositive,
          "innovations beyond this many sigma are dropped")
      .number(
          "gate_recovery", [](O & o) -> auto& { return o.gate.recovery_s; }, "s", kPositive,
          "a sensor dropped for this long is taken back with inflated variance")
      .number(
          "dead_reckoning", [](O & o) -> auto& { return o.gate.dead_reckoning_s; }, "s", kPositive,
          "a sensor refused for this much longer than accepted, and a twentieth of the recording, ends the "
          "reconstruction")
      .flag("innovations", &O::keep_innovations,
            "keeps those of every sensor: `innovations.csv`, and a figure in the report");
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

const KeyTable<ReconstructOptions>& ReconstructOptions::keys() {
  static const auto table = KeyTable<O>("reconstruct", "How the motion through the air is reconstructed.")
                                .with(filter_keys())
                                .with(assumption_keys())
                                .with(tuning_keys())
                                .table("guard", &O::guard, estimation::GuardOptions::keys())
                                .table("sigma", &O::sigma, sigma_keys())
                                .table("delay", &O::delay, delay_keys());
  return table;
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
