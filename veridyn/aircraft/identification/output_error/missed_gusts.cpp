#include "veridyn/aircraft/identification/output_error/missed_gusts.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kSlowest_Hz = 0.01, kFastest_Hz = 10.0;

/// One-sided density of gusts along an axis [(m/s)^2/Hz] (MIL-F-8785C).
double dryden_density(const DrydenSettings& s, std::size_t axis, double airspeed, double frequency_Hz) {
  const std::array<double, 3> length{s.Lu, s.Lv, s.Lw}, sigma{s.sigma_u, s.sigma_v, s.sigma_w};
  const double time = length[axis] / airspeed, x2 = std::pow(2.0 * kPi * frequency_Hz * time, 2.0);
  const double variance = sigma[axis] * sigma[axis];
  if (axis == 0) return variance * 4.0 * time / (1.0 + x2);
  return variance * 2.0 * time * (1.0 + 3.0 * x2) / ((1.0 + x2) * (1.0 + x2));
}

}  // namespace

numerics::FirKernel gust_differentiator(double rate_Hz) {
  constexpr double kPass_Hz = 2.0;
  const double pass = std::min(kPass_Hz, 0.2 * rate_Hz);
  return numerics::low_pass_differentiator({.rate_Hz = rate_Hz, .pass_Hz = pass, .stop_Hz = 2.0 * pass});
}

MissedGusts::MissedGusts(const DrydenSettings& spectrum, double airspeed, const std::array<double, 3>& noise,
                         const numerics::FirKernel* input) {
  for (std::size_t i = 0; i <= kBands; ++i)
    border_Hz_[i] =
        kSlowest_Hz * std::pow(kFastest_Hz / kSlowest_Hz, static_cast<double>(i) / static_cast<double>(kBands));
  for (std::size_t i = 0; i < kBands; ++i) {
    const double f = 0.5 * (border_Hz_[i] + border_Hz_[i + 1]), width = border_Hz_[i + 1] - border_Hz_[i];
    const bool fast = input != nullptr && f < 0.5 * input->rate_Hz;
    const double passed = fast ? input->gain(f) / (2.0 * kPi * f) : 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double gust = dryden_density(spectrum, axis, airspeed, f);
      const bool seen = gust > 0.0 && std::isfinite(noise[axis]);
      const double taken = seen ? passed * gust / (gust + noise[axis]) : 0.0;
      const double by_noise = seen ? taken * taken * noise[axis] : 0.0;
      variance_[axis][i] = width * ((1.0 - taken) * (1.0 - taken) * gust + by_noise);
    }
  }
}

double MissedGusts::variance(std::size_t axis) const {
  double sum = 0.0;
  for (const double v : variance_[axis]) sum += v;
  return sum;
}

std::vector<std::array<double, 3>> MissedGusts::acceleration(std::size_t points, double step_s,
                                                             numerics::RandomStream& random) const {
  std::vector<std::array<double, 3>> out(points);
  for (std::size_t i = 0; i < kBands; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double omega = 2.0 * kPi * random.uniform(border_Hz_[i], border_Hz_[i + 1]);
      const double amplitude = omega * std::sqrt(variance_[axis][i]);
      const double cosine = random.normal(), sine = random.normal();
      std::complex<double> z(amplitude * cosine, amplitude * sine);
      const std::complex<double> turn = std::polar(1.0, omega * step_s);
      for (std::size_t k = 0; k < points; ++k, z *= turn) out[k][axis] += z.real();
    }
  }
  return out;
}

}  // namespace veridyn::aircraft
