#include "veridyn/camera/tracking/silhouette.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera {

void SilhouetteOptions::validate() const {
  if (!(contrast >= 1.0 && contrast <= 255.0)) throw InputError("silhouette", "contrast must be 1 to 255 grey levels");
  if (!(learning_frames >= 2.0)) throw InputError("silhouette", "learning_frames must be at least 2");
  if (!(width > 0.0 && length > 1.2 * width && std::isfinite(length)))
    throw InputError("silhouette", "the car must be at least 1.2 times as long as wide for its heading to be seen");
  if (!(area_tolerance > 0.0 && area_tolerance < 1.0)) throw InputError("silhouette", "area_tolerance must be 0 to 1");
  if (!middle.allFinite()) throw InputError("silhouette", "the middle must be finite");
}

const KeyTable<SilhouetteOptions>& SilhouetteOptions::keys() {
  using O = SilhouetteOptions;
  const auto coordinate = [](Eigen::Index i) { return [i](O& o) -> double& { return o.middle(i); }; };
  static const auto table =
      KeyTable<O>("silhouette", "How a car without markers is distinguished from the track under it.")
          .number("contrast", &O::contrast, "1", from_to(1.0, 255.0),
                  "least difference to the background [grey levels]")
          .number("learning_frames", &O::learning_frames, "1", {.low = 2.0},
                  "over which the background is averaged; it follows the light of the room")
          .number("length", &O::length, "m", kPositive, "of the car seen from above, at least 1.2 times its width")
          .number("width", &O::width, "m", kPositive, "of the car seen from above")
          .number("middle_x", coordinate(0), "m", kAnyNumber,
                  "of the silhouette's middle, forward of the car's reference point")
          .number("middle_y", coordinate(1), "m", kAnyNumber, "left of it");
  return table;
}

SilhouetteFinder::SilhouetteFinder(const SilhouetteOptions& options) : options_(options) { options_.validate(); }

double SilhouetteFinder::brightness(const GreyView& image) {
  ratios_.clear();
  constexpr int kEvery = 16;
  for (int y = 0; y < height_; y += kEvery) {
    for (int x = 0; x < width_; x += kEvery) {
      const float ground = background_[y * width_ + x];
      if (ground > 4.0F) ratios_.push_back(static_cast<float>(image.row(y)[x]) / ground);
    }
  }
  if (ratios_.size() < 16) return 1.0;
  // A trimmed mean: the ratio of single dark pixels is coarse, and what moves is few of them.
  std::sort(ratios_.begin(), ratios_.end());
  const std::size_t cut = ratios_.size() / 5;
  double sum = 0.0;
  for (std::size_t i = cut; i < ratios_.size() - cut; ++i) sum += ratios_[i];
  return sum / static_cast<double>(ratios_.size() - 2 * cut);
}

double SilhouetteFinder::difference(const GreyView& image, int x, int y) const {
  return std::abs(image.row(y)[x] - gain_ * background_[y * width_ + x]);
}

void SilhouetteFinder::compare(const GreyView& image) {
  gain_ = brightness(image);
  const auto gain = static_cast<float>(gain_), limit = static_cast<float>(options_.contrast);
  std::fill(cells_.begin(), cells_.end(), std::uint8_t{0});
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = image.row(y);
    const float* ground = &background_[y * width_];
    std::uint8_t* mask = &mask_[y * width_];
    for (int x = 0; x < width_; ++x)
      mask[x] = std::abs(static_cast<float>(row[x]) - gain * ground[x]) > limit ? std::uint8_t{1} : std::uint8_t{0};
    std::uint8_t* cells = &cells_[at(y / kCell) * at(across_)];
    for (int c = 0; c < across_; ++c) {
      const int last = std::min(width_, (c + 1) * kCell);
      for (int x = c * kCell; x < last; ++x) cells[c] = static_cast<std::uint8_t>(cells[c] + mask[x]);
    }
  }
}

void SilhouetteFinder::learn(const GreyView& image) {
  const auto share = static_cast<float>(1.0 / options_.learning_frames);
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = image.row(y);
    float* ground = &background_[y * width_];
    const std::uint8_t* cells = &cells_[at(y / kCell) * at(across_)];
    for (int x = 0; x < width_; ++x)
      if (cells[x / kCell] == 0) ground[x] += share * (static_cast<float>(row[x]) - ground[x]);
  }
}

void SilhouetteFinder::begin(const GreyView& image) {
  width_ = image.width;
  height_ = image.height;
  across_ = (width_ + kCell - 1) / kCell;
  down_ = (height_ + kCell - 1) / kCell;
  mask_.resize(at(width_) * at(height_));
  cells_.resize(at(across_) * at(down_));
  part_.resize(cells_.size());
  for (int y = 0; y < height_; ++y) background_.insert(background_.end(), image.row(y), image.row(y) + width_);
}

template <typename Use>
void SilhouetteFinder::for_each_cell_around(int cx, int cy, Use use) const {
  for (int y = std::max(0, cy - 1); y <= std::min(down_ - 1, cy + 1); ++y) {
    for (int x = std::max(0, cx - 1); x <= std::min(across_ - 1, cx + 1); ++x) use(y * across_ + x);
  }
}

std::optional<int> SilhouetteFinder::largest_part() {
  std::fill(part_.begin(), part_.end(), -1);
  constexpr int kHalf = kCell * kCell / 2;
  std::optional<int> largest;
  int number = 0, most = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (part_[i] >= 0 || cells_[i] < kHalf) continue;
    stack_.assign(1, static_cast<int>(i));
    part_[i] = number;
    int pixels = 0;
    while (!stack_.empty()) {
      const int cell = stack_.back();
      stack_.pop_back();
      pixels += cells_[cell];
      for_each_cell_around(cell % across_, cell / across_, [&](int other) {
        if (part_[other] >= 0 || cells_[other] < kHalf) return;
        part_[other] = number;
        stack_.push_back(other);
      });
    }
    if (pixels > most) {
      most = pixels;
      largest = number;
    }
    ++number;
  }
  return largest;
}

double SilhouetteFinder::inside_difference(const GreyView& image, int part) const {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (part_[y / kCell * across_ + x / kCell] != part || mask_[y * width_ + x] == 0) continue;
      sum += difference(image, x, y);
      count += 1.0;
    }
  }
  return sum / count;
}

std::optional<SilhouetteFinder::Shape> SilhouetteFinder::shape(const GreyView& image, const Calibration& calibration,
                                                               int part) const {
  // The height of the difference inside: a mean over the pixels that the contrast lets in, weak edges among them, is a
  // little low; half of the noise of a full pixel lies above 1 and is cut off: the level is a little below the mean,
  // for all alike.
  const double level = 0.9 * inside_difference(image, part);
  Shape shape;
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  constexpr double kNothing = 0.1, kFull = 0.9;
  for (int cell = 0; cell < across_ * down_; ++cell) {
    const int cx = cell % across_, cy = cell / across_;
    bool belongs = false;
    for_each_cell_around(cx, cy, [&](int other) { belongs = belongs || part_[other] == part; });
    if (!belongs) continue;
    if (cx == 0 || cy == 0 || cx + 1 == across_ || cy + 1 == down_) return std::nullopt;  // cut off by the picture
    for (int pixel = 0; pixel < kCell * kCell; ++pixel) {
      const int x = cx * kCell + pixel % kCell, y = cy * kCell + pixel / kCell;
      const double weight = std::min(1.0, difference(image, x, y) / level);
      if (weight < kNothing) continue;
      const auto p = calibration.camera.to_track({x, y});
      if (!p) return std::nullopt;
      // The scale changes over the car, so that its middle in the image is not that on the track.
      const double covered = weight / std::abs(calibration.camera.J_image_track(*p).determinant());
      shape.area += covered;
      shape.pixel = covered / weight;
      shape.mean += covered * *p;
      square += covered * *p * p->transpose();
      if (weight < kFull) shape.edge.push_back(*p);
    }
  }
  if (!(shape.area > 0.0)) return std::nullopt;
  shape.mean /= shape.area;
  shape.moments = square / shape.area - shape.mean * shape.mean.transpose();
  return shape;
}

std::span<const PoseMeasurement> SilhouetteFinder::find(const GreyView& image, const Calibration& calibration) {
  poses_.clear();
  if (background_.empty()) {
    begin(image);
    return poses_;
  }
  if (image.width != width_ || image.height != height_)
    throw InputError("frame",
                     fmt::format("is {} x {} px, the first was {} x {}", image.width, image.height, width_, height_));
  compare(image);
  const std::optional<int> part = largest_part();
  learn(image);
  const std::optional<Shape> found = part ? shape(image, calibration, *part) : std::nullopt;
  if (!found) return poses_;
  if (!(std::abs(found->area / (options_.length * options_.width) - 1.0) < options_.area_tolerance)) return poses_;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(found->moments);
  const double minor = axes.eigenvalues()(0), major = axes.eigenvalues()(1);
  if (!(major > 1.2 * minor)) return poses_;
  const Eigen::Vector2d along = axes.eigenvectors().col(1), across(-along(1), along(0));
  // A pixel of area a at offset d, in or out, moves the middle by a d / A and turns the long axis by
  // a (d . along)(d . across) / (A (major - minor)).
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector2d& e : found->edge) {
    const Eigen::Vector2d d = e - found->mean;
    const Eigen::Vector3d effect(d(0), d(1), d.dot(along) * d.dot(across) / (major - minor));
    P += kEdgeVariance * found->pixel * found->pixel / (found->area * found->area) * effect * effect.transpose();
  }
  for (const double turn : {0.0, kPi}) {
    PoseMeasurement m;
    const double heading = numerics::wrap_angle(std::atan2(along(1), along(0)) + turn);
    const double c = std::cos(heading), s = std::sin(heading);
    const Eigen::Vector2d arm(c * options_.middle(0) - s * options_.middle(1),
                              s * options_.middle(0) + c * options_.middle(1));
    m.pose << found->mean - arm, heading;
    Eigen::Matrix3d J_pose = Eigen::Matrix3d::Identity();
    J_pose(0, 2) = arm(1);
    J_pose(1, 2) = -arm(0);
    m.noise = J_pose * P * J_pose.transpose();
    m.map.topLeftCorner<2, 2>() = calibration.track_covariance(found->mean, Eigen::Matrix2d::Zero()) +
                                  calibration.systematic_covariance(found->mean);
    poses_.push_back(m);
  }
  return poses_;
}

}  // namespace veridyn::camera
