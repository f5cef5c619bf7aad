#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// What a centred filter does within half a kernel of the ends of a signal or of a gap.
enum class Edges {
  /// Extends by odd reflection, 2 x_end - x, which keeps value and slope; there the output follows the noise of the end
  /// sample, so it is less smooth than elsewhere.
  kReflect,
  kNan  ///< leaves out what the full kernel does not cover
};

/// Pass and stop band of a low-pass filter. Flat to `attenuation_dB` up to `pass_Hz`, down by it from `stop_Hz` on.
struct LowPassDesign {
  double rate_Hz = 100.0;
  double pass_Hz = 10.0;
  double stop_Hz = 15.0;
  double attenuation_dB = 60.0;  ///< 60 dB: ripple of 0.1 % in the pass band, which is below any sensor's scale error

  /// @throws InputError unless 0 < pass < stop <= rate/2 and 20 <= attenuation <= 120.
  void validate() const;
};

/// A centred finite impulse response: y_k = sum_{j=-m}^{m} taps[m + j] x_{k+j}. Zero phase by construction: the linear
/// phase of the causal filter is compensated exactly, nothing is filtered twice.
struct FirKernel {
  std::vector<double> taps;  ///< 2 m + 1
  double rate_Hz = 1.0;

  [[nodiscard]] std::size_t half_width() const { return taps.size() / 2; }
  /// Variance of the output over the variance of white input: sum taps^2 (1/s^2 for a differentiator).
  [[nodiscard]] double noise_gain() const;
  /// Autocovariance of the output at `lag` samples over the variance of white input.
  [[nodiscard]] double noise_autocovariance(std::size_t lag) const;
  /// Gain at a frequency [Hz]: real part of the response for a symmetric kernel (smoother), imaginary part for an
  /// antisymmetric one (differentiator, 2 pi f ideally).
  [[nodiscard]] double gain(double frequency_Hz) const;
};

/// Low-pass by the window method: sinc cut off half way between pass and stop band times a Kaiser window (Oppenheim &
/// Schafer, Discrete-Time Signal Processing, sec. 7.5.3), scaled to unit gain at 0 Hz.
/// @throws InputError when the design is not valid.
[[nodiscard]] FirKernel low_pass(const LowPassDesign& design);

/// d/dt of what `low_pass(design)` gives, with the same pass band: the taps of the low-pass convolved with the ideal
/// differentiator (-1)^n/n, cut to 1.5 times the low-pass's half width, and corrected to the exact slope at 0 Hz. Its
/// gain is 2 pi f times that of the low-pass to about 0.02 % (10 and 15 of 100 Hz, 60 dB). A regressor smoothed by one
/// and a regressand differentiated by the other have gone through the same filter.
[[nodiscard]] FirKernel low_pass_differentiator(const LowPassDesign& design);

/// Filters every stretch between NaNs on its own; stretches shorter than half a kernel + 1 (kReflect) or a kernel
/// (kNan) become NaN, as NaNs stay. `out` may not overlap `x`. Neither throws nor allocates beyond one padded copy of a
/// stretch.
void filter(std::span<const double> x, const FirKernel& kernel, std::span<double> out, Edges edges = Edges::kReflect);
/// The same into a new vector.
[[nodiscard]] std::vector<double> filter(std::span<const double> x, const FirKernel& kernel,
                                         Edges edges = Edges::kReflect);

/// Savitzky & Golay (1964): the derivative-th derivative at each sample of the least-squares polynomial of degree
/// `order` through 2 `half_width` + 1 samples. At the ends the polynomial of the first or last full window is evaluated
/// off centre.
class SavitzkyGolay {
 public:
  /// @throws InputError unless derivative <= order <= 2 half_width and rate > 0.
  SavitzkyGolay(int order, int half_width, int derivative = 0, double rate_Hz = 1.0);

  /// Stretches between NaNs are filtered separately; shorter than a window they become NaN.
  void apply(std::span<const double> x, std::span<double> out) const;
  [[nodiscard]] std::vector<double> apply(std::span<const double> x) const;
  /// The centred kernel, for its gain and noise gain.
  [[nodiscard]] FirKernel kernel() const;

 private:
  Eigen::MatrixXd taps_;  // column j: the kernel evaluated at sample j of the window
  double rate_Hz_ = 1.0;
};

/// Stretches [first, second) of finite samples.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> finite_stretches(std::span<const double> x);

}  // namespace veridyn::numerics
