#include "veridyn/aircraft/reconstruction/reconstruct_solve_run.hpp"

namespace veridyn::aircraft::internal {

Monitors monitors_with(const estimation::InnovationGate& gate) {
  Monitors monitors;
  monitors.fill(estimation::InnovationMonitor(gate));
  return monitors;
}

AirDataNoise noise_of(const FlightStreams& s, const ReconstructOptions& o) {
  AirDataNoise noise;
  noise.gyro = s.sigma.gyro * std::sqrt(s.gyro.interval);
  noise.accelerometer = s.sigma.accelerometer * std::sqrt(s.accel.interval);
  noise.wind_walk = o.wind_walk;
  noise.wind_down_walk = o.wind_down_walk;
  return noise;
}

std::array<bool, kColumns.size()> wanted_columns(const ReconstructOptions& o, bool aerodynamics) {
  std::array<bool, kColumns.size()> wanted{};
  std::fill_n(wanted.begin(), kFirstImuBias, true);
  for (std::size_t k = 0; k < 3; ++k) {
    wanted[kFirstImuBias + k] = o.gyro_bias;
    wanted[kFirstImuBias + 3 + k] = o.accel_bias;
    wanted[kFirstImuScale + k] = o.gyro_scale;
    wanted[kFirstImuScale + 3 + k] = o.accel_scale;
    wanted[kFirstCoefficientError + k] = aerodynamics;
  }
  const std::array<bool, 5> errors{o.alpha_bias, o.beta_bias, o.alpha_scale, o.pitot_scale, o.pitot_bias};
  std::copy(errors.begin(), errors.end(), wanted.begin() + kFirstAirDataError);
  return wanted;
}

Solution solve_model_free(const SolveTask& task, Progress& progress) {
  const ReconstructOptions& o = *task.options;
  if (o.wants_imu_scales()) return solve<AirDataModel<12, false>>(task, progress);
  return o.wants_imu_biases() ? solve<AirDataModel<6, false>>(task, progress)
                              : solve<AirDataModel<0, false>>(task, progress);
}

std::array<double, 5> air_data_error_priors() {
  return {kVaneBiasPrior, kVaneBiasPrior, kAlphaScalePrior, kPitotScalePrior, kPitotBiasPrior};
}

std::vector<int> wanted_air_data_errors(const ReconstructOptions& o) {
  using Model = AirDataModel<0, false>;
  std::vector<int> index;
  if (o.alpha_bias) index.push_back(Model::kAlphaBias);
  if (o.beta_bias) index.push_back(Model::kBetaBias);
  if (o.alpha_scale) index.push_back(Model::kAlphaScale);
  if (o.pitot_scale) index.push_back(Model::kPitotScale);
  if (o.pitot_bias) index.push_back(Model::kPitotBias);
  return index;
}

}  // namespace veridyn::aircraft::internal
