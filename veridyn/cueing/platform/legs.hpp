#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/cueing/platform/platform_limits.hpp"
#include "veridyn/cueing/platform/platform_state.hpp"

namespace veridyn::cueing {

/// The actuators between the floor and a platform: as many as the platform has axes that move, so that lengths and
/// pose follow from each other. Places are forward, right, down [m]: of the feet from where the platform's centre of
/// rotation is in the neutral position, of the heads from that centre.
struct LegGeometry {
  std::vector<Eigen::Vector3d> feet, heads;
  AxisLimits leg;  ///< of each, against its neutral length [m]
};

/// Three upright actuators at the corners of a triangle, of a platform that is guided along surge, sway and yaw.
[[nodiscard]] LegGeometry three_legs();
/// Six legs between two hexagons of unequal sides (Gough 1957; Stewart 1965, Proc Inst Mech Eng 180:371).
[[nodiscard]] LegGeometry six_legs();

/// Lengths of the legs from the platform's pose and back.
class Legs {
 public:
  static constexpr Eigen::Index kMaxLegs = 6;
  using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLegs, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLegs, kMaxLegs>;

  /// How long the legs are against neutral, and how that changes [m, s].
  struct Lengths {
    Values position, rate, acceleration;
  };

  /// @throws InputError where there are not as many legs as axes that move, two ends fall together, the legs do not
  /// hold the neutral pose (they could not tell it from its neighbours), or the platform's range along one axis alone
  /// needs a leg that is longer or shorter than it can be: "platform.roll".
  Legs(const LegGeometry& geometry, const PlatformLimits& limits);

  [[nodiscard]] Eigen::Index count() const { return signed_index(geometry_.feet.size()); }
  [[nodiscard]] const LegGeometry& geometry() const { return geometry_; }
  [[nodiscard]] Lengths lengths(const PlatformState& state) const;
  /// The pose with these lengths that is nearest to another one, and its motion; nothing where there is none.
  [[nodiscard]] std::optional<PlatformState> state(const Lengths& lengths, const PlatformState& near) const;

 private:
  [[nodiscard]] Values positions(const PlatformCommand& pose) const;
  /// Derivatives of the lengths along the axes that move: legs x axes.
  [[nodiscard]] Square jacobian(const PlatformCommand& pose) const;
  void check_range(const PlatformLimits& limits) const;

  LegGeometry geometry_;
  std::vector<PlatformAxis> axes_;
  std::vector<double> neutral_;
};

}  // namespace veridyn::cueing
