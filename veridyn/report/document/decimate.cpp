#include "veridyn/report/document/decimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {

namespace {

struct Bucket {
  std::size_t begin;
  std::size_t end;
};

Bucket bucket(std::size_t k, std::size_t buckets, std::size_t samples) {
  return {k * samples / buckets, (k + 1) * samples / buckets};
}

/// View of a line that it appends points to; of a run of gaps one is left, and none before the first value.
class Pen {
 public:
  explicit Pen(Polyline& line) : line_(line) {}

  void point(double x, double y) {
    line_.x.push_back(x);
    line_.y.push_back(y);
  }

  void gap(double x) {
    if (!line_.y.empty() && std::isfinite(line_.y.back())) point(x, kNaN);
  }

 private:
  Polyline& line_;
};

/// Smallest and largest value of each piece without gaps within a bucket, in order.
void draw_bucket(std::span<const double> x, std::span<const double> y, Bucket range, Pen& pen) {
  for (std::size_t k = range.begin; k < range.end;) {
    if (!std::isfinite(y[k])) {
      pen.gap(x[k]);
      ++k;
      continue;
    }
    std::size_t low = k;
    std::size_t high = k;
    for (; k < range.end && std::isfinite(y[k]); ++k) {
      if (y[k] < y[low]) low = k;
      if (y[k] > y[high]) high = k;
    }
    pen.point(x[std::min(low, high)], y[std::min(low, high)]);
    if (low != high) pen.point(x[std::max(low, high)], y[std::max(low, high)]);
  }
}

struct Range {
  double low = kInfinity;
  double high = -kInfinity;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] std::size_t cell(double value, std::size_t cells) const {
    if (!(high > low)) return 0;
    const double share = (value - low) / (high - low);
    return std::min(cells - 1, static_cast<std::size_t>(share * static_cast<double>(cells)));
  }
};

}  // namespace

Polyline decimate_line(std::span<const double> x, std::span<const double> y, std::size_t limit) {
  VERIDYN_ASSERT(x.size() == y.size() && limit >= 8);
  Polyline line;
  if (y.size() <= limit) {
    line.x.assign(x.begin(), x.end());
    line.y.assign(y.begin(), y.end());
    return line;
  }
  Pen pen(line);
  const std::size_t buckets = (limit - 2) / 2;
  const std::size_t last = y.size() - 1;
  for (std::size_t k = 0; k < buckets; ++k) {
    const Bucket range = bucket(k, buckets, y.size());
    if (k == 0 && std::isfinite(y[0])) pen.point(x[0], y[0]);
    draw_bucket(x, y, range, pen);
    // The first sample of all is often its bucket's extreme too.
    if (k == 0 && line.x.size() > 1 && line.x[0] == line.x[1]) {
      line.x.erase(line.x.begin());
      line.y.erase(line.y.begin());
    }
  }
  if (std::isfinite(y[last]) && line.x.back() != x[last]) pen.point(x[last], y[last]);
  return line;
}

DecimatedBand decimate_band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                            std::size_t limit) {
  VERIDYN_ASSERT(x.size() == low.size() && x.size() == high.size() && limit >= 8);
  DecimatedBand band;
  const auto add = [&band](double at, double from, double to) {
    band.x.push_back(at);
    band.low.push_back(from);
    band.high.push_back(to);
  };
  if (x.size() <= limit) {
    for (std::size_t k = 0; k < x.size(); ++k) add(x[k], low[k], high[k]);
    return band;
  }
  const std::size_t buckets = limit - 2;
  for (std::size_t k = 0; k < buckets; ++k) {
    const Bucket range = bucket(k, buckets, x.size());
    Range envelope;
    bool gap = false;
    for (std::size_t j = range.begin; j < range.end; ++j) {
      if (std::isfinite(low[j]) && std::isfinite(high[j])) {
        envelope.add(low[j]);
        envelope.add(high[j]);
      } else {
        gap = true;
      }
    }
    if (gap || !(envelope.low <= envelope.high)) {
      if (!band.low.empty() && std::isfinite(band.low.back())) add(x[range.begin], kNaN, kNaN);
      continue;
    }
    if (k == 0) add(x.front(), envelope.low, envelope.high);
    add(0.5 * (x[range.begin] + x[range.end - 1]), envelope.low, envelope.high);
    if (k + 1 == buckets) add(x.back(), envelope.low, envelope.high);
  }
  return band;
}

Polyline thin_scatter(std::span<const double> x, std::span<const double> y, std::size_t limit) {
  VERIDYN_ASSERT(x.size() == y.size() && limit >= 8);
  Range x_range;
  Range y_range;
  std::vector<std::size_t> points;
  // Leftmost, rightmost, lowest, highest.
  std::array<std::size_t, 4> extreme{};
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    if (points.empty()) extreme.fill(k);
    if (x[k] < x[extreme[0]]) extreme[0] = k;
    if (x[k] > x[extreme[1]]) extreme[1] = k;
    if (y[k] < y[extreme[2]]) extreme[2] = k;
    if (y[k] > y[extreme[3]]) extreme[3] = k;
    x_range.add(x[k]);
    y_range.add(y[k]);
    points.push_back(k);
  }
  const std::size_t most = points.size();
  for (std::size_t cells = 512; most > limit && cells >= 2; cells = cells * 3 / 4) {
    std::vector<std::uint8_t> taken(cells * cells, 0);
    std::vector<std::size_t> left;
    for (const std::size_t k : points) {
      std::uint8_t& cell = taken[x_range.cell(x[k], cells) * cells + y_range.cell(y[k], cells)];
      const bool keep = cell == 0 || std::find(extreme.begin(), extreme.end(), k) != extreme.end();
      cell = 1;
      if (keep) left.push_back(k);
    }
    points = std::move(left);
    if (points.size() <= limit) break;
  }
  Polyline line;
  for (const std::size_t k : points) {
    line.x.push_back(x[k]);
    line.y.push_back(y[k]);
  }
  return line;
}

}  // namespace veridyn::report
