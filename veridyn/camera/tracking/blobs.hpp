#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "veridyn/camera/tracking/grey_image.hpp"

namespace veridyn::camera {

/// What counts as a bright spot.
struct BlobOptions {
  double contrast = 30.0;       ///< least height of its peak above the picture's median [grey levels]
  double noise_factor = 8.0;    ///< the same in standard deviations of the picture's noise, whichever is more
  int least_pixels = 3;         ///< above the threshold
  int largest_extent = 60;      ///< along x or y [px]: what is larger is no marker; a blurred one is a streak
  int margin = 3;               ///< around the pixels above the threshold, into which its light reaches [px]
  std::size_t most_blobs = 64;  ///< the brightest are kept

  /// @throws InputError("blobs", ...) for values that make no sense
  void validate() const;
};

/// A bright spot.
struct Blob {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of its light above the background [px]
  /// Of the centre [px^2], from the noise of the pixels, and 0.03 px that no picture is without.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double light = 0.0;  ///< sum of grey levels above the background
  int peak = 0;        ///< highest grey level
  /// Whether the light of another spot or the edge of the picture is in its window: then the centre is biased by what
  /// the covariance does not know.
  bool disturbed = false;
};

/// Finds bright spots. Keeps its memory between pictures, so that it does not allocate once it has seen the largest.
///
/// Neighbouring pixels above a threshold are one spot (8 neighbours). Its centre is the mean place of the light in the
/// window around it, weighted with the height w above a level at a quarter of the spot's own: below lie painted lines,
/// edges of the car, the foot of other lights. The level is low enough on the flank of a spot that some pixels of light
/// are cut off evenly all around. With white noise of sigma in the pixels that count, the covariance is
///     sigma^2 sum (p - c)(p - c)' / (sum w)^2 .
/// What else moves the centre (light from below, noise that grows with the light) is in the misfit of the markers, by
/// which CarTracker scales it. Motion during the exposure makes a streak that is symmetric about the place in the
/// middle of the exposure, to which the centre therefore belongs.
class BlobFinder {
 public:
  BlobFinder() = default;
  /// @throws InputError as `BlobOptions::validate`
  explicit BlobFinder(const BlobOptions& options);

  /// Spots of a picture, brightest first; valid until the next call.
  std::span<const Blob> find(const GreyView& image);
  /// Of the last picture: standard deviation of a pixel's noise and median [grey levels].
  [[nodiscard]] double noise() const noexcept { return noise_; }
  [[nodiscard]] double median() const noexcept { return median_; }

 private:
  /// Pixels above the threshold next to each other in a row.
  struct Run {
    int y, first, last;  ///< last inclusive
    int label;
  };
  struct Box {
    int x0, x1, y0, y1;  ///< inclusive
    int pixels, peak;
  };

  void measure_levels(const GreyView& image);
  void find_runs(const GreyView& image, int threshold);
  void find_boxes(const GreyView& image);
  [[nodiscard]] Blob measure(const GreyView& image, const Box& box) const;

  BlobOptions options_;
  std::vector<Run> runs_;
  std::vector<int> parent_;
  std::vector<Box> boxes_;
  std::vector<int> box_of_;
  std::vector<Blob> blobs_;
  double noise_ = 1.0, median_ = 0.0;
};

}  // namespace veridyn::camera
