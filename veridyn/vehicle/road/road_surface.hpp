#pragma once

#include <Eigen/Core>

namespace veridyn::vehicle {

/// A road surface of any inclination, over the level plane. It has two parts: the smooth one, on whose tangent plane a
/// vehicle stands, and relief, square to it: bumps and roughness, over which wheels and springs work. Implementations
/// do not allocate, and are safe to share between threads.
class RoadSurface {
 public:
  /// The smooth part at a place; its slope is continuous.
  struct Point {
    double height = 0.0;                              ///< up [m]
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the height along x and y
  };

  virtual ~RoadSurface() = default;
  [[nodiscard]] virtual Point at(const Eigen::Vector2d& place) const = 0;
  /// Relief at a place [m].
  [[nodiscard]] virtual double relief(const Eigen::Vector2d& /*place*/) const { return 0.0; }
};

}  // namespace veridyn::vehicle
