#pragma once

#include <filesystem>
#include <vector>

#include "veridyn/io/tables/table.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// A measured profile of the two wheel tracks over the distance, straight between its points and level beyond its ends.
/// The track depends on the sign of the offset (0: the mean of both).
class ProfileRoad final : public Road {
 public:
  /// `distance` increases; all have the same size, at least 2, and are finite.
  /// @throws InputError naming the row (from 0) of a point for which that does not hold.
  ProfileRoad(std::vector<double> distance, std::vector<double> left, std::vector<double> right);
  [[nodiscard]] double height(const RoadPoint& point) const override;

 private:
  std::vector<double> distance_, left_, right_;
  double per_metre_ = 0.0;  ///< points, where they are equally spaced; else 0
};

/// From a table with the columns `distance[m]`, and `left[m]` and `right[m]` or `height[m]` for both.
/// @throws InputError naming file and column.
[[nodiscard]] ProfileRoad profile_road(const io::Table& table);
/// The same from a CSV file. @throws InputError as `profile_road`, and when it cannot be read.
[[nodiscard]] ProfileRoad read_profile_road(const std::filesystem::path& path);

}  // namespace veridyn::vehicle
