#include "veridyn/numerics/spectral_response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::string_view kInResponse = "frequency response";

/// Transforms of Hann-windowed segments that overlap by a half or a little more, one a row; scaled so that |X|^2 is a
/// one-sided density.
std::vector<std::vector<std::complex<double>>> segment_transforms(std::span<const double> x, double rate_Hz,
                                                                  std::size_t segment) {
  std::vector<double> window(segment);
  double power = 0.0;
  for (std::size_t i = 0; i < segment; ++i) {
    window[i] = 0.5 * (1.0 - std::cos(2.0 * kPi * static_cast<double>(i) / static_cast<double>(segment)));
    power += window[i] * window[i];
  }
  const double scale = std::sqrt(2.0 / (rate_Hz * power));
  Eigen::FFT<double> fft;
  std::vector<std::vector<std::complex<double>>> all;
  std::vector<double> piece(segment);
  std::vector<std::complex<double>> spectrum;
  // Spread evenly, so that the end of the record counts as well.
  const std::size_t slack = x.size() - segment;
  const std::size_t last = (2 * slack + segment - 1) / segment;
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t begin = last == 0 ? 0 : slack * i / last;
    double mean = 0.0;
    for (std::size_t k = 0; k < segment; ++k) mean += x[begin + k];
    mean /= static_cast<double>(segment);
    for (std::size_t k = 0; k < segment; ++k) piece[k] = scale * window[k] * (x[begin + k] - mean);
    fft.fwd(spectrum, piece);
    all.emplace_back(spectrum.begin(), spectrum.begin() + static_cast<std::ptrdiff_t>(segment / 2 + 1));
  }
  return all;
}

void require(std::span<const double> x, double rate_Hz, std::size_t segment) {
  if (!(rate_Hz > 0.0)) throw InputError(kInResponse, fmt::format("rate is {:g} Hz; must be > 0", rate_Hz));
  if (segment < 16 || segment > x.size()) {
    throw InputError(kInResponse, fmt::format("segments of {} samples; must be 16 to the length of the record, {}",
                                              segment, x.size()));
  }
  const auto bad = std::ranges::find_if_not(x, [](double value) { return std::isfinite(value); });
  if (bad != x.end()) throw InputError(kInResponse, fmt::format("sample {} is not finite", bad - x.begin() + 1));
}

}  // namespace

std::vector<ResponseEstimate> spectral_response(std::span<const double> input, std::span<const double> output,
                                                double rate_Hz, std::size_t segment, double low_Hz, double high_Hz) {
  if (input.size() != output.size()) {
    throw InputError(kInResponse, fmt::format("input has {} samples, output {}", input.size(), output.size()));
  }
  require(input, rate_Hz, segment);
  require(output, rate_Hz, segment);
  if (!(low_Hz > 0.0 && high_Hz > low_Hz && high_Hz <= 0.5 * rate_Hz)) {
    throw InputError(kInResponse,
                     fmt::format("band {:g} to {:g} Hz; must be 0 < low < high <= rate/2", low_Hz, high_Hz));
  }
  const auto X = segment_transforms(input, rate_Hz, segment);
  const auto Y = segment_transforms(output, rate_Hz, segment);
  // Half overlapping Hann windows hold 0.95 as much information each as separate ones would (Welch 1967).
  const double half_overlapping = 2.0 * static_cast<double>(input.size()) / static_cast<double>(segment) - 1.0;
  const double independent = std::max(1.0, 0.95 * half_overlapping);
  const double spacing = rate_Hz / static_cast<double>(segment);
  std::vector<ResponseEstimate> list;
  std::vector<double> density;
  for (std::size_t k = 1; k <= segment / 2; ++k) {
    const double frequency = spacing * static_cast<double>(k);
    if (frequency < low_Hz * (1.0 - 1e-9) || frequency > high_Hz * (1.0 + 1e-9)) continue;
    double xx = 0.0, yy = 0.0;
    std::complex<double> xy = 0.0;
    for (std::size_t s = 0; s < X.size(); ++s) {
      xx += std::norm(X[s][k]);
      yy += std::norm(Y[s][k]);
      xy += std::conj(X[s][k]) * Y[s][k];
    }
    if (!(xx > 0.0)) continue;
    ResponseEstimate one{.frequency_Hz = frequency, .response = xy / xx};
    one.coherence = yy > 0.0 ? std::min(1.0, std::norm(xy) / (xx * yy)) : 0.0;
    one.sigma =
        one.coherence > 0.0 ? std::sqrt((1.0 - one.coherence) / (2.0 * independent * one.coherence)) : kInfinity;
    list.push_back(one);
    density.push_back(xx);
  }
  if (density.empty()) return list;
  const double floor = 1e-6 * *std::ranges::max_element(density);
  std::vector<ResponseEstimate> kept;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (density[i] >= floor) kept.push_back(list[i]);
  }
  return kept;
}

}  // namespace veridyn::numerics
