#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/camera/tracking/grey_image.hpp"
#include "veridyn/camera/tracking/marker_pose.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::camera {

/// How a car without markers is distinguished from the track under it.
struct SilhouetteOptions {
  double contrast = 25.0;        ///< least difference to the background [grey levels]
  double learning_frames = 200;  ///< over which the background is averaged; it follows the light of the room
  double length = 0.30;          ///< of the car seen from above [m]
  double width = 0.15;           ///< [m]
  /// Largest difference of the silhouette's area from length x width, as a share: more is hidden or is no car.
  double area_tolerance = 0.25;
  /// Forward and left of the car's reference point to the middle of its silhouette [m].
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();

  /// @throws InputError("silhouette", ...) for values that make no sense
  void validate() const;
  [[nodiscard]] static const KeyTable<SilhouetteOptions>& keys();
};

/// The part of a picture that is not the background. Keeps a running mean of each pixel, to which what belongs to a
/// silhouette is not added, scaled in each picture by the ratio of their brightness (a lamp that flickers). The first
/// picture is the background: the track should be empty, or the car drive on.
///
/// The silhouette is the largest connected part whose area is that of the car. Its middle is the mean place of its
/// pixels, each weighted with its difference over that of the silhouette's inside (at most 1), so that a pixel half
/// covered counts half; its heading is the long principal axis, which leaves two headings. An edge pixel's weight is
/// off by the noise and by what a blurred edge makes of it, with a variance of `kEdgeVariance`: the covariance of the
/// middle is the sum over edge pixels of kEdgeVariance (p - c)(p - c)' / A^2, and that of the axis the same of their
/// torque. A silhouette whose edge is changed by a shadow or by ground of the car's own grey is off by more than that
/// says.
class SilhouetteFinder {
 public:
  SilhouetteFinder() = default;
  /// @throws InputError as `SilhouetteOptions::validate`
  explicit SilhouetteFinder(const SilhouetteOptions& options);

  /// The two poses, half a turn apart, that the silhouette in a picture may have; none where there is no car alone.
  /// Valid until the next call. The markers counted are 0.
  /// @throws InputError("frame", ...) where the size is not that of the first picture
  std::span<const PoseMeasurement> find(const GreyView& image, const Calibration& calibration);

  static constexpr double kEdgeVariance = 0.02;

 private:
  /// The part of a picture that may be the car, on the track.
  struct Shape {
    double area = 0.0, pixel = 0.0;  ///< of all, and of one of its pixels [m^2]
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();  ///< second, about the mean [m^2]
    std::vector<Eigen::Vector2d> edge;                  ///< places of its pixels that are not full
  };
  void begin(const GreyView& image);
  void compare(const GreyView& image);
  void learn(const GreyView& image);
  [[nodiscard]] double brightness(const GreyView& image);
  /// Numbers the parts of neighbouring cells of which at least half of the pixels are not the background.
  /// @return number of the one with most pixels; nothing where there is none
  std::optional<int> largest_part();
  /// Mean difference of a part's pixels.
  [[nodiscard]] double inside_difference(const GreyView& image, int part) const;
  /// Nothing where the picture cuts it off, or a pixel is not on the track.
  [[nodiscard]] std::optional<Shape> shape(const GreyView& image, const Calibration& calibration, int part) const;
  template <typename Use>
  void for_each_cell_around(int cx, int cy, Use use) const;
  /// Difference of a pixel from the background.
  [[nodiscard]] double difference(const GreyView& image, int x, int y) const;

  static constexpr int kCell = 4;  ///< the picture is searched in cells of 4 x 4 px
  SilhouetteOptions options_;
  double gain_ = 1.0;
  int width_ = 0, height_ = 0, across_ = 0, down_ = 0;
  std::vector<float> background_;
  std::vector<std::uint8_t> mask_;   ///< pixels that are not the background
  std::vector<std::uint8_t> cells_;  ///< pixels of each cell that are not
  std::vector<int> part_;            ///< number of the connected part of each cell; -1: none
  std::vector<int> stack_;
  std::vector<float> ratios_;
  std::vector<PoseMeasurement> poses_;
};

}  // namespace veridyn::camera
