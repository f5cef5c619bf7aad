#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// x with P(X <= x) = p for a standard normal X; 0 < p < 1. Check: normal_quantile(0.975) = 1.959963984540054.
[[nodiscard]] double normal_quantile(double p);

/// normal_quantile(0.975): half of a 95 % interval [standard deviations].
inline constexpr double kNormal95 = 1.959963984540054;

/// P(X <= x) for a standard normal X.
[[nodiscard]] double normal_cdf(double x);

/// Quantile of Student's t with `dof` > 0 degrees of freedom (not necessarily whole); normal above 1e7.
/// Check: student_t_quantile(0.975, 10) = 2.228138851986.
[[nodiscard]] double student_t_quantile(double p, double dof);

/// P(|T| > |t|) of Student's t.
[[nodiscard]] double student_t_two_sided_p(double t, double dof);

/// Quantile of chi-square with `dof` > 0 degrees of freedom. Check: chi_square_quantile(0.95, 6) = 12.591587243744.
[[nodiscard]] double chi_square_quantile(double p, double dof);

/// P(X > x) of chi-square.
[[nodiscard]] double chi_square_upper_p(double x, double dof);

/// Samples against the normal quantiles where they would lie on a straight line if they were normal.
struct NormalPlot {
  std::vector<double> quantile;  ///< standard normal quantile of (i - 3/8)/(N + 1/4), Blom (1958)
  std::vector<double> sample;    ///< the samples in ascending order
  double mean = 0.0;             ///< of all samples: the line's value at quantile 0
  double sd = 0.0;               ///< of all samples: the line's slope
  double correlation = 0.0;      ///< between the two columns: near 1 when normal
};

/// Normal probability plot of the finite values of `x`, thinned evenly in rank to at most `max_points` (0: all).
[[nodiscard]] NormalPlot normal_probability_plot(std::span<const double> x, std::size_t max_points = 0);

/// Sample autocorrelation r(0)=1, r(1), ..., r(max_lag) about the mean (biased: divided by N, so |r| <= 1), with the
/// band
/// +-1.96/sqrt(N) that white noise leaves at 5 % of the lags.
struct Autocorrelation {
  std::vector<double> value;
  double white_bound95 = 0.0;
  std::size_t count = 0;
};

/// Products are formed only between samples of the same segment (`segment` empty: all are one segment; equal ids must
/// be contiguous). Values must be finite.
[[nodiscard]] Autocorrelation autocorrelation(std::span<const double> x, std::size_t max_lag,
                                              std::span<const int> segment = {});

/// Is a residual white? Ljung & Box (1978): Q = N(N+2) sum r(k)^2/(N-k), chi-square with `lags` degrees of freedom.
struct WhitenessTest {
  double ljung_box = 0.0;
  std::size_t lags = 0;
  double p_value = 1.0;
  /// sum (e_k - e_{k-1})^2 / sum e_k^2: 2 when white, towards 0 when positively autocorrelated.
  double durbin_watson = 2.0;
  double lag1 = 0.0;              ///< r(1)
  double fraction_outside = 0.0;  ///< of r(1..lags) outside the 95 % band of white noise
  [[nodiscard]] bool white(double significance = 0.05) const { return p_value >= significance; }
};

/// @param lags 0 chooses min(10 log10 N, N/5), at least 1. Residuals of any real flight are autocorrelated; the test
/// only says so.
[[nodiscard]] WhitenessTest whiteness_test(std::span<const double> residual, std::size_t lags = 0,
                                           std::span<const int> segment = {});

/// Number of independent samples with as much information about the variance: N / (1 + 2 sum r(k)^2), summed until r
/// stays inside the white band.
[[nodiscard]] double effective_sample_size_variance(std::span<const double> x, std::span<const int> segment = {});

/// How far a model's output is from the measurement. Pairs with a NaN on either side are left out.
struct FitMeasures {
  double mae = 0.0;   ///< mean |error|, in the unit of the data
  double rmse = 0.0;  ///< sqrt(mean error^2)
  double bias = 0.0;  ///< mean (model - measured)
  double r2 =
      0.0;  ///< 1 - sum error^2 / sum (measured - its mean)^2; negative when worse than the mean; NaN when constant
  /// Theil's inequality coefficient U1 = rmse / (rms measured + rms model), in [0, 1]: 0 is a perfect fit, 1 is no
  /// better than opposite signs; below about 0.3 counts as good agreement (Jategaonkar, Flight Vehicle System
  /// Identification).
  double theil = 0.0;
  std::size_t count = 0;
};

/// @throws InputError when the sizes differ.
[[nodiscard]] FitMeasures fit_measures(std::span<const double> measured, std::span<const double> model);

/// The value below which `share` (0 to 1) of values lie that are sorted and not empty; on a line between neighbours
/// (Hyndman & Fan 1996, Am Stat 50:361, definition 7).
[[nodiscard]] double quantile_of_sorted(std::span<const double> sorted, double share);
/// Root of the mean square of the finite values (0 when there are none).
[[nodiscard]] double rms(std::span<const double> x);
/// Median of the finite values (NaN when there are none).
[[nodiscard]] double median(std::span<const double> x);
/// 1.4826 median |x - median|: the standard deviation of normal data, whatever a minority of outliers does.
[[nodiscard]] double robust_sd(std::span<const double> x);

}  // namespace veridyn::numerics
