#include "veridyn/vehicle/road/iso8608_road.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string_view>
#include <unsupported/Eigen/FFT>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kReference = 0.1;  // n_0 [cycle/m]
constexpr double kStep = 0.02;      // of the table [m]
constexpr double kLongest = 100e3;

/// Variance of the waves between two wave numbers: the integral of the density.
double variance(const Iso8608Options& o, double from, double to) {
  const double scale = o.roughness * std::pow(kReference, o.waviness);
  if (o.waviness == 1.0) return scale * std::log(to / from);
  const double power = 1.0 - o.waviness;
  return scale * (std::pow(to, power) - std::pow(from, power)) / power;
}

double interpolated(const std::vector<double>& table, double position) {
  const auto count = static_cast<double>(table.size());
  position -= count * std::floor(position / count);
  const std::size_t size = table.size();
  const std::size_t i = std::min(static_cast<std::size_t>(position), size - 1);
  const double t = position - static_cast<double>(i);
  const double before = table[i == 0 ? size - 1 : i - 1];
  const double here = table[i];
  const double next = table[i + 1 < size ? i + 1 : i + 1 - size];
  const double after = table[i + 2 < size ? i + 2 : i + 2 - size];
  // Catmull and Rom's cubic: passes the samples with slopes from central differences.
  return here + 0.5 * t *
                    (next - before +
                     t * (2.0 * before - 5.0 * here + 4.0 * next - after + t * (3.0 * (here - next) + after - before)));
}

}  // namespace

double iso8608_roughness(char road_class) {
  if (road_class < 'A' || road_class > 'H')
    throw InputError("road class", fmt::format("'{}' is not one of A, B, C, D, E, F, G, H (ISO 8608)", road_class));
  return 16e-6 * std::pow(4.0, road_class - 'A');
}

void Iso8608Options::validate() const {
  const auto require = [](bool good, std::string_view name, double value, std::string_view rule) {
    if (!good) throw InputError("iso8608", fmt::format("{} = {} must be {}", name, value, rule));
  };
  require(roughness > 0.0 && roughness < 10.0, "roughness", roughness, "> 0 and < 10 m^3");
  require(waviness >= 1.0 && waviness <= 4.0, "waviness", waviness, "from 1 to 4");
  require(low > 0.0, "low", low, "> 0");
  require(high > low && high <= 5.0, "high", high, "> low and <= 5 cycle/m");
  require(length >= 10.0 && length <= kLongest, "length", length, "from 10 m to 100 km");
  require(length * low >= 1.0, "length", length, "at least one longest wave, 1/low");
  require(fade_in >= 0.0 && fade_in <= length, "fade_in", fade_in, ">= 0 and at most the length");
  require(coherence_length >= 0.0 && coherence_length < 1e6, "coherence_length", coherence_length, ">= 0");
}

Iso8608Road::Iso8608Road(const Iso8608Options& options) : fade_in_(options.fade_in) {
  options.validate();
  std::size_t size = 1024;
  while (static_cast<double>(size) * kStep < options.length) size *= 2;
  const double spacing = 1.0 / (static_cast<double>(size) * kStep);
  numerics::RandomStream random(options.seed, "road");
  using Complex = std::complex<double>;
  std::vector<Complex> left(size), right(size);
  for (std::size_t k = 1; k < size / 2; ++k) {
    const double n = spacing * static_cast<double>(k);
    // Each wave represents the part of the band next to it, so that the variances sum to that of the whole band.
    const double from = std::max(options.low, n - 0.5 * spacing);
    const double to = std::min(options.high, n + 0.5 * spacing);
    if (!(from < to)) continue;
    const double amplitude = std::sqrt(2.0 * variance(options, from, to));
    const double phase = random.uniform(0.0, 2.0 * kPi);
    // A phase between the tracks to either side: the mean of exp(i phase) over many waves is the coherence.
    const double coherence = std::exp(-n * options.coherence_length);
    const double between = (random.uniform() < 0.5 ? -1.0 : 1.0) * std::acos(std::min(1.0, coherence));
    const double scale = 0.5 * amplitude * static_cast<double>(size);
    left[k] = std::polar(scale, phase);
    right[k] = std::polar(scale, phase + between);
    left[size - k] = std::conj(left[k]);
    right[size - k] = std::conj(right[k]);
  }
  Eigen::FFT<double> fft;
  const auto to_table = [&](const std::vector<Complex>& spectrum, std::vector<double>& table) {
    std::vector<Complex> values;
    fft.inv(values, spectrum);
    table.resize(size);
    for (std::size_t i = 0; i < size; ++i) table[i] = values[i].real();
  };
  to_table(left, left_);
  to_table(right, right_);
}

double Iso8608Road::period() const { return kStep * static_cast<double>(left_.size()); }

double Iso8608Road::height(const RoadPoint& point) const {
  if (!(point.distance > 0.0)) return 0.0;
  const double position = point.distance / kStep;
  const double height = point.offset > 0.0   ? interpolated(left_, position)
                        : point.offset < 0.0 ? interpolated(right_, position)
                                             : 0.5 * (interpolated(left_, position) + interpolated(right_, position));
  if (point.distance >= fade_in_) return height;
  return 0.5 * (1.0 - std::cos(kPi * point.distance / fade_in_)) * height;
}

}  // namespace veridyn::vehicle
