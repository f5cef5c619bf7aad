#pragma once

#include <memory>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/road/iso8608_road.hpp"
#include "veridyn/vehicle/road/road_surface.hpp"

namespace veridyn::vehicle {

/// What a circuit is made of. The default is one for a 1:5 car after the track of the reproduced rig: ramps of 7 and 30
/// deg, small bumps, curves banked by edges of 1, 1.8 and 2.8 cm on 20 cm (2.9, 5.1, 8 deg), asphalt and a rough part.
/// Roughness is that of ISO 8608 at one fifth of the size (1/125 of class A and F).
struct CircuitOptions {
  /// Up, level, and down again.
  struct Ramp {
    double at = 0.0;      ///< distance along the circuit where it begins [m]
    double angle = 0.0;   ///< of its even part, up and down [rad]
    double height = 0.0;  ///< of its top [m]
    double top = 1.0;     ///< length of the top [m]
    double blend = 0.8;   ///< distance over which the slope grows and falls [m]

    /// Of the whole, from level to level, as the map has it [m].
    [[nodiscard]] double length() const;
    /// Of the part of even slope [m].
    [[nodiscard]] double even() const;
  };
  /// A hump across the track.
  struct Bump {
    double at = 0.0, height = 0.0, length = 0.0;  ///< across the whole width, a whole cosine [m]
  };
  /// A stretch of another surface.
  struct Rough {
    double at = 0.0, length = 0.0;  ///< [m]
    double roughness = 0.0;         ///< G_d(0.1 cycle/m), see `Iso8608Options` [m^3]
  };
  double straight = 12.0;                                                            ///< [m]
  double radius = 3.0;                                                               ///< of the curves [m]
  double width = 1.2;                                                                ///< [m]
  std::vector<double> banks{0.0, 2.9 * kDegree, 5.1 * kDegree, 8.0 * kDegree};       ///< of quarter curves
  std::vector<Ramp> ramps{{1.5, 7.0 * kDegree, 0.15}, {22.5, 30.0 * kDegree, 0.6}};  ///< on straights
  std::vector<Bump> bumps{{7.5, 0.005, 0.2}, {8.5, 0.005, 0.2}, {9.5, 0.005, 0.2}};  ///< on straights
  std::vector<Rough> rough{{12.0, 9.4, 16e-6 / 125}, {28.5, 3.5, 16384e-6 / 125}};   ///< anywhere
  std::uint64_t seed = 1;

  /// @throws InputError naming the number
  void validate() const;
};

/// A closed road of two straights and two half circles to the left, from the origin along x. Straights are level
/// across, curves banked about their middle line, outer edge up. Slopes change as 6 t^5 - 15 t^4 + 10 t^3, so that
/// curvature is continuous. Beyond its width the road goes down (or up) to the level plane within as much again.
class Circuit final : public RoadSurface {
 public:
  /// @throws InputError as the options
  explicit Circuit(const CircuitOptions& options = {});

  [[nodiscard]] Point at(const Eigen::Vector2d& place) const override;
  [[nodiscard]] double relief(const Eigen::Vector2d& place) const override;

  /// Where a place is on it.
  struct Located {
    double distance = 0.0;       ///< along the middle line, 0 to `length()` [m]
    double offset = 0.0;         ///< to the left of it [m]
    double stretch = 1.0;        ///< metres along the map here by those of the middle line
    Eigen::Vector2d along = {};  ///< direction of the middle line
    bool straight = true;
  };
  [[nodiscard]] Located locate(const Eigen::Vector2d& place) const;
  /// The middle line on the map; distances beyond the length go round.
  [[nodiscard]] Eigen::Vector2d middle(double distance) const;
  /// Of a lap on the map [m].
  [[nodiscard]] double length() const { return lap_; }
  [[nodiscard]] const CircuitOptions& options() const { return options_; }

 private:
  struct Profile {
    double value = 0.0, slope = 0.0;
  };
  [[nodiscard]] Profile climb(double distance) const;
  [[nodiscard]] Profile bank(double distance) const;
  /// Share of it that is left at an offset.
  [[nodiscard]] Profile across(double offset) const;

  CircuitOptions options_;
  double curve_, lap_;
  std::vector<Iso8608Road> rough_;
};

/// From a table, each key of which may be left out:
///
///     straight = "12 m", radius = "3 m", width = "1.2 m"
///     banks = ["0 deg", "2.9 deg", "5.1 deg", "8 deg"]   # of the four quarters of the curves
///     [[...ramp]]                                        # at = 1.5, angle = "7 deg", height = "15 cm", top = 1,
///                                                        # blend = 0.8; none: those of `CircuitOptions`
///     [[...bump]]                                        # at = 7.5, height = "5 mm", length = "0.2 m"
///     [[...rough]]                                       # at = 28.5, length = 3.5, class = "F" or roughness = 1e-4
///     flat = false                                       # true: no ramps, bumps and roughness but those given
///
/// @throws InputError with file, line and key
[[nodiscard]] std::shared_ptr<const Circuit> read_circuit(const StudyTable& circuit, std::uint64_t seed);

}  // namespace veridyn::vehicle
