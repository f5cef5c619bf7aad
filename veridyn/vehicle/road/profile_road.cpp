#include "veridyn/vehicle/road/profile_road.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

ProfileRoad::ProfileRoad(std::vector<double> distance, std::vector<double> left, std::vector<double> right)
    : distance_(std::move(distance)), left_(std::move(left)), right_(std::move(right)) {
  const std::size_t count = distance_.size();
  if (count < 2) throw InputError("road profile", fmt::format("has {} points; at least 2 make a road", count));
  if (left_.size() != count || right_.size() != count)
    throw InputError("road profile",
                     fmt::format("has {} distances, {} heights left and {} right", count, left_.size(), right_.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const auto require = [&](bool good, const char* name, double value, const char* rule) {
      if (!good) throw InputError("road profile", fmt::format("{} of row {} is {}; must be {}", name, i, value, rule));
    };
    require(std::isfinite(distance_[i]), "distance", distance_[i], "finite");
    require(std::isfinite(left_[i]), "left height", left_[i], "finite");
    require(std::isfinite(right_[i]), "right height", right_[i], "finite");
    if (i > 0) require(distance_[i] > distance_[i - 1], "distance", distance_[i], "more than in the row before");
  }
  const double spacing = (distance_.back() - distance_.front()) / static_cast<double>(count - 1);
  bool even = true;
  for (std::size_t i = 0; i < count; ++i) {
    const double expected = distance_.front() + spacing * static_cast<double>(i);
    even = even && std::abs(distance_[i] - expected) < 1e-3 * spacing;
  }
  if (even) per_metre_ = 1.0 / spacing;
}

double ProfileRoad::height(const RoadPoint& point) const {
  const double d = point.distance;
  const auto at = [&](const std::vector<double>& track, std::size_t i, double share) {
    return track[i] + share * (track[i + 1] - track[i]);
  };
  const auto of_side = [&](std::size_t i, double share) {
    if (point.offset > 0.0) return at(left_, i, share);
    if (point.offset < 0.0) return at(right_, i, share);
    return 0.5 * (at(left_, i, share) + at(right_, i, share));
  };
  const std::size_t last = distance_.size() - 2;
  if (!(d > distance_.front())) return of_side(0, 0.0);
  if (d >= distance_.back()) return of_side(last, 1.0);
  std::size_t i = 0;
  if (per_metre_ > 0.0) {
    i = std::min(last, static_cast<std::size_t>((d - distance_.front()) * per_metre_));
    // The points lie within a thousandth of the grid: at most one interval off.
    if (d < distance_[i]) --i;
    if (i < last && d >= distance_[i + 1]) ++i;
  } else {
    i = static_cast<std::size_t>(std::upper_bound(distance_.begin(), distance_.end(), d) - distance_.begin()) - 1;
  }
  return of_side(i, (d - distance_[i]) / (distance_[i + 1] - distance_[i]));
}

ProfileRoad profile_road(const io::Table& table) {
  const Unit metre = parse_unit("m");
  const auto column = [&](const char* name) -> const std::vector<double>& {
    const io::TableColumn& found = table.at(name);
    if (!found.unit.same_dimension(metre))
      throw InputError(table.source,
                       fmt::format("column '{}' is in [{}]; expected a length, {}[m]", name, found.unit.name, name));
    return found.value;
  };
  const auto names = table.names();
  const bool one = std::find(names.begin(), names.end(), "height") != names.end();
  try {
    return {column("distance"), column(one ? "height" : "left"), column(one ? "height" : "right")};
  } catch (const InputError& error) {
    if (error.place() == table.source) throw;
    throw InputError(table.source, error.what());
  }
}

ProfileRoad read_profile_road(const std::filesystem::path& path) { return profile_road(io::read_table(path)); }

}  // namespace veridyn::vehicle
