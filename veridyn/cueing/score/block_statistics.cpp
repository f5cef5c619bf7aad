#include "veridyn/cueing/score/block_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::cueing {

BlockStatistics::BlockStatistics(std::span<const double> x, std::span<const double> y, double step, double noticed)
    : step_(step) {
  const auto n = static_cast<std::ptrdiff_t>(std::min(x.size(), y.size()));
  const auto block = std::max<std::ptrdiff_t>(1, std::lround(kBlock / step));
  const auto first = static_cast<std::ptrdiff_t>(std::lround(kFirstLag / step)),
             last = static_cast<std::ptrdiff_t>(std::lround(kLastLag / step));
  // A remainder of less than half a block goes with the last one.
  blocks_ = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, (n + block / 2) / block));
  lags_ = static_cast<std::size_t>(last - first + 1);
  no_lag_ = static_cast<std::size_t>(-first);
  sums_.resize(blocks_ * lags_);
  squares_.resize(blocks_);
  above_.resize(blocks_);
  samples_.resize(blocks_);
  for (std::size_t b = 0; b < blocks_; ++b) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(b) * block, to = b + 1 == blocks_ ? n : from + block;
    for (std::ptrdiff_t k = from; k < to; ++k) {
      const double off = y[k] - x[k];
      squares_[b] += off * off;
      above_[b] += std::abs(off) > noticed ? 1.0 : 0.0;
      samples_[b] += 1.0;
    }
    for (std::size_t l = 0; l < lags_; ++l) {
      const std::ptrdiff_t lag = first + static_cast<std::ptrdiff_t>(l);
      Sums s;
      for (std::ptrdiff_t k = std::max(from, lag), end = std::min(to, n + lag); k < end; ++k) {
        const double u = x[k - lag], v = y[k];
        s.n += 1.0;
        s.x += u;
        s.y += v;
        s.xx += u * u;
        s.yy += v * v;
        s.xy += u * v;
      }
      sums_[b * lags_ + l] = s;
    }
  }
}

double BlockStatistics::correlation(const Sums& s) {
  const double xx = s.xx - s.x * s.x / s.n, yy = s.yy - s.y * s.y / s.n, xy = s.xy - s.x * s.y / s.n;
  // What is left of constant signals is rounding.
  constexpr double kRounding = 1e-12;
  return xx > kRounding * s.xx && yy > kRounding * s.yy && xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : kNaN;
}

BlockStatistics::Figures BlockStatistics::figures() const { return figures(std::vector<double>(blocks_, 1.0)); }

BlockStatistics::Figures BlockStatistics::figures(std::span<const double> weights) const {
  if (blocks_ == 0) return {.rmse = kNaN, .pearson = kNaN, .lag = kNaN, .at_lag = kNaN, .above = kNaN};
  double squares = 0.0, above = 0.0, samples = 0.0;
  for (std::size_t b = 0; b < blocks_; ++b) {
    squares += weights[b] * squares_[b];
    above += weights[b] * above_[b];
    samples += weights[b] * samples_[b];
  }
  std::vector<double> by_lag(lags_);
  for (std::size_t l = 0; l < lags_; ++l) {
    Sums s;
    for (std::size_t b = 0; b < blocks_; ++b) {
      const Sums& of = sums_[b * lags_ + l];
      const double w = weights[b];
      s.n += w * of.n;
      s.x += w * of.x;
      s.y += w * of.y;
      s.xx += w * of.xx;
      s.yy += w * of.yy;
      s.xy += w * of.xy;
    }
    by_lag[l] = correlation(s);
  }
  Figures f{.rmse = std::sqrt(squares / samples), .pearson = by_lag[no_lag_], .above = above / samples};
  if (!std::isfinite(f.pearson)) {
    f.lag = f.at_lag = kNaN;
    return f;
  }
  const auto best = static_cast<std::size_t>(std::max_element(by_lag.begin(), by_lag.end()) - by_lag.begin());
  f.at_lag = by_lag[best];
  double between = 0.0;  // the top of the parabola through the best and its neighbours
  if (best > 0 && best + 1 < lags_) {
    const double bend = by_lag[best - 1] - 2.0 * by_lag[best] + by_lag[best + 1];
    if (bend < 0.0) between = 0.5 * (by_lag[best - 1] - by_lag[best + 1]) / bend;
  }
  f.lag = (static_cast<double>(best) - static_cast<double>(no_lag_) + between) * step_;
  return f;
}

std::vector<Measured> bootstrapped(std::size_t blocks, std::uint64_t seed, std::size_t count,
                                   const std::function<void(std::span<const double>, std::span<double>)>& figures) {
  std::vector<double> weights(blocks, 1.0), of_draw(count);
  figures(weights, of_draw);
  std::vector<Measured> all;
  for (const double value : of_draw) all.push_back({value, kNaN, kNaN});
  if (blocks < BlockStatistics::kFewestBlocks) return all;
  constexpr std::size_t kDraws = 400;
  std::mt19937_64 random(seed);
  std::vector<std::vector<double>> drawn(count);
  for (std::size_t k = 0; k < kDraws; ++k) {
    std::fill(weights.begin(), weights.end(), 0.0);
    for (std::size_t b = 0; b < blocks; ++b) weights[random() % blocks] += 1.0;
    figures(weights, of_draw);
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isfinite(of_draw[i])) drawn[i].push_back(of_draw[i]);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (drawn[i].size() < kDraws / 2) continue;
    std::sort(drawn[i].begin(), drawn[i].end());
    all[i].low = numerics::quantile_of_sorted(drawn[i], 0.025);
    all[i].high = numerics::quantile_of_sorted(drawn[i], 0.975);
  }
  return all;
}

}  // namespace veridyn::cueing
