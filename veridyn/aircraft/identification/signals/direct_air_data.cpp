#include "veridyn/aircraft/identification/signals/direct_air_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {

Recording direct_air_data(const Recording& recording, const ReconstructOptions& reconstruct,
                          const SignalOptions& options) {
  const internal::FlightStreams streams = internal::load_streams(recording, reconstruct);
  const internal::Stream& pitot = streams.sensors[internal::kPitot];
  if (pitot.t.empty()) {
    throw InputError(recording.source,
                     "has neither dynamic pressure nor airspeed, which coefficients without a filter need "
                     "(reconstruct.filter, track.air_data)");
  }
  Recording out;
  out.source = recording.source;
  out.frame = recording.frame;
  for (const char* name : {"roll", "pitch", "yaw", "vel_north", "vel_east", "vel_down"})
    if (const Channel* channel = recording.find(name)) out.add(*channel);
  for (const auto& [name, used] : {std::pair{"alpha", reconstruct.use_alpha}, std::pair{"beta", reconstruct.use_beta}})
    if (const Channel* channel = recording.find(name); channel != nullptr && used) out.add(*channel);

  // Airspeed at the pitot's stamps, filtered on an even grid of its rate.
  std::vector<double> airspeed(pitot.t.size()), density(pitot.t.size());
  std::size_t cursor = 0;
  for (std::size_t i = 0; i < pitot.t.size(); ++i) {
    density[i] = streams.density_at(pitot.t[i], cursor);
    airspeed[i] = streams.pitot_is_pressure ? std::sqrt(2.0 * std::max(0.0, pitot.v[i]) / density[i]) : pitot.v[i];
  }
  const double span = pitot.t.back() - pitot.t.front();
  const double rate = std::round(static_cast<double>(pitot.t.size() - 1) / std::max(span, 1e-3));
  const numerics::UniformGrid grid = numerics::UniformGrid::covering(pitot.t.front(), pitot.t.back(), 1.0 / rate);
  numerics::ResampleOptions resample;
  resample.gap_limit_s = std::max(0.5, 3.0 / rate);
  std::vector<double> even = numerics::resample(pitot.t, airspeed, grid, resample);
  numerics::LowPassDesign design;
  design.rate_Hz = rate;
  design.pass_Hz = std::min(options.pass_Hz > 0.0 ? options.pass_Hz : 10.0, rate / 5.0);
  design.stop_Hz = std::min(1.5 * design.pass_Hz, 0.5 * rate);
  const numerics::FirKernel kernel = numerics::low_pass(design);
  even = numerics::filter(even, kernel);

  std::vector<double> stamps(grid.count), sigma(grid.count), rho(grid.count);
  cursor = 0;
  for (std::size_t k = 0; k < grid.count; ++k) {
    stamps[k] = grid.at(k);
    rho[k] = streams.density_at(stamps[k], cursor);
    // sigma of q is constant, that of Va = sqrt(2 q / rho) is sigma_q / (rho Va).
    const double raw = streams.pitot_is_pressure ? pitot.sigma / (rho[k] * std::max(1.0, even[k])) : pitot.sigma;
    sigma[k] = std::isfinite(even[k]) ? raw * std::sqrt(kernel.noise_gain()) : kNaN;
  }
  out.information["airspeed"] = "as recorded";
  const TimeBase time = make_time_base(std::move(stamps));
  out.set(make_channel("airspeed", "m/s", time, std::move(even)));
  out.set(make_channel("sigma_airspeed", "m/s", time, std::move(sigma)));
  out.set(make_channel("air_density", "kg/m^3", time, std::move(rho)));
  // Of the centre of gravity, as a filter's are.
  const FlowSensors vanes = flow_sensors(reconstruct, out);
  if (vanes.exact()) return out;
  const CorrectedFlow flow = with_corrected_flow({.recording = recording}, vanes, out);
  for (const char* name : {"alpha", "beta"})
    if (out.has(name)) out.set(flow.mapped.recording.at(name));
  return out;
}

Reconstruction recorded_motion(const Recording& recording, const ReconstructOptions& reconstruct,
                               const SignalOptions& options) {
  const internal::FlightStreams streams = internal::load_streams(recording, reconstruct);
  Reconstruction motion;
  motion.smoothed = direct_air_data(recording, reconstruct, options);
  motion.filter = FilterKind::kNone;
  motion.sigma = streams.sigma;
  motion.density_origin = streams.density_origin;
  motion.turbulence_origin = "none: no filter";
  motion.segments = {motion.smoothed.at("airspeed").span()};
  motion.warnings = streams.warnings;
  motion.warnings.emplace_back("no filter: airspeed and flow angles are as recorded, wind and gusts are not estimated");
  for (const char* vane : {"alpha", "beta"})
    if (!motion.smoothed.has(vane))
      motion.warnings.push_back(fmt::format(
          "{} is not recorded, and without a filter nothing stands for it: what depends on it is skipped", vane));
  return motion;
}

}  // namespace veridyn::aircraft
