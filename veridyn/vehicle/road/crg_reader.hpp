#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// A road surface of ASAM OpenCRG with a straight, level reference line: heights on a grid along it (u) and to its left
/// (v), bilinear between grid points, that of the edge beyond the edges. The road lies on the plane: what counts is
/// where the wheel is (x, y), not how far it travelled.
class CrgRoad final : public Road {
 public:
  /// Heights over distance along the reference line and lateral offset.
  struct Grid {
    double start_x = 0.0, start_y = 0.0;  ///< of the reference line, earth axes [m]
    double heading = 0.0;                 ///< [rad]
    double start_u = 0.0, step_u = 1.0;   ///< [m]
    std::vector<double> v;                ///< increasing [m]
    std::vector<float> z;                 ///< rows of v, one after the other along u [m]
  };
  explicit CrgRoad(Grid grid);
  [[nodiscard]] double height(const RoadPoint& point) const override;
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] std::size_t rows() const { return grid_.z.size() / grid_.v.size(); }

 private:
  Grid grid_;
  double cos_, sin_;
};

/// Reads a `.crg` file (ASAM OpenCRG 1.x): `$CT` text, `$ROAD_CRG` keys, `$KD_DEFINITION` channels, then heights as
/// text in fields of 10 or 20 characters (LRFI, LDFI) or as big-endian floats or doubles (KRBI, KDBI).
///
/// Heights that are missing take that of the nearest point of their cross section. Not read, and refused by name:
/// curved, sloped or banked reference lines, files that point to other files; modifiers and options
/// ($ROAD_CRG_MODS, $ROAD_CRG_OPTS) other than empty ones.
/// @throws InputError with file:line of the header, or the byte of the data.
[[nodiscard]] CrgRoad read_crg(const std::filesystem::path& path);
/// The same from bytes; `source` names them in errors.
[[nodiscard]] CrgRoad parse_crg(std::string_view bytes, std::string source);

}  // namespace veridyn::vehicle
