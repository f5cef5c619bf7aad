#include "veridyn/camera/tracking/silhouette.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
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

SilhouetteOptions SilhouetteOptions::read(const StudyTable& table) {
  SilhouetteOptions o;
  o.contrast = table.positive_or("contrast", "1", o.contrast);
  o.learning_frames = table.positive_or("learning_frames", "1", o.learning_frames);
  o.length = table.positive_or("length", "m", o.length);
  o.width = table.positive_or("width", "m", o.width);
  o.middle = {table.number_or("middle_x", "m", 0.0), table.number_or("middle_y", "m", 0.0)};
  return o;
}

SilhouetteFinder::SilhouetteFinder(const SilhouetteOptions& options) : options_(options) { options_.validate(); }

double SilhouetteFinder::brightness(const GreyView& image) {
  ratios_.clear();
  constexpr int kEvery = 16;
  for (int y = 0; y < height_; y += kEvery) {
    for (int x = 0; x < width_; x += kEvery) {
      const float ground = background_[at(y) * at(width_) + at(x)];
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
  return std::abs(image.row(y)[x] - gain_ * background_[at(y) * at(width_) + at(x)]);
}

void SilhouetteFinder::compare(const GreyView& image) {
  gain_ = brightness(image);
  const auto gain = static_cast<float>(gain_), limit = static_cast<float>(options_.contrast);
  std::fill(cells_.begin(), cells_.end(), std::uint8_t{0});
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row = image.row(y);
    const float* ground = &background_[at(y) * at(width_)];
    std::uint8_t* mask = &mask_[at(y) * at(width_)];
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
    float* ground = &background_[at(y) * at(width_)];
    const std::uint8_t* cells = &cells_[at(y / kCell) * at(across_)];
    for (int x = 0; x < width_; ++x)
      if (cells[x / kCell] == 0) ground[x] += share * (static_cast<float>(row[x]) - ground[x]);
  }
}

std::span<const PoseMeasurement> SilhouetteFinder::find(const GreyView& image, const Calibration& calibration) {
  poses_.clear();
  if (background_.empty()) {
    width_ = image.width;
    height_ = image.height;
    across_ = (width_ + kCell - 1) / kCell;
    down_ = (height_ + kCell - 1) / kCell;
    mask_.resize(at(width_) * at(height_));
    cells_.resize(at(across_) * at(down_));
    part_.resize(cells_.size());
    for (int y = 0; y < height_; ++y) background_.insert(background_.end(), image.row(y), image.row(y) + width_);
    return poses_;
  }
  if (image.width != width_ || image.height != height_)
    throw InputError("frame",
                     fmt::format("is {} x {} px, the first was {} x {}", image.width, image.height, width_, height_));
  compare(image);
  // Parts of neighbouring cells of which at least half of the pixels are not the background.
  std::fill(part_.begin(), part_.end(), -1);
  struct Part {
    int cells = 0, pixels = 0;
  };
  std::vector<Part> parts;
  constexpr int kHalf = kCell * kCell / 2;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (part_[i] >= 0 || cells_[i] < kHalf) continue;
    const int number = static_cast<int>(parts.size());
    parts.emplace_back();
    stack_.assign(1, static_cast<int>(i));
    part_[i] = number;
    while (!stack_.empty()) {
      const int cell = stack_.back(), cx = cell % across_, cy = cell / across_;
      stack_.pop_back();
      ++parts.back().cells;
      parts.back().pixels += cells_[at(cell)];
      for (int y = std::max(0, cy - 1); y <= std::min(down_ - 1, cy + 1); ++y) {
        for (int x = std::max(0, cx - 1); x <= std::min(across_ - 1, cx + 1); ++x) {
          const int other = y * across_ + x;
          if (part_[at(other)] >= 0 || cells_[at(other)] < kHalf) continue;
          part_[at(other)] = number;
          stack_.push_back(other);
        }
      }
    }
  }
  learn(image);
  const auto largest =
      std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.pixels < b.pixels; });
  if (largest == parts.end()) return poses_;
  const int number = static_cast<int>(largest - parts.begin());

  // Pixels of the part and of the cells around it.
  const auto belongs = [&](int cx, int cy) {
    for (int y = std::max(0, cy - 1); y <= std::min(down_ - 1, cy + 1); ++y)
      for (int x = std::max(0, cx - 1); x <= std::min(across_ - 1, cx + 1); ++x)
        if (part_[at(y * across_ + x)] == number) return true;
    return false;
  };
  // The height of the difference inside: a mean over the pixels that the contrast lets in, weak edges among them, is a
  // little low; the weight of the inside is cut at 1.
  double inside = 0.0, count = 0.0;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (part_[at(y / kCell * across_ + x / kCell)] != number || mask_[at(y) * at(width_) + at(x)] == 0) continue;
      inside += difference(image, x, y);
      count += 1.0;
    }
  }
  inside /= count;
  // Half of the noise of a full pixel lies above 1 and is cut off: the level is a little below the mean, for all alike.
  const double level = 0.9 * inside;
  double area = 0.0, pixel = 0.0;  // [m^2]
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  std::vector<Eigen::Vector2d> edge;
  constexpr double kNothing = 0.1, kFull = 0.9;
  for (int cy = 0; cy < down_; ++cy) {
    for (int cx = 0; cx < across_; ++cx) {
      if (!belongs(cx, cy)) continue;
      if (cx == 0 || cy == 0 || cx + 1 == across_ || cy + 1 == down_) return poses_;  // cut off by the picture
      for (int y = cy * kCell; y < (cy + 1) * kCell; ++y) {
        for (int x = cx * kCell; x < (cx + 1) * kCell; ++x) {
          const double weight = std::min(1.0, difference(image, x, y) / level);
          if (weight < kNothing) continue;
          const auto p = calibration.camera.to_track({x, y});
          if (!p) return poses_;
          // The scale changes over the car, so that its middle in the image is not that on the track.
          const double covered = weight / std::abs(calibration.camera.J_image_track(*p).determinant());
          area += covered;
          pixel = covered / weight;
          mean += covered * *p;
          square += covered * *p * p->transpose();
          if (weight < kFull) edge.push_back(*p);
        }
      }
    }
  }
  if (!(area > 0.0)) return poses_;
  mean /= area;
  if (!(std::abs(area / (options_.length * options_.width) - 1.0) < options_.area_tolerance)) return poses_;
  const Eigen::Matrix2d moments = square / area - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(moments);
  const double minor = axes.eigenvalues()(0), major = axes.eigenvalues()(1);
  if (!(major > 1.2 * minor)) return poses_;
  const Eigen::Vector2d along = axes.eigenvectors().col(1), across(-along(1), along(0));
  // A pixel of area a at offset d, in or out, moves the middle by a d / A and turns the long axis by
  // a (d . along)(d . across) / (A (major - minor)).
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector2d& e : edge) {
    const Eigen::Vector2d d = e - mean;
    const Eigen::Vector3d effect(d(0), d(1), d.dot(along) * d.dot(across) / (major - minor));
    P += kEdgeVariance * pixel * pixel / (area * area) * effect * effect.transpose();
  }
  for (const double turn : {0.0, kPi}) {
    PoseMeasurement m;
    const double heading = numerics::wrap_angle(std::atan2(along(1), along(0)) + turn);
    const double c = std::cos(heading), s = std::sin(heading);
    const Eigen::Vector2d arm(c * options_.middle(0) - s * options_.middle(1),
                              s * options_.middle(0) + c * options_.middle(1));
    m.pose << mean - arm, heading;
    Eigen::Matrix3d J_pose = Eigen::Matrix3d::Identity();
    J_pose(0, 2) = arm(1);
    J_pose(1, 2) = -arm(0);
    m.noise = J_pose * P * J_pose.transpose();
    m.map.topLeftCorner<2, 2>() =
        calibration.track_covariance(mean, Eigen::Matrix2d::Zero()) + calibration.systematic_covariance(mean);
    poses_.push_back(m);
  }
  return poses_;
}

}  // namespace veridyn::camera
