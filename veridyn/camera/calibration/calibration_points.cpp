#include "veridyn/camera/calibration/calibration_points.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/tables/table.hpp"

namespace veridyn::camera {
namespace {

using Place = Eigen::Vector2d CalibrationPoint::*;

/// A line counts as one where the points are off it by less than this share of their extent.
constexpr double kOnALine = 1e-6;

/// The point that is farthest from the first, and the one that is farthest from the line through both.
struct Spread {
  std::size_t far = 0, aside = 0;
  double extent = 0.0, width = 0.0;
};

double distance_from_line(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = (b - a).normalized(), d = p - a;
  return std::abs(along(0) * d(1) - along(1) * d(0));
}

Spread spread_of(const CalibrationPoints& points, Place place, std::size_t without) {
  const auto& all = points.points;
  const std::size_t first = without == 0 ? 1 : 0;
  Spread s;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double d = (all[i].*place - all[first].*place).norm();
    if (i != without && d > s.extent) {
      s.extent = d;
      s.far = i;
    }
  }
  if (s.extent > 0.0) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double d = distance_from_line(all[i].*place, all[first].*place, all[s.far].*place);
      if (i != without && d > s.width) {
        s.width = d;
        s.aside = i;
      }
    }
  }
  return s;
}

void check_spread(const CalibrationPoints& points, Place place, const char* what) {
  constexpr std::size_t kAll = static_cast<std::size_t>(-1);
  const Spread s = spread_of(points, place, kAll);
  const std::size_t last = points.points.size() - 1;
  if (!(s.extent > 0.0))
    throw InputError(points.place(last),
                     fmt::format("all {} points up to here have the same place {}: nothing can be fitted",
                                 points.points.size(), what));
  const char* line_rule = "four are needed of which no three are on a line";
  if (!(s.width > kOnALine * s.extent))
    throw InputError(points.place(last), fmt::format("all {} points up to here are on a line {}: {}",
                                                     points.points.size(), what, line_rule));
  // All but one on a line: the one is an end of the longest distance, or the one aside.
  for (const std::size_t i : {std::size_t{0}, s.far, s.aside}) {
    const Spread rest = spread_of(points, place, i);
    if (!(rest.width > kOnALine * s.extent))
      throw InputError(points.place(i), fmt::format("all {} points but this one are on a line {}: {}",
                                                    points.points.size(), what, line_rule));
  }
}

}  // namespace

std::string CalibrationPoints::place(std::size_t i) const {
  const std::size_t line = points.at(i).line;
  return line > 0 ? fmt::format("{}:{}", source, line) : fmt::format("{}: point {}", source, i + 1);
}

void check_points(const CalibrationPoints& points) {
  const auto& all = points.points;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].track.allFinite() || !all[i].image.allFinite())
      throw InputError(points.place(i), "a coordinate is missing or not a finite number");
  }
  if (all.size() < 4)
    throw InputError(points.source, fmt::format("holds {} point{}; a map of the track needs at least 4", all.size(),
                                                all.size() == 1 ? "" : "s"));
  std::map<std::pair<double, double>, std::size_t> seen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [where, is_new] = seen.insert({{all[i].track(0), all[i].track(1)}, i});
    // Repeated measurements of a point are welcome; a hundredth of the image apart they are of two points.
    if (!is_new && (all[where->second].image - all[i].image).norm() >
                       0.01 * spread_of(points, &CalibrationPoint::image, all.size()).extent)
      throw InputError(points.place(i), fmt::format("the point ({:g}, {:g}) m was elsewhere in the image at {}",
                                                    all[i].track(0), all[i].track(1), points.place(where->second)));
  }
  check_spread(points, &CalibrationPoint::track, "on the track");
  check_spread(points, &CalibrationPoint::image, "in the image");
}

CalibrationPoints parse_calibration_points(std::string_view text, std::string source) {
  const io::Table table = io::parse_table(text, source);
  CalibrationPoints result{.source = std::move(source), .points = {}};
  const io::TableColumn &x = table.at("world_x"), &y = table.at("world_y");
  for (const io::TableColumn* column : {&x, &y}) {
    if (column->unit.name != "m" && column->unit.name != "1")
      throw InputError(table.source,
                       fmt::format("column '{}' is in {}; must be a length", column->name, column->unit.name));
  }
  const io::TableColumn &image_x = table.at("image_x"), &image_y = table.at("image_y");
  for (std::size_t i = 0; i < table.rows(); ++i)
    result.points.push_back({{x.value[i], y.value[i]}, {image_x.value[i], image_y.value[i]}, table.lines[i]});
  check_points(result);
  return result;
}

CalibrationPoints read_calibration_points(const std::filesystem::path& path) {
  return parse_calibration_points(read_file(path), path.string());
}

std::string to_csv(const CalibrationPoints& points) {
  std::string text = "world_x[m],world_y[m],image_x,image_y\n";
  for (const CalibrationPoint& p : points.points)
    text += fmt::format("{},{},{},{}\n", p.track(0), p.track(1), p.image(0), p.image(1));
  return text;
}

}  // namespace veridyn::camera
