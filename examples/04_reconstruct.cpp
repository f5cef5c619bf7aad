// Airspeed, flow angles and wind from a recording, with error bars, without knowing the aircraft's aerodynamics.
//
// A flight of a built-in aircraft through turbulence is simulated with ordinary sensors, so that the estimate can be
// compared with the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

#include "picture.hpp"
#include "veridyn/aircraft.hpp"

int main() try {
  using namespace veridyn;
  const Study study = Study::parse(R"(
    seed = 1
    [subject]
    builtin = "unatrap"
    [flight]
    duration = 60
    wind = [4, -2, 0]
    turbulence = "low_light"
  )",
                                   "example 04");
  Progress silent;
  const aircraft::SimulatedFlight flight = aircraft::simulate_study(study.root(), silent);
  if (!flight.usable()) {
    std::fprintf(stderr, "%s\n", flight.message().c_str());
    return 1;
  }

  aircraft::ReconstructOptions options;
  options.sensors =
      aircraft::NoiseSource::kReference;  // these are the simulator's sensors; for a real log leave "auto"
  options.turbulence = aircraft::named_turbulence("low_light");  // or nothing: of the largest likelihood
  const aircraft::Reconstruction result = aircraft::reconstruct(flight.measured, options, silent);

  const Channel& alpha = result.smoothed.at("alpha");
  const Channel& sigma = result.smoothed.at("sigma_alpha");
  const Channel& truth = flight.truth.at("alpha");
  double squares = 0.0;
  std::size_t inside = 0, count = 0;
  std::vector<double> time, estimate, low, high, exact;
  for (std::size_t k = 0; k < alpha.size(); ++k) {
    const auto later = std::lower_bound(truth.times().begin(), truth.times().end(), alpha.times()[k] - 1e-6);
    if (later == truth.times().end()) continue;
    const double true_alpha = truth.value[static_cast<std::size_t>(later - truth.times().begin())];
    const double error = alpha.value[k] - true_alpha;
    squares += error * error;
    inside += std::abs(error) < 1.96 * sigma.value[k] ? 1 : 0;
    ++count;
    time.push_back(alpha.times()[k]);
    estimate.push_back(alpha.value[k] / kDegree);
    low.push_back((alpha.value[k] - 1.96 * sigma.value[k]) / kDegree);
    high.push_back((alpha.value[k] + 1.96 * sigma.value[k]) / kDegree);
    exact.push_back(true_alpha / kDegree);
  }
  picture::write(
      "04_reconstruct.csv",
      {{"time[s]", time}, {"alpha[deg]", estimate}, {"low[deg]", low}, {"high[deg]", high}, {"truth[deg]", exact}});
  const double rms_deg = std::sqrt(squares / static_cast<double>(count)) / kDegree;
  std::printf("alpha: error %.2f deg RMS, %.0f %% of it inside the 95 %% band\n", rms_deg,
              100.0 * static_cast<double>(inside) / static_cast<double>(count));
  for (const aircraft::QuantityReport& q : result.quantities) std::printf("  %s\n", q.statement.c_str());
  return rms_deg < 1.0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
