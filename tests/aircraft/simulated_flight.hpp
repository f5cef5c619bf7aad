#pragma once

#include <cmath>
#include <string>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/simulation/simulation.hpp"

/// Flights of the built-in UnATRaP without stall, for the tests of filters that know the aircraft.
namespace veridyn::aircraft::testing {

struct Flown {
  Recording measured, truth;
  Subject subject;
};

struct FlightToFly {
  double airspeed = 20.0;
  double duration = 60.0;
  std::uint64_t seed = 1;
  bool longitudinal_gust = true;
};

inline Subject linear_unatrap() {
  Subject s = builtin_subject("unatrap", "test");
  s.model.stall.reset();  // bounds are linear
  return s;
}

inline Flown fly(const FlightToFly& c) {
  SimulationOptions o;
  o.subject = linear_unatrap();
  o.duration = c.duration;
  o.airspeed = c.airspeed;
  o.seed = c.seed;
  o.altitude = 300.0;
  o.turbulence = gust_spectrum("low_moderate");
  if (!c.longitudinal_gust) o.turbulence.sigma_u = 0.0;
  o.wind.mean = {4.0, -3.0, 0.0};
  o.manoeuvres.emplace();
  Progress quiet;
  SimulatedFlight f = simulate(o, quiet);
  return {std::move(f.measured), std::move(f.truth), o.subject};
}

inline ReconstructOptions reference_options() {
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  o.turbulence = named_turbulence("low_moderate");
  return o;
}

inline Reconstruction reconstructed(const Flown& f, const ReconstructOptions& o) {
  Progress quiet;
  return reconstruct(f.measured, o, quiet, &f.subject);
}

/// After the first `settle` seconds; both recordings have samples on the same stamps.
inline double rms_error(const Recording& estimate, const Recording& truth, const std::string& name,
                        double settle = 10.0) {
  const Channel& e = estimate.at(name);
  const Channel& t = truth.at(name);
  double sum = 0.0, count = 0.0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < e.size(); ++i) {
    const double at = e.times()[i];
    if (at < settle) continue;
    while (j + 1 < t.size() && t.times()[j + 1] <= at + 1e-9) ++j;
    sum += std::pow(e.value[i] - t.value[j], 2);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

}  // namespace veridyn::aircraft::testing
