#include "veridyn/aircraft/simulation/simulate_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace veridyn::aircraft {

namespace {

std::vector<ModelChange> read_changes(const StudyTable& flight, const AeroModel& model) {
  std::vector<ModelChange> changes;
  AeroModel current = model;
  for (const StudyTable& table : flight.tables("change")) {
    ModelChange change;
    change.time = table.positive("time", "s");
    if (!changes.empty() && !(change.time > changes.back().time)) {
      table.fail("time", fmt::format("= {:g} s is not after the change before it", change.time));
    }
    const StudyTable parameters = table.table("parameters");
    std::vector<std::string> texts;
    for (auto& coefficient : current.coefficients) {
      if (!coefficient) continue;
      const std::vector<std::string> names = coefficient->parameter_names();
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (!parameters.has(names[i])) continue;
        const double before = coefficient->values[i];
        coefficient->values[i] = parameters.number(names[i], coefficient->terms[i].parameter_unit());
        texts.push_back(fmt::format("{} {:.4g} to {:.4g}", names[i], before, coefficient->values[i]));
      }
    }
    if (texts.empty()) table.fail("parameters", "names no parameter of the subject's model");
    change.model = current;
    change.text = fmt::format("{}", fmt::join(texts, ", "));
    changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace

SimulationOptions read_simulation(const StudyTable& root) {
  SimulationOptions o;
  const long long seed = root.integer_or("seed", 1);
  if (seed < 0) root.fail("seed", fmt::format("= {} must be >= 0", seed));
  o.seed = static_cast<std::uint64_t>(seed);
  o.subject = read_subject(root.table("subject"));
  const StudyTable flight = root.table_or_empty("flight");
  o.duration = flight.positive_or("duration", "s", o.duration);
  if (o.duration > 86400.0) flight.fail("duration", fmt::format("= {:g} s is more than a day", o.duration));
  o.altitude = flight.number_or("altitude", "m", o.altitude);
  if (!(o.altitude > -500.0 && o.altitude < 20000.0)) {
    flight.fail("altitude", fmt::format("= {:g} must be from -500 to 20000 m", o.altitude));
  }
  o.ground = flight.number_or("ground", "m", o.ground);
  if (!(o.ground < o.altitude)) {
    flight.fail("ground", fmt::format("= {:g} is not below the altitude {:g}", o.ground, o.altitude));
  }
  o.airspeed = flight.positive_or("airspeed", "m/s", default_airspeed(o.subject));
  o.heading = flight.number_or("heading", "rad", o.heading);
  o.step = flight.positive_or("step", "s", o.step);
  if (o.step > 0.02)
    flight.fail("step", fmt::format("= {:g} s is above 0.02 s, too long for a small aircraft", o.step));
  o.truth_rate = flight.positive_or("truth_rate", "1/s", o.truth_rate);
  if (o.truth_rate > 1.0 / o.step * (1.0 + 1e-9)) {
    flight.fail("truth_rate", fmt::format("= {:g} Hz is above one sample a step, {:g} Hz", o.truth_rate, 1.0 / o.step));
  }
  o.gravity = flight.positive_or("gravity", "m/s^2", o.gravity);
  o.excitation_gain = flight.number_or("excitation_gain", "1", o.excitation_gain);
  if (!(o.excitation_gain >= 0.0 && o.excitation_gain <= 1.0)) {
    flight.fail("excitation_gain", fmt::format("= {:g} must be from 0 to 1", o.excitation_gain));
  }
  o.wind = read_wind(flight);
  o.turbulence = read_dryden(flight, "turbulence");
  o.sensors = read_sensors(root.table_or_empty("sensors"));
  const std::vector<std::string> plans = {"default", "none"};
  const std::string plan = flight.choice_or("plan", plans, "default");
  if (flight.has("manoeuvre")) {
    PerSurface<double> amplitudes{};
    if (o.subject.inertia && o.subject.model.unknown_parameters().empty()) {
      const Trim trim = find_trim(o.subject, {.airspeed = o.airspeed,
                                              .density = standard_atmosphere(o.altitude).density,
                                              .bank = 0.0,
                                              .gravity = o.gravity});
      amplitudes = default_amplitudes(o.subject, trim, linearise(o.subject, trim));
    }
    o.manoeuvres = read_manoeuvres(flight, amplitudes);
  } else if (plan == "none") {
    o.manoeuvres = std::vector<Manoeuvre>{};
  }
  o.changes = read_changes(flight, o.subject.model);
  return o;
}

SimulatedFlight simulate_study(const StudyTable& root, Progress& progress) {
  return simulate(read_simulation(root), progress);
}

}  // namespace veridyn::aircraft
