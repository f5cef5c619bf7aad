#pragma once

namespace veridyn::vehicle {

/// Where a tyre touches the road, in both ways a road may be described.
struct RoadPoint {
  double x = 0.0, y = 0.0;  ///< earth axes [m]
  double distance =
      0.0;  ///< along the path of the vehicle: of its centre of gravity, plus the wheel's distance ahead of it [m]
  double offset = 0.0;  ///< of the wheel to the left of the vehicle's middle [m]
};

/// The height of the road [m] above the plane on which the vehicle stands at the start. Called four times per
/// derivative: implementations do not allocate, and are safe to share between threads.
class Road {
 public:
  virtual ~Road() = default;
  /// [m], up.
  [[nodiscard]] virtual double height(const RoadPoint& point) const = 0;
};

}  // namespace veridyn::vehicle
