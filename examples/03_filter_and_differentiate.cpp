// Angular acceleration from a noisy gyro: differentiate and low-pass in one zero-phase filter.
//
// Both kernels have the same pass band, so a regressor smoothed by one and a regressand differentiated by the other
// have gone through the same filter: a linear relation between the raw signals holds between the filtered ones.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "picture.hpp"
#include "veridyn/numerics.hpp"

int main() {
  using namespace veridyn::numerics;
  constexpr double kRate_Hz = 100.0, kFrequency_Hz = 1.0, kNoise_radps = 0.006;
  const double omega = 2.0 * std::numbers::pi * kFrequency_Hz;
  RandomStream noise(1, "gyro");
  std::vector<double> gyro(3000), truth(3000);
  for (std::size_t k = 0; k < gyro.size(); ++k) {
    const double t = static_cast<double>(k) / kRate_Hz;
    gyro[k] = 0.3 * std::sin(omega * t) + kNoise_radps * noise.normal();
    truth[k] = 0.3 * omega * std::cos(omega * t);
  }

  const LowPassDesign band{.rate_Hz = kRate_Hz, .pass_Hz = 5.0, .stop_Hz = 7.5};
  const FirKernel differentiator = low_pass_differentiator(band);
  const std::vector<double> filtered = filter(gyro, differentiator, Edges::kNan);

  double squares = 0.0, plain = 0.0;
  std::vector<double> time, by_difference, by_filter, exact;
  std::size_t count = 0;
  for (std::size_t k = 1; k + 1 < gyro.size(); ++k) {
    if (!std::isfinite(filtered[k])) continue;  // the full kernel does not fit there
    const double difference = (gyro[k + 1] - gyro[k - 1]) * 0.5 * kRate_Hz;
    squares += std::pow(filtered[k] - truth[k], 2);
    plain += std::pow(difference - truth[k], 2);
    ++count;
    time.push_back(static_cast<double>(k) / kRate_Hz);
    by_difference.push_back(difference);
    by_filter.push_back(filtered[k]);
    exact.push_back(truth[k]);
  }
  picture::write("03_filter_and_differentiate.csv", {{"time[s]", time},
                                                     {"central_difference[rad/s^2]", by_difference},
                                                     {"filter[rad/s^2]", by_filter},
                                                     {"truth[rad/s^2]", exact}});
  const double error = std::sqrt(squares / static_cast<double>(count));
  const double predicted = kNoise_radps * std::sqrt(differentiator.noise_gain());
  std::printf("noise found above the band: %.4f rad/s (put in: %.4f)\n", measurement_noise(gyro, kRate_Hz, 10.0).sd,
              kNoise_radps);
  std::printf(
      "error of the derivative [rad/s^2]: filter %.4f (its noise gain predicts %.4f), central difference %.4f\n", error,
      predicted, std::sqrt(plain / static_cast<double>(count)));
  return error < 1.5 * predicted ? 0 : 1;
}
