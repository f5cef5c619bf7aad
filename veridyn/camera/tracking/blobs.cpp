#include "veridyn/camera/tracking/blobs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::camera {
namespace {

constexpr int kBlock = 64;

/// Whether any of `kBlock` pixels reaches the threshold: a loop that vectorises.
bool any_bright(const std::uint8_t* pixels, std::uint8_t threshold) {
  std::uint8_t most = 0;
  for (int i = 0; i < kBlock; ++i) most = std::max(most, pixels[i]);
  return most >= threshold;
}

template <std::size_t N>
double middle_of(const std::array<int, N>& histogram, int count) {
  // The middle of the level's share of the counts, so that levels of noise below one are told from each other.
  int below = 0;
  for (std::size_t level = 0; level < N; ++level) {
    if (2 * (below + histogram[level]) >= count && histogram[level] > 0) {
      const double share = (0.5 * count - below) / histogram[level];
      return static_cast<double>(level) - 0.5 + share;
    }
    below += histogram[level];
  }
  return 0.0;
}

int root_of(std::vector<int>& parent, int label) {
  while (parent[label] != label) {
    parent[label] = parent[parent[label]];
    label = parent[label];
  }
  return label;
}

}  // namespace

void BlobOptions::validate() const {
  if (!(contrast >= 1.0 && contrast <= 255.0)) throw InputError("blobs", "contrast must be 1 to 255 grey levels");
  if (!(noise_factor >= 3.0)) throw InputError("blobs", "noise_factor must be at least 3");
  if (least_pixels < 1) throw InputError("blobs", "least_pixels must be at least 1");
  if (largest_extent < 3) throw InputError("blobs", "largest_extent must be at least 3 px");
  if (margin < 1 || margin > 20) throw InputError("blobs", "margin must be 1 to 20 px");
  if (most_blobs < 2) throw InputError("blobs", "most_blobs must be at least 2");
}

BlobFinder::BlobFinder(const BlobOptions& options) : options_(options) { options_.validate(); }

void BlobFinder::measure_levels(const GreyView& image) {
  // Of every 4th row, pairs of neighbours: their differences know the noise whatever the picture shows.
  std::array<int, 256> levels{}, differences{};
  int count = 0;
  for (int y = 0; y < image.height; y += 4) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x + 1 < image.width; x += 8) {
      ++levels[row[x]];
      ++differences[std::abs(row[x + 1] - row[x])];
      ++count;
    }
  }
  median_ = middle_of(levels, count);
  // |difference| folds at 0, where one level stands for half a level: the root of the mean square of the lower half of
  // a normal distribution is robust and counts rounding right. Of |d| below its 68.27 % quantile, sigma^2 of d is that
  // mean square over 0.2910 (closed form: 1 - 2 phi(1) / 0.6827).
  const int wanted = static_cast<int>(0.6827 * count);
  int taken = 0;
  double squares = 0.0;
  for (std::size_t d = 0; d < differences.size() && taken < wanted; ++d) {
    const int more = std::min(differences[d], wanted - taken);
    squares += static_cast<double>(d * d) * more;
    taken += more;
  }
  constexpr double kShare = 0.29112, kRounding = 1.0 / 12.0;
  const double variance = taken > 0 ? squares / taken / kShare / 2.0 : 1.0;
  noise_ = std::sqrt(std::max(variance, kRounding));
}

void BlobFinder::find_runs(const GreyView& image, int threshold) {
  runs_.clear();
  const auto bright = static_cast<std::uint8_t>(std::clamp(threshold, 1, 255));
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x < image.width;) {
      if (row[x] < bright) {
        if (x % kBlock == 0 && x + kBlock <= image.width && !any_bright(row + x, bright)) {
          x += kBlock;
        } else {
          ++x;
        }
        continue;
      }
      const int first = x;
      while (x < image.width && row[x] >= bright) ++x;
      runs_.push_back({y, first, x - 1, -1});
    }
  }
}

void BlobFinder::find_boxes(const GreyView& image) {
  // Runs that touch those of the row above, corners included, are joined (union-find).
  parent_.resize(runs_.size());
  std::size_t above = 0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    parent_[i] = static_cast<int>(i);
    while (above < i && runs_[above].y < runs_[i].y - 1) ++above;
    for (std::size_t k = above; k < i && runs_[k].y < runs_[i].y; ++k) {
      if (runs_[k].last + 1 >= runs_[i].first && runs_[k].first <= runs_[i].last + 1) {
        const int a = root_of(parent_, static_cast<int>(k)), b = root_of(parent_, static_cast<int>(i));
        parent_[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  boxes_.clear();
  box_of_.assign(runs_.size(), -1);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const Run& run = runs_[i];
    int& index = box_of_[root_of(parent_, static_cast<int>(i))];
    if (index < 0) {
      index = static_cast<int>(boxes_.size());
      boxes_.push_back({run.first, run.last, run.y, run.y, 0, 0});
    }
    Box& box = boxes_[index];
    box.x0 = std::min(box.x0, run.first);
    box.x1 = std::max(box.x1, run.last);
    box.y1 = std::max(box.y1, run.y);
    box.pixels += run.last - run.first + 1;
    const std::uint8_t* row = image.row(run.y);
    for (int x = run.first; x <= run.last; ++x) box.peak = std::max(box.peak, static_cast<int>(row[x]));
  }
}

Blob BlobFinder::measure(const GreyView& image, const Box& box) const {
  const int m = options_.margin;
  Blob blob;
  blob.peak = box.peak;
  blob.disturbed = box.x0 < m + 1 || box.y0 < m + 1 || box.x1 + m + 1 >= image.width || box.y1 + m + 1 >= image.height;
  const int x0 = std::max(0, box.x0 - m), x1 = std::min(image.width - 1, box.x1 + m);
  const int y0 = std::max(0, box.y0 - m), y1 = std::min(image.height - 1, box.y1 + m);
  // The rim: one pixel around the window.
  double rim = 0.0;
  int rim_count = 0;
  const auto take = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
    rim += image.row(y)[x];
    ++rim_count;
  };
  for (int x = x0 - 1; x <= x1 + 1; ++x) {
    take(x, y0 - 1);
    take(x, y1 + 1);
  }
  for (int y = y0; y <= y1; ++y) {
    take(x0 - 1, y);
    take(x1 + 1, y);
  }
  const double background = rim_count > 0 ? rim / rim_count : median_;
  // What is weak beside the spot, a painted line, an edge of the car, stays below the level from which light counts.
  constexpr double kFoot = 0.25, kNoiseFoot = 3.0;
  const double level = background + std::max(kFoot * (box.peak - background), kNoiseFoot * noise_);
  double light = 0.0, sx = 0.0, sy = 0.0, count = 0.0, cx = 0.0, cy = 0.0, cxx = 0.0, cxy = 0.0, cyy = 0.0;
  for (int y = y0; y <= y1; ++y) {
    const std::uint8_t* row = image.row(y);
    for (int x = x0; x <= x1; ++x) {
      const double w = row[x] - level;
      if (!(w > 0.0)) continue;
      const double dx = x - x0, dy = y - y0;
      light += w;
      sx += w * dx;
      sy += w * dy;
      count += 1.0;
      cx += dx;
      cy += dy;
      cxx += dx * dx;
      cxy += dx * dy;
      cyy += dy * dy;
    }
  }
  blob.light = light;
  if (!(light > 0.0)) {
    blob.disturbed = true;
    return blob;
  }
  const double mx = sx / light, my = sy / light;
  blob.centre = {x0 + mx, y0 + my};
  // sum over the pixels that count of (p - c)(p - c)', from their moments
  Eigen::Matrix2d spread;
  spread(0, 0) = cxx - 2.0 * mx * cx + count * mx * mx;
  spread(1, 1) = cyy - 2.0 * my * cy + count * my * my;
  spread(0, 1) = spread(1, 0) = cxy - mx * cy - my * cx + count * mx * my;
  blob.covariance = noise_ * noise_ / (light * light) * spread;
  // Compression, the shapes of pixels and of the lens move a centre by some hundredths of a pixel whatever the noise
  // is; one pixel alone says where it is to a third of itself.
  constexpr double kLeastVariance_px2 = 1e-3;
  blob.covariance.diagonal().array() += count > 1.0 ? kLeastVariance_px2 : 1.0 / 12.0;
  return blob;
}

std::span<const Blob> BlobFinder::find(const GreyView& image) {
  blobs_.clear();
  if (image.width < 2 || image.height < 1) return blobs_;
  measure_levels(image);
  const double height = std::max(options_.contrast, options_.noise_factor * noise_);
  find_runs(image, static_cast<int>(std::ceil(median_ + height)));
  find_boxes(image);
  std::sort(boxes_.begin(), boxes_.end(), [](const Box& a, const Box& b) {
    if (a.peak != b.peak) return a.peak > b.peak;
    if (a.pixels != b.pixels) return a.pixels > b.pixels;
    return a.y0 != b.y0 ? a.y0 < b.y0 : a.x0 < b.x0;
  });
  // What of another spot lies beyond its pixels above the threshold is below the level from which light counts.
  const int reach = options_.margin + 1;
  for (const Box& box : boxes_) {
    if (blobs_.size() == options_.most_blobs) break;
    if (box.pixels < options_.least_pixels) continue;
    if (box.x1 - box.x0 >= options_.largest_extent || box.y1 - box.y0 >= options_.largest_extent) continue;
    Blob blob = measure(image, box);
    for (const Box& other : boxes_) {
      blob.disturbed |= &other != &box && other.x0 - box.x1 <= reach && box.x0 - other.x1 <= reach &&
                        other.y0 - box.y1 <= reach && box.y0 - other.y1 <= reach;
    }
    blobs_.push_back(blob);
  }
  return blobs_;
}

}  // namespace veridyn::camera
