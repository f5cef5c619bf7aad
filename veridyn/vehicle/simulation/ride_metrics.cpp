#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "veridyn/numerics/moments.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

namespace veridyn::vehicle {
namespace {

/// Central differences, one-sided at the ends.
std::vector<double> derivative(std::span<const double> x, double step) {
  std::vector<double> d(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, x.size() - 1);
    d[i] = (x[after] - x[before]) / (step * static_cast<double>(after - before));
  }
  return d;
}

/// rms of x after a filter of this gain, by Parseval. The record counts as periodic.
template <typename Gain>
double weighted_rms(std::span<const double> x, double rate_Hz, const Gain& gain) {
  Eigen::FFT<double> fft;
  std::vector<double> copy(x.begin(), x.end());
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, copy);
  const auto n = static_cast<double>(x.size());
  double sum = 0.0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double bin = static_cast<double>(std::min(k, x.size() - k));
    const double g = gain(rate_Hz * bin / n);
    sum += g * g * std::norm(spectrum[k]);
  }
  return std::sqrt(sum) / n;
}

}  // namespace

double iso2631_weight(double f) {
  if (!(f > 0.0)) return 0.0;
  // Corner frequencies [Hz] and resonance quality factors of W_k, table A.1.
  constexpr double f1 = 0.4, f2 = 100.0, f3 = 12.5, f4 = 12.5, Q4 = 0.63, f5 = 2.37, Q5 = 0.91, f6 = 3.35, Q6 = 0.91;
  const std::complex<double> s(0.0, f);  // in units of 2 pi
  const auto second_order = [&](double corner, double Q) { return 1.0 + s / (Q * corner) + s * s / (corner * corner); };
  const double root = std::numbers::sqrt2 / 2.0;
  const std::complex<double> high_pass = (s * s / (f1 * f1)) / second_order(f1, root);
  const std::complex<double> low_pass = 1.0 / second_order(f2, root);
  const std::complex<double> transition = (1.0 + s / f3) / second_order(f4, Q4);
  const std::complex<double> step = second_order(f5, Q5) / second_order(f6, Q6) * (f5 * f5) / (f6 * f6);
  return std::abs(high_pass * low_pass * transition * step);
}

std::vector<Metric> ride_metrics(const VehicleTrajectory& t) {
  std::vector<Metric> list;
  if (t.heave_rate.size() < 16 || t.heave_rate.size() != t.size()) return list;
  const double step = (t.time.back() - t.time.front()) / static_cast<double>(t.size() - 1);
  const std::vector<double> acceleration = derivative(t.heave_rate, step);
  list.push_back({"vertical_acceleration_rms", numerics::rms(acceleration), "m/s^2", "", "of the sprung mass"});
  list.push_back({"weighted_vertical_acceleration_rms", weighted_rms(acceleration, 1.0 / step, iso2631_weight), "m/s^2",
                  "ISO 2631-1", "weighted with W_k; above 0.315 a little, above 0.8 clearly uncomfortable"});
  double travel = 0.0, load = 0.0;
  for (std::size_t wheel = 0; wheel < kWheels; ++wheel) {
    if (t.suspension_travel[wheel].size() == t.size())
      travel = std::max(travel, numerics::rms(t.suspension_travel[wheel]));
    if (t.Fz[wheel].size() != t.size()) continue;
    std::vector<double> change = t.Fz[wheel];
    const double middle = numerics::mean(change);
    for (double& value : change) value -= middle;
    if (middle > 0.0) load = std::max(load, numerics::rms(change) / middle);
  }
  if (t.suspension_travel[0].size() == t.size()) {
    list.push_back({"suspension_travel_rms", travel, "m", "", "of the wheel that moves most"});
  }
  if (t.Fz[0].size() == t.size()) {
    list.push_back({"wheel_load_variation", load, "1", "", "standard deviation over mean, of the worst wheel"});
  }
  return list;
}

}  // namespace veridyn::vehicle
