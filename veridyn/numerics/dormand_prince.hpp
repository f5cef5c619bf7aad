#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/numerics/step_control.hpp"

namespace veridyn::numerics {

/// The fifth-order method of Dormand & Prince (1980) with fourth-order error estimate, PI step control and the
/// fourth-order continuous extension of Hairer, Norsett & Wanner (1993, II.6), for derivatives so cheap that the
/// stepper must cost nothing: it is a template on the derivative, keeps its stages, and does not allocate while it
/// steps. The last stage of a step is the first of the next, over calls of `advance` too.
///
/// `Scalar` is double or a Jet. With Jets the derivatives are those of the numerical solution at the steps taken, and
/// their errors are controlled like those of the values. Tangents are the same for a derivative that computes them
/// itself (variational equations): `tangents` numbers for each value follow the values, those of the first value first.
template <typename Scalar>
class DormandPrince {
 public:
  explicit DormandPrince(std::size_t size, std::size_t tangents = 0)
      : values_(size), tangents_(tangents), n_(size * (1 + tangents)), work_(kArrays * n_), column_(2 * tangents) {}

  /// The derivative jumps here (an input steps, the state was set): forget the last stage. `keep_step` keeps the size
  /// of the next step.
  void restart(bool keep_step = false) { sizes_.restart(keep_step); }

  /// Integrates x' = f(t, x) from `t` to `end` > t, changing `t` and `x`.
  ///
  /// `f(t, const Scalar* x, Scalar* rate)` returns false when the derivative does not exist there: the step is then
  /// tried again at a quarter of its size. `scale[i]` > 0 is the size of component i. After each accepted step
  /// `on_step(begin, end)` is called, in which `interpolate` gives the state anywhere between; it returns false to
  /// stop there.
  /// @returns kReached also when `on_step` stopped it; then t < end.
  template <typename F, typename OnStep>
  IntegrationEnd advance(F&& f, double& t, Scalar* x, double end, std::span<const double> scale,
                         const StepControl& control, OnStep&& on_step) {
    VERIDYN_ASSERT(scale.size() == values_ && end >= t);
    return sizes_.advance(
        t, end, control, [&] { return f(t, x, stage(0)) && finite(stage(0)); },
        [&](double interval) { return first_step(x, stage(0), scale, control.tolerance, 0.2, interval); },
        [&](double h) { return try_step(f, t, x, h); }, [&] { return error_of(scale, control); },
        [&](double reached) {
          begin_ = t;
          std::copy(x, x + n_, stage(kStart));
          const bool go_on = on_step(t, reached);
          std::copy(stage(kEnd), stage(kEnd) + n_, x);
          std::copy(stage(6), stage(6) + n_, stage(0));
          t = reached;
          return go_on;
        });
  }

  /// The state at `time` within the step that `on_step` was told of; call it there only. Fourth order.
  void interpolate(double time, Scalar* out) const {
    const double s = (time - begin_) / h_;
    const double r = 1.0 - s;
    const Scalar* const start = stage(kStart);
    constexpr double d1 = -12715105075.0 / 11282082432.0, d3 = 87487479700.0 / 32700410799.0,
                     d4 = -10690763975.0 / 1880347072.0, d5 = 701980252875.0 / 199316789632.0,
                     d6 = -1453857185.0 / 822651844.0, d7 = 69997945.0 / 29380423.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const Scalar difference = stage(kEnd)[i] - start[i];
      const Scalar bulge = h_ * stage(0)[i] - difference;
      const Scalar tail = difference - h_ * stage(6)[i] - bulge;
      const Scalar correction = h_ * (d1 * stage(0)[i] + d3 * stage(2)[i] + d4 * stage(3)[i] + d5 * stage(4)[i] +
                                      d6 * stage(5)[i] + d7 * stage(6)[i]);
      out[i] = start[i] + s * (difference + r * (bulge + s * (tail + r * correction)));
    }
  }

  /// Accepted and rejected steps so far.
  [[nodiscard]] long steps() const { return sizes_.steps(); }
  /// Of the next step.
  [[nodiscard]] double step_size() const { return sizes_.step_size(); }

 private:
  static constexpr std::size_t kEnd = 7, kScratch = 8, kArrays = 9;
  static constexpr std::size_t kStart = kScratch;  ///< between steps, when nothing else is in it
  [[nodiscard]] Scalar* stage(std::size_t i) { return work_.data() + i * n_; }
  [[nodiscard]] const Scalar* stage(std::size_t i) const { return work_.data() + i * n_; }

  bool finite(const Scalar* x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < n_; ++i) sum += internal::value_of(x[i]) * 0.0;
    return sum == 0.0;
  }

  template <typename F>
  bool try_step(F& f, double t, const Scalar* x, double h) {
    Scalar* const y = stage(kScratch);
    Scalar *k1 = stage(0), *k2 = stage(1), *k3 = stage(2), *k4 = stage(3), *k5 = stage(4), *k6 = stage(5),
           *k7 = stage(6);
    for (std::size_t i = 0; i < n_; ++i) y[i] = x[i] + (h * 0.2) * k1[i];
    if (!f(t + h * 0.2, y, k2)) return false;
    for (std::size_t i = 0; i < n_; ++i) y[i] = x[i] + h * ((3.0 / 40.0) * k1[i] + (9.0 / 40.0) * k2[i]);
    if (!f(t + h * 0.3, y, k3)) return false;
    for (std::size_t i = 0; i < n_; ++i) {
      y[i] = x[i] + h * ((44.0 / 45.0) * k1[i] - (56.0 / 15.0) * k2[i] + (32.0 / 9.0) * k3[i]);
    }
    if (!f(t + h * 0.8, y, k4)) return false;
    for (std::size_t i = 0; i < n_; ++i) {
      y[i] = x[i] + h * ((19372.0 / 6561.0) * k1[i] - (25360.0 / 2187.0) * k2[i] + (64448.0 / 6561.0) * k3[i] -
                         (212.0 / 729.0) * k4[i]);
    }
    if (!f(t + h * (8.0 / 9.0), y, k5)) return false;
    for (std::size_t i = 0; i < n_; ++i) {
      y[i] = x[i] + h * ((9017.0 / 3168.0) * k1[i] - (355.0 / 33.0) * k2[i] + (46732.0 / 5247.0) * k3[i] +
                         (49.0 / 176.0) * k4[i] - (5103.0 / 18656.0) * k5[i]);
    }
    if (!f(t + h, y, k6)) return false;
    Scalar* const end = stage(kEnd);
    for (std::size_t i = 0; i < n_; ++i) {
      end[i] = x[i] + h * ((35.0 / 384.0) * k1[i] + (500.0 / 1113.0) * k3[i] + (125.0 / 192.0) * k4[i] -
                           (2187.0 / 6784.0) * k5[i] + (11.0 / 84.0) * k6[i]);
    }
    if (!finite(end) || !f(t + h, end, k7) || !finite(k7)) return false;
    h_ = h;
    return true;
  }

  /// Largest estimated error of the step in units of what is allowed.
  double error_of(std::span<const double> scale, const StepControl& control) {
    constexpr double e1 = 71.0 / 57600.0, e3 = -71.0 / 16695.0, e4 = 71.0 / 1920.0, e5 = -17253.0 / 339200.0,
                     e6 = 22.0 / 525.0, e7 = -1.0 / 40.0;
    const auto combined = [&](const auto& part) {
      return h_ * (e1 * part(0) + e3 * part(2) + e4 * part(3) + e5 * part(4) + e6 * part(5) + e7 * part(6));
    };
    double largest = 0.0;
    for (std::size_t i = 0; i < values_; ++i) {
      const double error = combined([&](std::size_t s) { return internal::value_of(stage(s)[i]); });
      largest = std::max(largest, std::abs(error) / scale[i]);
    }
    largest /= control.tolerance;
    if constexpr (!std::is_same_v<Scalar, double>) {
      for (int j = 0; j < Scalar::DIMENSION; ++j) {
        double size = 0.0, error = 0.0;
        for (std::size_t i = 0; i < values_; ++i) {
          const auto part = [&](std::size_t s) { return stage(s)[i].v(j); };
          size = std::max({size, std::abs(stage(kEnd)[i].v(j)) / scale[i], h_ * std::abs(part(0)) / scale[i],
                           h_ * std::abs(part(6)) / scale[i]});
          error = std::max(error, std::abs(combined(part)) / scale[i]);
        }
        if (size > 0.0)
          largest =
              std::max(largest, error / (control.derivative_tolerance * std::max(size, control.least_derivative)));
      }
    } else if (tangents_ > 0) {
      largest = std::max(largest, tangent_error(scale, control.least_derivative) / control.derivative_tolerance);
    }
    return largest;
  }

  /// Largest error of a tangent over the largest part of its column, both in units of the scales.
  double tangent_error(std::span<const double> scale, double least) requires std::is_same_v<Scalar, double> {
    constexpr double e1 = 71.0 / 57600.0, e3 = -71.0 / 16695.0, e4 = 71.0 / 1920.0, e5 = -17253.0 / 339200.0,
                     e6 = 22.0 / 525.0, e7 = -1.0 / 40.0;
    double* const size = column_.data();
    double* const error = size + tangents_;
    std::fill(column_.begin(), column_.end(), 0.0);
    for (std::size_t i = 0; i < values_; ++i) {
      const std::size_t row = values_ + i * tangents_;
      const double *k1 = stage(0) + row, *k3 = stage(2) + row, *k4 = stage(3) + row, *k5 = stage(4) + row,
                   *k6 = stage(5) + row, *k7 = stage(6) + row, *end = stage(kEnd) + row;
      const double unit = 1.0 / scale[i], step = h_ * unit;
      for (std::size_t j = 0; j < tangents_; ++j) {
        const double e = std::abs(step * (e1 * k1[j] + e3 * k3[j] + e4 * k4[j] + e5 * k5[j] + e6 * k6[j] + e7 * k7[j]));
        double s = unit * std::abs(end[j]);
        const double s1 = step * std::abs(k1[j]), s7 = step * std::abs(k7[j]);
        s = s > s1 ? s : s1;
        s = s > s7 ? s : s7;
        size[j] = size[j] > s ? size[j] : s;
        error[j] = error[j] > e ? error[j] : e;
      }
    }
    double largest = 0.0;
    for (std::size_t j = 0; j < tangents_; ++j) {
      if (size[j] > 0.0) largest = std::max(largest, error[j] / std::max(size[j], least));
    }
    return largest;
  }

  std::size_t values_, tangents_;
  std::size_t n_;               ///< values and their tangents
  std::vector<Scalar> work_;    ///< stages k1 to k7, the end of the step, a scratch state
  std::vector<double> column_;  ///< by tangent: size, then error
  double begin_ = 0.0;
  double h_ = 0.0;
  StepSizes sizes_{0.2, 0.04};  ///< Hairer's constants for this method
};

}  // namespace veridyn::numerics
