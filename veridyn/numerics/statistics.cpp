#include "veridyn/numerics/statistics.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::numerics {
namespace {

constexpr double kNormalDof = 1e7;

std::vector<double> finite_values(std::span<const double> x) {
  std::vector<double> kept;
  kept.reserve(x.size());
  for (const double v : x) {
    if (std::isfinite(v)) kept.push_back(v);
  }
  return kept;
}

// Bounds of contiguous equal ids; one segment when there are no ids.
std::vector<std::pair<std::size_t, std::size_t>> segment_bounds(std::size_t count, std::span<const int> segment) {
  std::vector<std::pair<std::size_t, std::size_t>> bounds;
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= count; ++k) {
    if (k == count || (!segment.empty() && segment[k] != segment[k - 1])) {
      bounds.emplace_back(begin, k);
      begin = k;
    }
  }
  return bounds;
}

double lagged_product(const std::vector<double>& x, const std::vector<std::pair<std::size_t, std::size_t>>& bounds,
                      std::size_t lag) {
  double sum = 0.0;
  for (const auto& [begin, end] : bounds) {
    if (begin + lag >= end) continue;
    const auto count = static_cast<Eigen::Index>(end - begin - lag);
    sum += Eigen::Map<const Eigen::VectorXd>(x.data() + begin, count)
               .dot(Eigen::Map<const Eigen::VectorXd>(x.data() + begin + lag, count));
  }
  return sum;
}

std::vector<double> centred(std::span<const double> x) {
  const double middle = mean(x);
  std::vector<double> c(x.begin(), x.end());
  for (double& v : c) v -= middle;
  return c;
}

}  // namespace

double normal_quantile(double p) { return boost::math::quantile(boost::math::normal(), p); }

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

double student_t_quantile(double p, double dof) {
  if (dof > kNormalDof) return normal_quantile(p);
  return boost::math::quantile(boost::math::students_t(dof), p);
}

double student_t_two_sided_p(double t, double dof) {
  if (std::isnan(t)) return kNaN;
  if (std::isinf(t)) return 0.0;
  if (dof > kNormalDof) return std::erfc(std::abs(t) / std::sqrt(2.0));
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(dof), std::abs(t)));
}

double chi_square_quantile(double p, double dof) { return boost::math::quantile(boost::math::chi_squared(dof), p); }

double chi_square_upper_p(double x, double dof) {
  if (!(x > 0.0)) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(dof), x));
}

NormalPlot normal_probability_plot(std::span<const double> x, std::size_t max_points) {
  NormalPlot plot;
  std::vector<double> sorted = finite_values(x);
  if (sorted.empty()) return plot;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const auto count = static_cast<double>(n);
  plot.mean = mean(sorted);
  double sum_ss = 0.0, sum_qq = 0.0, sum_sq = 0.0;
  for (const double v : sorted) sum_ss += (v - plot.mean) * (v - plot.mean);
  plot.sd = n > 1 ? std::sqrt(sum_ss / (count - 1.0)) : 0.0;
  const bool thin = max_points >= 2 && max_points < n;
  const std::size_t points = thin ? max_points : n;
  sum_ss = 0.0;
  for (std::size_t j = 0; j < points; ++j) {
    const std::size_t i = thin ? j * (n - 1) / (points - 1) : j;
    const double q = normal_quantile((static_cast<double>(i) + 0.625) / (count + 0.25));
    const double s = sorted[i] - plot.mean;
    plot.quantile.push_back(q);
    plot.sample.push_back(sorted[i]);
    sum_ss += s * s;
    sum_qq += q * q;
    sum_sq += s * q;
  }
  plot.correlation = sum_ss > 0.0 && sum_qq > 0.0 ? sum_sq / std::sqrt(sum_ss * sum_qq) : 0.0;
  return plot;
}

Autocorrelation autocorrelation(std::span<const double> x, std::size_t max_lag, std::span<const int> segment) {
  Autocorrelation result;
  result.count = x.size();
  if (x.empty()) return result;
  result.white_bound95 = kNormal95 / std::sqrt(static_cast<double>(x.size()));
  const std::vector<double> c = centred(x);
  const auto bounds = segment_bounds(c.size(), segment);
  const double power = lagged_product(c, bounds, 0);
  max_lag = std::min(max_lag, x.size() - 1);
  result.value.reserve(max_lag + 1);
  result.value.push_back(1.0);
  for (std::size_t lag = 1; lag <= max_lag; ++lag) {
    result.value.push_back(power > 0.0 ? lagged_product(c, bounds, lag) / power : 0.0);
  }
  return result;
}

WhitenessTest whiteness_test(std::span<const double> residual, std::size_t lags, std::span<const int> segment) {
  WhitenessTest test;
  const std::size_t n = residual.size();
  if (n < 5) return test;
  const auto count = static_cast<double>(n);
  if (lags == 0) lags = std::min(static_cast<std::size_t>(10.0 * std::log10(count)), n / 5);
  lags = std::clamp<std::size_t>(lags, 1, n - 2);
  const Autocorrelation r = autocorrelation(residual, lags, segment);
  std::size_t outside = 0;
  for (std::size_t k = 1; k <= lags; ++k) {
    test.ljung_box += r.value[k] * r.value[k] / (count - static_cast<double>(k));
    outside += std::abs(r.value[k]) > r.white_bound95 ? 1U : 0U;
  }
  test.ljung_box *= count * (count + 2.0);
  test.lags = lags;
  test.p_value = chi_square_upper_p(test.ljung_box, static_cast<double>(lags));
  test.lag1 = r.value[1];
  test.fraction_outside = static_cast<double>(outside) / static_cast<double>(lags);
  double differences = 0.0, power = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    power += residual[k] * residual[k];
    if (k > 0 && (segment.empty() || segment[k] == segment[k - 1])) {
      const double step = residual[k] - residual[k - 1];
      differences += step * step;
    }
  }
  if (power > 0.0) test.durbin_watson = differences / power;
  return test;
}

double effective_sample_size_variance(std::span<const double> x, std::span<const int> segment) {
  const std::size_t n = x.size();
  if (n < 3) return static_cast<double>(n);
  const std::vector<double> c = centred(x);
  const auto bounds = segment_bounds(n, segment);
  const double power = lagged_product(c, bounds, 0);
  const auto count = static_cast<double>(n);
  if (!(power > 0.0)) return count;
  const double bound = kNormal95 / std::sqrt(count);
  double sum = 0.0;
  std::size_t quiet = 0;
  for (std::size_t lag = 1; lag < std::min<std::size_t>(n / 2, 2000) && quiet < 10; ++lag) {
    const double r = lagged_product(c, bounds, lag) / power;
    quiet = std::abs(r) < bound ? quiet + 1 : 0;
    sum += std::max(0.0, r * r - 1.0 / count);  // 1/N is what white noise leaves
  }
  return std::clamp(count / (1.0 + 2.0 * sum), 1.0, count);
}

FitMeasures fit_measures(std::span<const double> measured, std::span<const double> model) {
  if (measured.size() != model.size()) {
    throw InputError("fit_measures", "measured has " + std::to_string(measured.size()) + " samples, model " +
                                         std::to_string(model.size()) + "; they must have the same number");
  }
  FitMeasures fit;
  double sum = 0.0, measured2 = 0.0, model2 = 0.0, error2 = 0.0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!std::isfinite(measured[k]) || !std::isfinite(model[k])) continue;
    const double error = model[k] - measured[k];
    ++fit.count;
    fit.mae += std::abs(error);
    fit.bias += error;
    error2 += error * error;
    sum += measured[k];
    measured2 += measured[k] * measured[k];
    model2 += model[k] * model[k];
  }
  if (fit.count == 0) {
    const double nan = kNaN;
    return {nan, nan, nan, nan, nan, 0};
  }
  const auto n = static_cast<double>(fit.count);
  fit.mae /= n;
  fit.bias /= n;
  fit.rmse = std::sqrt(error2 / n);
  const double mean = sum / n;
  double spread = 0.0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!std::isfinite(measured[k]) || !std::isfinite(model[k])) continue;
    spread += (measured[k] - mean) * (measured[k] - mean);
  }
  fit.r2 = spread > 0.0 ? 1.0 - error2 / spread : kNaN;
  const double scale = std::sqrt(measured2 / n) + std::sqrt(model2 / n);
  fit.theil = scale > 0.0 ? fit.rmse / scale : 0.0;
  return fit;
}

double quantile_of_sorted(std::span<const double> sorted, double share) {
  VERIDYN_ASSERT(!sorted.empty());
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double rms(std::span<const double> x) {
  Moments moments;
  for (const double v : x)
    if (std::isfinite(v)) moments.add(v);
  return moments.rms();
}

double median(std::span<const double> x) {
  std::vector<double> v = finite_values(x);
  if (v.empty()) return kNaN;
  const double upper = upper_median(v);
  if (v.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(v.begin(), v.begin() + signed_index(v.size() / 2)));
}

double robust_sd(std::span<const double> x) {
  std::vector<double> v = finite_values(x);
  const double centre = median(v);
  for (double& value : v) value = std::abs(value - centre);
  return 1.482602218505602 * median(v);
}

}  // namespace veridyn::numerics
