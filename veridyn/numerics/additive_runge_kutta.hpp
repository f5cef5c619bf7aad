#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/numerics/step_control.hpp"

namespace veridyn::numerics {

/// The fourth-order method ARK4(3)6L[2]SA of Kennedy & Carpenter (2003) for systems in which some components are stiff,
/// each only in itself: those are stepped implicitly (L-stable, stiffly accurate), the others explicitly, with the
/// same stages. Error estimate of third order, PI step control, cubic Hermite interpolation between steps.
///
/// The derivative solves its own implicit stages: `f(t, step, Scalar* x, Scalar* rate)` with `step` 0 writes x' at x;
/// with `step` > 0 the stiff components of x hold their base on entry and on return the solution of
/// x_i = base_i + step x_i'(t, x), to which `rate` belongs. It returns false where there is none: the step is then
/// tried again at a quarter of its size. `tangents` numbers for each value follow the values, those of the first value
/// first; tangents of a stiff value are stiff.
class AdditiveRungeKutta {
 public:
  /// `stiff[i]`: whether component i is stepped implicitly.
  explicit AdditiveRungeKutta(std::vector<char> stiff, std::size_t tangents = 0)
      : stiff_(std::move(stiff)),
        tangents_(tangents),
        n_(stiff_.size() * (1 + tangents)),
        work_(kArrays * n_),
        column_(2 * tangents) {}

  /// The derivative jumps here: forget the derivative at the end of the last step.
  void restart(bool keep_step = false) { sizes_.restart(keep_step); }

  /// As `DormandPrince::advance`.
  template <typename F, typename OnStep>
  IntegrationEnd advance(F&& f, double& t, double* x, double end, std::span<const double> scale,
                         const StepControl& control, OnStep&& on_step) {
    VERIDYN_ASSERT(scale.size() == stiff_.size() && end >= t);
    return sizes_.advance(
        t, end, control, [&] { return f(t, 0.0, x, stage(0)) && finite(stage(0)); },
        [&](double interval) { return first_step(x, stage(0), scale, control.tolerance, 0.25, interval); },
        [&](double h) { return try_step(f, t, x, h); }, [&] { return error_of(scale, control); },
        [&](double reached) {
          begin_ = t;
          std::copy(x, x + n_, stage(kStart));
          const bool go_on = on_step(t, reached);
          std::copy(stage(kEnd), stage(kEnd) + n_, x);
          std::copy(stage(kEndRate), stage(kEndRate) + n_, stage(0));
          t = reached;
          return go_on;
        });
  }

  /// The state at `time` within the step that `on_step` was told of; call it there only. Third order.
  void interpolate(double time, double* out) const {
    const double s = (time - begin_) / h_, r = 1.0 - s;
    const double *start = stage(kStart), *end = stage(kEnd), *first = stage(0), *last = stage(kEndRate);
    for (std::size_t i = 0; i < n_; ++i) {
      const double difference = end[i] - start[i];
      out[i] = start[i] + s * (difference + r * ((h_ * first[i] - difference) * r + (difference - h_ * last[i]) * s));
    }
  }

  /// Accepted and rejected steps so far.
  [[nodiscard]] long steps() const { return sizes_.steps(); }

 private:
  static constexpr std::size_t kStages = 6, kEnd = 6, kEndRate = 7, kScratch = 8, kArrays = 9;
  static constexpr std::size_t kStart = kScratch;  ///< between steps, when nothing else is in it
  static constexpr double kGamma = 0.25;
  static constexpr std::array<double, kStages> kTime{0.0, 0.5, 83.0 / 250.0, 31.0 / 50.0, 17.0 / 20.0, 1.0};
  using Table = std::array<std::array<double, kStages>, kStages>;
  static constexpr Table kExplicit{
      {{},
       {0.5},
       {13861.0 / 62500.0, 6889.0 / 62500.0},
       {-116923316275.0 / 2393684061468.0, -2731218467317.0 / 15368042101831.0, 9408046702089.0 / 11113171139209.0},
       {-451086348788.0 / 2902428689909.0, -2682348792572.0 / 7519795681897.0, 12662868775082.0 / 11960479115383.0,
        3355817975965.0 / 11060851509271.0},
       {647845179188.0 / 3216320057751.0, 73281519250.0 / 8382639484533.0, 552539513391.0 / 3454668386233.0,
        3354512671639.0 / 8306763924573.0, 4040.0 / 17871.0}}};
  static constexpr Table kImplicit{
      {{},
       {0.25},
       {8611.0 / 62500.0, -1743.0 / 31250.0},
       {5012029.0 / 34652500.0, -654441.0 / 2922500.0, 174375.0 / 388108.0},
       {15267082809.0 / 155376265600.0, -71443401.0 / 120774400.0, 730878875.0 / 902184768.0, 2285395.0 / 8070912.0},
       {82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0}}};
  static constexpr std::array<double, kStages> kWeight{82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0,
                                                       -2260.0 / 8211.0,   0.25};
  static constexpr std::array<double, kStages> kEmbedded{4586570599.0 / 29645900160.0, 0.0,
                                                         178811875.0 / 945068544.0,    814220225.0 / 1159782912.0,
                                                         -3700637.0 / 11593932.0,      61727.0 / 225920.0};

  [[nodiscard]] double* stage(std::size_t i) { return work_.data() + i * n_; }
  [[nodiscard]] const double* stage(std::size_t i) const { return work_.data() + i * n_; }

  bool finite(const double* x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < n_; ++i) sum += x[i] * 0.0;
    return sum == 0.0;
  }

  /// y = x + h sum of the first `count` stages, by the table of each component.
  void combine(const double* x, double h, const std::array<double, kStages>& of_explicit,
               const std::array<double, kStages>& of_implicit, std::size_t count, double* y) const {
    const std::size_t values = stiff_.size();
    const auto rows = [&](std::size_t from, std::size_t size, const std::array<double, kStages>& weight) {
      for (std::size_t i = from; i < from + size; ++i) y[i] = x[i];
      for (std::size_t j = 0; j < count; ++j) {
        const double w = h * weight[j];
        if (w == 0.0) continue;
        const double* const k = stage(j);
        for (std::size_t i = from; i < from + size; ++i) y[i] += w * k[i];
      }
    };
    for (std::size_t i = 0; i < values; ++i) {
      const auto& weight = stiff_[i] != 0 ? of_implicit : of_explicit;
      rows(i, 1, weight);
      if (tangents_ > 0) rows(values + i * tangents_, tangents_, weight);
    }
  }

  template <typename F>
  bool try_step(F& f, double t, const double* x, double h) {
    double* const y = stage(kScratch);
    for (std::size_t s = 1; s < kStages; ++s) {
      combine(x, h, kExplicit[s], kImplicit[s], s, y);
      if (!f(t + kTime[s] * h, kGamma * h, y, stage(s))) return false;
    }
    combine(x, h, kWeight, kWeight, kStages, stage(kEnd));
    h_ = h;
    // The derivative at the end is the first stage of the next step, and the slope that the interpolant needs.
    return finite(stage(kEnd)) && f(t + h, 0.0, stage(kEnd), stage(kEndRate)) && finite(stage(kEndRate));
  }

  double error_of(std::span<const double> scale, const StepControl& control) {
    std::array<double, kStages> e{};
    for (std::size_t s = 0; s < kStages; ++s) e[s] = kWeight[s] - kEmbedded[s];
    const auto combined = [&](std::size_t i) {
      double sum = 0.0;
      for (std::size_t s = 0; s < kStages; ++s) sum += e[s] * stage(s)[i];
      return std::abs(h_ * sum);
    };
    double largest = 0.0;
    const std::size_t values = stiff_.size();
    for (std::size_t i = 0; i < values; ++i) largest = std::max(largest, combined(i) / scale[i]);
    largest /= control.tolerance;
    if (tangents_ == 0) return largest;
    double* const size = column_.data();
    double* const error = size + tangents_;
    std::fill(column_.begin(), column_.end(), 0.0);
    for (std::size_t i = 0; i < values; ++i) {
      const double unit = 1.0 / scale[i];
      const std::size_t row = values + i * tangents_;
      for (std::size_t j = 0; j < tangents_; ++j) {
        size[j] = std::max({size[j], unit * std::abs(stage(kEnd)[row + j]), unit * h_ * std::abs(stage(0)[row + j])});
        error[j] = std::max(error[j], unit * combined(row + j));
      }
    }
    double worst = 0.0;
    for (std::size_t j = 0; j < tangents_; ++j)
      if (size[j] > 0.0) worst = std::max(worst, error[j] / std::max(size[j], control.least_derivative));
    return std::max(largest, worst / control.derivative_tolerance);
  }

  std::vector<char> stiff_;
  std::size_t tangents_, n_;
  std::vector<double> work_;
  std::vector<double> column_;
  double begin_ = 0.0, h_ = 0.0;
  StepSizes sizes_{0.25, 0.06};
};

}  // namespace veridyn::numerics
