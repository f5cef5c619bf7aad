#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// A level road.
class FlatRoad final : public Road {
 public:
  [[nodiscard]] double height(const RoadPoint& /*point*/) const override { return 0.0; }
};

/// A level road with one obstacle across it.
struct Obstacle {
  /// Profile along the road.
  enum class Shape {
    kStep,  ///< rises over `length` by half a cosine, at once where that is 0, and stays
    kRamp,  ///< rises linearly over `length`, and stays
    kBump,  ///< a whole cosine, (1 - cos)/2, of that length
    kPlank  ///< rises at once, falls at once after `length`
  };
  enum class Side { kBoth, kLeft, kRight };
  Shape shape = Shape::kStep;
  double at = 10.0;     ///< distance at which it begins [m]
  double height = 0.0;  ///< may be negative: a hole [m]
  double length = 0.0;  ///< >= 0; > 0 of all but steps [m]
  Side side = Side::kBoth;
};

/// The height depends on the distance travelled and on the side of the vehicle (offset >= 0: left), not on where on the
/// plane it is. A point contact: a real tyre, or `length` of its contact patch, smooths sharp edges.
class ObstacleRoad final : public Road {
 public:
  explicit ObstacleRoad(const Obstacle& obstacle) : obstacle_(obstacle) {}

  [[nodiscard]] double height(const RoadPoint& point) const override {
    const bool left = point.offset >= 0.0;
    if (obstacle_.side == Obstacle::Side::kLeft && !left) return 0.0;
    if (obstacle_.side == Obstacle::Side::kRight && left) return 0.0;
    const double ahead = point.distance - obstacle_.at;
    if (!(ahead >= 0.0)) return 0.0;
    const bool over = ahead >= obstacle_.length;
    const double share = over ? 1.0 : ahead / obstacle_.length;
    switch (obstacle_.shape) {
      case Obstacle::Shape::kStep:
        return over ? obstacle_.height : 0.5 * obstacle_.height * (1.0 - std::cos(kPi * share));
      case Obstacle::Shape::kRamp:
        return obstacle_.height * share;
      case Obstacle::Shape::kBump:
        return over ? 0.0 : 0.5 * obstacle_.height * (1.0 - std::cos(2.0 * kPi * share));
      case Obstacle::Shape::kPlank:
        return over ? 0.0 : obstacle_.height;
    }
    return 0.0;
  }

 private:
  Obstacle obstacle_;
};

}  // namespace veridyn::vehicle
