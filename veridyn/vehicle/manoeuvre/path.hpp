#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::vehicle {

/// A place on a path.
struct PathPoint {
  double x = 0.0, y = 0.0;  ///< [m]
  double heading = 0.0;     ///< of the tangent, counted from x to the left [rad], not wrapped along the path
  double curvature = 0.0;   ///< d heading/d s, left positive [1/m]
};

/// A plane curve parametrised by its arc length s, made of straight lines, arcs and pieces of polynomials up to the
/// fifth degree. Beyond the ends of an open path its tangents go on; a closed one begins again.
class Path {
 public:
  /// x(p) and y(p) for p in [0, 1], ascending powers.
  struct Polynomial {
    std::array<double, 6> x{}, y{};
  };

  /// Starts at a point with a heading [rad]; then append pieces.
  explicit Path(double x = 0.0, double y = 0.0, double heading = 0.0);
  /// A straight line or an arc of constant curvature [1/m] (left positive) and length [m] > 0, tangent to what is
  /// there.
  Path& append_arc(double length, double curvature);
  Path& append_line(double length) { return append_arc(length, 0.0); }
  /// A polynomial that begins where the path ends. @throws InputError when it has a cusp.
  Path& append(const Polynomial& piece);
  /// A lateral shift by `offset` to the left while going `length` ahead, of the fifth degree: straight and uncurved at
  /// both ends.
  Path& append_lane_change(double length, double offset);
  /// The end joins the beginning from here on (position and heading must agree to a thousandth of the length).
  void close();

  /// The same curve moved and turned so that it begins at the origin along x.
  [[nodiscard]] Path from_origin() const;

  /// Radius > 0 [m]; positive `direction` turns left. Closed; starts at the origin along x.
  [[nodiscard]] static Path circle(double radius, int direction = 1);
  /// A quintic spline through at least three points (chord-length parameter).
  /// @throws InputError for fewer, unequal numbers, or neighbours that coincide.
  [[nodiscard]] static Path through(std::span<const double> x, std::span<const double> y);

  /// [m]
  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] bool closed() const { return closed_; }
  /// At arc length s [m], to about 1e-10 of a piece's length. Does not allocate.
  [[nodiscard]] PathPoint at(double s) const;
  /// Arc length of the point nearest to (x, y) within about `window` metres of `guess`; on a closed path it grows with
  /// the laps. Does not allocate.
  [[nodiscard]] double nearest(double x, double y, double guess, double window = 5.0) const;
  /// The same over the whole path.
  [[nodiscard]] double nearest(double x, double y) const;

 private:
  struct Piece {
    double begin = 0.0, length = 0.0;  ///< arc length
    bool is_arc = true;
    PathPoint start;  ///< of an arc
    Polynomial polynomial;
    std::vector<double> table;  ///< arc length at equal steps of p, from 0 to `length`
    double heading = 0.0;       ///< at the beginning, to unwrap
  };
  [[nodiscard]] PathPoint on_piece(const Piece& piece, double s) const;

  std::vector<Piece> pieces_;
  PathPoint start_, end_;
  double length_ = 0.0;
  bool closed_ = false;
};

/// Reads a path: a CSV with columns x[m], y[m], or knots of a Bezier curve in the text format of Project Chrono (first
/// line: number of knots and 3 or 9 columns; each row knot, in-control and out-control point, x y z; with 3 columns the
/// knots are joined by a spline). Heights are ignored.
/// @throws InputError with file and line.
[[nodiscard]] Path read_path(const std::filesystem::path& file);
/// The same from a text; `source` names it in errors.
[[nodiscard]] Path parse_bezier_path(std::string_view text, const std::string& source);

}  // namespace veridyn::vehicle
