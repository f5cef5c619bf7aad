#include "veridyn/muscle/identification/emg_error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
namespace {

double without_error(double value, const EmgError& error, double x) {
  if (error.relative == 0.0) return value + error.absolute * x;
  if (error.absolute == 0.0) return value * std::exp(error.relative * x);
  const double ratio = error.relative / error.absolute;
  return std::sinh(std::asinh(ratio * value) + error.relative * x) / ratio;
}

}  // namespace

std::vector<EmgErrorShape> error_shapes(const EmgError& error, double begin, double end) {
  std::vector<EmgErrorShape> shapes;
  if (!error.any()) return shapes;
  for (int part = 0; part < kEmgErrorParts; ++part) {
    const double spacing = error.spacing() * std::pow(error.slow_s / error.spacing(), part / (kEmgErrorParts - 1.0));
    const auto last = static_cast<long>(std::ceil(end / spacing));
    for (auto i = static_cast<long>(std::floor(begin / spacing)); i <= last; ++i)
      shapes.push_back({static_cast<double>(i) * spacing, spacing, part});
  }
  return shapes;
}

ControlSignals without_errors(const ControlSignals& envelope, const EmgError& error,
                              const std::vector<EmgErrorShape>& shapes, const Eigen::Ref<const Eigen::VectorXd>& size) {
  // Before its first sample a signal has that value, but errors of their own.
  std::vector<double> times(envelope.times().begin(), envelope.times().end());
  std::size_t before = 0;
  if (times.size() > 1 && !shapes.empty() && shapes.front().knot < times.front()) {
    const double step = times[1] - times[0];
    before = static_cast<std::size_t>(std::ceil((times.front() - shapes.front().knot) / step));
    std::vector<double> earlier;
    for (std::size_t k = before; k > 0; --k) earlier.push_back(times.front() - static_cast<double>(k) * step);
    times.insert(times.begin(), earlier.begin(), earlier.end());
  }
  std::vector<double> exponent(times.size(), 0.0), values;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const EmgErrorShape& s = shapes[i];
    const auto first = std::lower_bound(times.begin(), times.end(), s.knot - s.spacing);
    for (auto t = first; t != times.end() && *t < s.knot + s.spacing; ++t)
      exponent[at(t - times.begin())] += size(signed_index(i)) * std::cos(0.5 * kPi * (*t - s.knot) / s.spacing);
  }
  for (std::size_t k = 0; k < times.size(); ++k)
    values.push_back(
        std::clamp(without_error(envelope.row(k < before ? 0 : k - before)[0], error, exponent[k]), 0.0, kMostEmg));
  return {std::move(times), std::move(values), 1, envelope.interpolation()};
}

}  // namespace veridyn::muscle
