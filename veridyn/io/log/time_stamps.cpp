#include "veridyn/io/log/time_stamps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "veridyn/core/index.hpp"
#include "veridyn/core/rank.hpp"

namespace veridyn::io {
namespace {

double median_step(const std::vector<double>& stamps) {
  if (stamps.size() < 2) return 0.0;
  std::vector<double> steps(stamps.size() - 1);
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) steps[i] = std::abs(stamps[i + 1] - stamps[i]);
  return upper_median(steps);
}

// Rows whose stamps are not finite are taken out before.
std::vector<bool> find_spikes(const std::vector<double>& stamps) {
  constexpr std::size_t kHalf = 4;
  const std::size_t count = stamps.size();
  std::vector<bool> spike(count, false);
  if (count < 3) return spike;
  const double limit = std::max(1.0, 20.0 * median_step(stamps));
  std::array<double, 2 * kHalf + 1> window{};
  for (std::size_t i = 0; i < count; ++i) {
    // Towards the ends the window narrows so that it stays centred; the last row is compared with its neighbours.
    const std::size_t half = std::min({kHalf, i, count - 1 - i});
    const std::size_t reach = half == 0 ? std::min<std::size_t>(2, count - 1) : half;
    const std::size_t begin = i >= reach ? i - reach : 0;
    const std::size_t end = std::min(count, i + reach + 1);
    bool in_order = true;
    for (std::size_t k = begin; k + 1 < end; ++k) in_order = in_order && stamps[k] <= stamps[k + 1];
    if (in_order) continue;
    std::copy(stamps.begin() + signed_index(begin), stamps.begin() + signed_index(end), window.begin());
    const double middle = upper_median(std::span(window).first(end - begin));
    spike[i] = std::abs(stamps[i] - middle) > limit;
  }
  return spike;
}

}  // namespace

OrderedStamps order_stamps(std::vector<double> stamps) {
  OrderedStamps result;
  bool good = true;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    // Written so that NaN is not good.
    good = good && stamps[i] > -INFINITY && stamps[i] < INFINITY && (i == 0 || stamps[i] >= stamps[i - 1]);
    result.doubled += (i > 0 && stamps[i] == stamps[i - 1]) ? 1U : 0U;
  }
  if (good) {
    result.time = std::move(stamps);
    return result;
  }
  std::vector<std::uint64_t> row;
  std::vector<double> kept;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!std::isfinite(stamps[i])) continue;
    row.push_back(i);
    kept.push_back(stamps[i]);
  }
  const std::vector<bool> spike = find_spikes(kept);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!spike[i]) result.row.push_back(row[i]);
  }
  result.spikes = stamps.size() - result.row.size();
  double latest = -INFINITY;
  for (const std::uint64_t i : result.row) {
    if (stamps[i] < latest) ++result.reordered;
    latest = std::max(latest, stamps[i]);
  }
  if (result.reordered > 0) {
    std::stable_sort(result.row.begin(), result.row.end(),
                     [&](std::uint64_t a, std::uint64_t b) { return stamps[a] < stamps[b]; });
  }
  result.doubled = 0;
  result.time.reserve(result.row.size());
  for (const std::uint64_t i : result.row) {
    if (!result.time.empty() && result.time.back() == stamps[i]) ++result.doubled;
    result.time.push_back(stamps[i]);
  }
  return result;
}

}  // namespace veridyn::io
