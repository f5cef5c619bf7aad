#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::camera {

/// A point whose place on the track was measured and that was found in the image.
struct CalibrationPoint {
  Eigen::Vector2d track = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d image = Eigen::Vector2d::Zero();  ///< [px]
  std::size_t line = 0;                             ///< of the file; 0: unknown
};

/// Points, and where they are from, for messages.
struct CalibrationPoints {
  std::string source = "points";
  std::vector<CalibrationPoint> points;

  /// "points.csv:12", or "points.csv: point 12" (from 1) where the line is unknown.
  [[nodiscard]] std::string place(std::size_t i) const;
};

/// Reads a table with the columns world_x, world_y (of any unit of length, metres where none is given) and image_x,
/// image_y [px]; comma, semicolon or tabulator between them.
/// @throws InputError with file and line: a cell that is missing or no number, a column that is missing, a unit that is
/// not one of length, and as `check_points`
[[nodiscard]] CalibrationPoints read_calibration_points(const std::filesystem::path& path);
/// The same from text.
[[nodiscard]] CalibrationPoints parse_calibration_points(std::string_view text, std::string source);

/// The points as such a table; read back to the same doubles.
[[nodiscard]] std::string to_csv(const CalibrationPoints& points);

/// @throws InputError where no map can be fitted: fewer than four points, a number that is not finite (with its line),
/// the same place on the track twice with its image elsewhere (with both lines), all points of track or image at one
/// place, or no four of them of which no three are on a line.
void check_points(const CalibrationPoints& points);

}  // namespace veridyn::camera
