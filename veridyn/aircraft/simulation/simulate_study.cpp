#include "veridyn/aircraft/simulation/simulate_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

namespace {

/// A change of the aircraft as the study has it.
struct GivenChange {
  double time = 0.0;
  StudyTable parameters = StudyTable();
};

const KeyTable<GivenChange>& change_keys() {
  static const auto table =
      KeyTable<GivenChange>("change",
                            "The aircraft changes in flight, in order of time; the autopilot keeps its gains.")
          .number("time", &GivenChange::time, "s", kPositive, "when")
          .required()
          .other({"parameters", "", "`{ Cm_alpha = -0.35 }`", "required",
                  "values from then on, by the names of parameters of the subject's model", true},
                 [](const StudyTable& t, const std::string& key, GivenChange& c) { c.parameters = t.table(key); })
          .required();
  return table;
}

void read_change(const StudyTable& table, SimulationOptions& o) {
  const GivenChange given = change_keys().read(table);
  if (!o.changes.empty() && !(given.time > o.changes.back().time))
    table.fail("time", fmt::format("= {:g} s is not after the change before it", given.time));
  ModelChange change{.time = given.time, .model = o.changes.empty() ? o.subject.model : o.changes.back().model};
  std::vector<std::string> texts;
  for (auto& coefficient : change.model.coefficients) {
    if (!coefficient) continue;
    const std::vector<std::string> names = coefficient->parameter_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!given.parameters.has(names[i])) continue;
      const double before = coefficient->values[i];
      coefficient->values[i] = given.parameters.number(names[i], coefficient->terms[i].parameter_unit());
      texts.push_back(fmt::format("{} {:.4g} to {:.4g}", names[i], before, coefficient->values[i]));
    }
  }
  if (texts.empty()) table.fail("parameters", "names no parameter of the subject's model");
  change.text = fmt::format("{}", fmt::join(texts, ", "));
  o.changes.push_back(std::move(change));
}

void check(const StudyTable& flight, SimulationOptions& o) {
  if (!(o.ground < o.altitude))
    flight.fail("ground", fmt::format("= {:g} is not below the altitude {:g}", o.ground, o.altitude));
  if (o.truth_rate > 1.0 / o.step * (1.0 + 1e-9))
    flight.fail("truth_rate", fmt::format("= {:g} Hz is above one sample a step, {:g} Hz", o.truth_rate, 1.0 / o.step));
}

/// Gives manoeuvres without amplitudes those that keep their effect small.
void complete_amplitudes(SimulationOptions& o) {
  const auto open = [](const Manoeuvre& m) { return m.amplitude.empty(); };
  if (!o.manoeuvres || std::ranges::none_of(*o.manoeuvres, open)) return;
  PerSurface<double> amplitudes{};
  if (o.subject.inertia && o.subject.model.unknown_parameters().empty()) {
    const Trim trim = find_trim(o.subject, {.airspeed = o.airspeed,
                                            .density = standard_atmosphere(o.altitude).density,
                                            .bank = 0.0,
                                            .gravity = o.gravity});
    amplitudes = default_amplitudes(o.subject, trim, linearise(o.subject, trim));
  }
  for (Manoeuvre& m : *o.manoeuvres) {
    if (!open(m)) continue;
    for (const Surface s : m.surfaces) m.amplitude.push_back(amplitudes[s]);
  }
}

}  // namespace

const KeyTable<SimulationOptions>& SimulationOptions::keys() {
  using O = SimulationOptions;
  static const auto table =
      KeyTable<O>("flight", "The flight that is simulated, by a study without `[data]`.")
          .number("duration", &O::duration, "s", share_up_to(86400.0), "how long it lasts")
          .number("altitude", &O::altitude, "m", between(-500.0, 20000.0), "above sea level, kept by the pilot")
          .number("ground", &O::ground, "m", kAnyNumber, "height of the ground above sea level, below `altitude`")
          .number("airspeed", &O::airspeed, "m/s", kPositive, "kept by the pilot")
          .otherwise("where the lift coefficient is 0.5")
          .number("heading", &O::heading, "rad", kAnyNumber, "at the start")
          .number("step", &O::step, "s", share_up_to(0.02), "of the integration")
          .number("truth_rate", &O::truth_rate, "Hz", kPositive, "of the truth recording; at most one sample a step")
          .number("gravity", &O::gravity, "m/s^2", kPositive, "acceleration of free fall")
          .with(&O::wind, WindSettings::keys())
          .other(turbulence_key({}, "gusts by Dryden's spectra (MIL-F-8785C), at low or medium altitude"),
                 [](const StudyTable& t, const std::string& key, O& o) { o.turbulence = read_dryden(t, key); })
          .flag("gust_gradients", &O::gust_gradients,
                "gusts differ over the aircraft, which acts as additional body rates p_g, q_g, r_g (MIL-F-8785C)")
          .number("excitation_gain", &O::excitation_gain, "1", from_to(0.0, 1.0),
                  "share of its feedback that the pilot keeps on a surface while it is excited")
          .other({"plan", "", "`\"default\"`, `\"none\"`", "\"default\"",
                  "where no manoeuvres are listed; `default`: five minutes that excite everything twice, repeated; "
                  "`none`: straight and level"},
                 [](const StudyTable& t, const std::string& key, O& o) {
                   const std::vector<std::string> plans{"default", "none"};
                   if (t.choice_or(key, plans, "") == "none") o.manoeuvres.emplace();
                 })
          .flag("log_commands", &O::log_commands,
                "the log has the commands to the servos in place of deflections, as autopilots write it")
          .number("lost_rows", &O::lost_rows, "1", {.low = 0.0, .high = 1.0, .with_high = false},
                  "share of rows of the log that are lost at random, each with all samples of its stamp")
          .tables("manoeuvre", Manoeuvre::keys(),
                  [](const StudyTable& one, O& o) {
                    if (!o.manoeuvres) o.manoeuvres.emplace();
                    o.manoeuvres->push_back(Manoeuvre::keys().read(one));
                  })
          .tables("change", change_keys(), read_change)
          .check([](const StudyTable& t, O& o) {
            // An empty list is a flight without manoeuvres, not that of the default plan.
            if (t.has("manoeuvre") && !o.manoeuvres) o.manoeuvres.emplace();
            check(t, o);
          });
  return table;
}

SimulationOptions read_simulation(const StudyTable& root) {
  SimulationOptions o;
  const long long seed = root.integer_or("seed", 1);
  if (seed < 0) root.fail("seed", fmt::format("= {} must be >= 0", seed));
  o.seed = static_cast<std::uint64_t>(seed);
  o.subject = read_subject(root.table("subject"));
  SimulationOptions::keys().read(root.table_or_empty("flight"), o);
  if (!(o.airspeed > 0.0)) o.airspeed = default_airspeed(o.subject);
  complete_amplitudes(o);
  o.sensors = read_sensors(root.table_or_empty("sensors"));
  return o;
}

SimulatedFlight simulate_study(const StudyTable& root, Progress& progress) {
  return simulate(read_simulation(root), progress);
}

}  // namespace veridyn::aircraft
