#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/path/path_functions.hpp"
#include "veridyn/muscle/path/wrap_cylinder.hpp"
#include "veridyn/muscle/path/wrap_ellipsoid.hpp"
#include "veridyn/muscle/path/wrap_sphere.hpp"
#include "veridyn/muscle/path/wrap_torus.hpp"

namespace veridyn::muscle {

/// Which construction of wrapped paths is used.
enum class WrapMode {
  kTaut,       ///< a taut string: continuous lengths, moment arms that are their derivatives
  kAsOpenSim,  ///< OpenSim's own constructions, to compare with; double only (`wrap_opensim.hpp`)
};

template <typename Scalar>
struct PathWorkspace;

/// The musculotendon paths of a model, compiled: lengths L(q) and their derivatives dL/dq. A muscle's moment arm about
/// a coordinate is -dL/dq, in OpenSim's sign (positive where tension raises the coordinate).
///
/// Points are fixed, conditional or moving as in the file. A wrap object acts on every segment of its range by itself
/// (on paths with conditional points, and as OpenSim does: on the first that meets the object, otherwise the one that a
/// quadrant's wall lengthens least). Objects that share a segment are solved together until all tangent points settle;
/// of objects that cross, so that they have no string in common, those count over which the longest string runs.
///
/// What is the same for every pose (segments within a link) is computed once here, what several muscles share
/// (segments, wraps of one pair of points) once per pose. Immutable, used by many threads at once; no call below
/// allocates, throws, or returns NaN for finite input.
///
/// The templates are compiled for double and `SimulationJet`; `muscle_path_evaluation.hpp` defines them for others.
class MusclePaths {
 public:
  /// @throws InputError naming muscle and point or wrap object where a path has fewer than two points, refers to what
  /// is not there, or a wrap object has no positive size.
  MusclePaths(const Model& model, const Mechanism& mechanism, WrapMode mode = WrapMode::kTaut);

  /// dL/dq of `muscle` with respect to `coordinate` can be other than zero.
  struct Pair {
    int muscle = 0;
    int coordinate = 0;
  };

  [[nodiscard]] int muscles() const { return static_cast<int>(muscles_.size()); }
  [[nodiscard]] int coordinates() const { return coordinates_; }
  [[nodiscard]] WrapMode mode() const { return mode_; }
  /// Whether a muscle has wrap objects that are active.
  [[nodiscard]] bool can_wrap(int muscle) const { return !muscles_[muscle].wraps.empty(); }
  /// Whether the model gives a muscle's length as a function of coordinates. Such a path is nowhere: it has no points,
  /// and its tension is generalised forces only.
  [[nodiscard]] bool by_function(int muscle) const { return muscles_[muscle].stations.empty(); }
  /// All pairs, muscle after muscle: the order of `PathWorkspace::gradient`.
  [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }
  [[nodiscard]] std::size_t first_pair(int muscle) const { return muscles_[muscle].pairs[0]; }
  [[nodiscard]] std::size_t end_pair(int muscle) const { return muscles_[muscle].pairs[1]; }

  /// Lengths [m] at the pose q whose `update_positions` filled `kinematics`.
  template <typename Scalar>
  void lengths(const Kinematics<Scalar>& kinematics, const Scalar* q, PathWorkspace<Scalar>& workspace) const;
  /// Lengths and `gradient`.
  template <typename Scalar>
  void evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q, PathWorkspace<Scalar>& workspace) const;
  /// The same, except that muscles that can wrap, or are given by functions, and have skip[muscle] != 0 are not
  /// evaluated.
  template <typename Scalar>
  void evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q, PathWorkspace<Scalar>& workspace,
                std::span<const std::uint8_t> skip) const;
  /// Lengthening speeds [m/s] at the pose last evaluated: speeds[m] = sum dL/dq qdot.
  template <typename Scalar>
  void speeds(const PathWorkspace<Scalar>& workspace, const Scalar* qdot, Scalar* speeds) const;

  /// Adds what a tension [N] along one muscle's path does to the links that it pulls, by link: strings at their ends,
  /// wraps at their tangent points. Nothing for a path by a function. `workspace` is overwritten.
  void add_tension(const Kinematics<double>& kinematics, const double* q, int muscle, double tension,
                   PathWorkspace<double>& workspace, std::span<SpatialVector<double>> by_link) const;

  /// One muscle's path as a polyline in ground, for drawings: its active points and, on each wrap, `arc_points` points
  /// between the tangent points (on the surface, along a section of it). Empty for a path by a function.
  [[nodiscard]] std::vector<Eigen::Vector3d> polyline(const Kinematics<double>& kinematics, const double* q, int muscle,
                                                      int arc_points = 16) const;
  /// Names of the wrap objects that the path touches, in its order.
  [[nodiscard]] std::vector<std::string> touched(const Kinematics<double>& kinematics, const double* q,
                                                 int muscle) const;
  /// A path point inside a wrap object of its own path.
  struct PointInside {
    int muscle = 0;
    std::string point, object;
    double depth = 0.0;  ///< below the surface [m]; of an ellipsoid to first order in the depth
  };
  /// All of a pose.
  [[nodiscard]] std::vector<PointInside> points_inside(const Kinematics<double>& kinematics, const double* q) const;

 private:
  template <typename Scalar>
  friend struct PathWorkspace;
  template <typename Scalar>
  friend class PathSolver;

  struct Point {
    int link = 0;
    Eigen::Vector3d location = Eigen::Vector3d::Zero();  ///< in the link; of a moving point: unused
    int moving = -1;
  };
  struct MovingPoint {
    int point = 0;
    Placement in_link;  ///< of the frame it is given in
    std::array<int, 3> coordinate{-1, -1, -1};
    std::array<double, 3> low{}, high{};  ///< of the coordinate's range; beyond it the point stays, as OpenSim's does
    std::array<numerics::PiecewisePolynomial, 3> location;
    std::array<double, 3> still{};             ///< where it has no coordinate
    std::array<std::size_t, 3> with{0, 1, 2};  ///< the first axis that has the same coordinate
  };
  struct Object {
    std::string name;
    WrapObject description;
    int link = 0;
    Placement in_link;
    WrapShape shape = WrapShape::kSphere;
    WrapSphere sphere;
    WrapCylinder cylinder;
    WrapEllipsoid ellipsoid;
    WrapTorus torus;
    double reach = 0.0;  ///< a segment further from the centre does not meet it; 0: unknown
  };
  /// A straight piece between two links, shared by all muscles that have it.
  struct Segment {
    int a = 0, b = 0;
    std::array<std::size_t, 2> terms{};  ///< in terms_
  };
  /// Contribution of a segment to dL/dq of one coordinate.
  struct Term {
    int coordinate = 0;
    int sign = 0;     ///< of the rigid motion: +1 it moves b, -1 it moves a, 0 neither
    int moving = -1;  ///< else: of a moving point, 3 index + the first axis that has the coordinate
  };
  /// A pair of points and an object, shared by all muscles that have it.
  struct Span {
    int a = 0, b = 0, object = 0;
    bool alone = true;
  };
  struct Wrap {
    int object = 0;
    int first = 0, last = 0;  ///< points of the path, inclusive
    EllipsoidMethod method = EllipsoidMethod::kHybrid;
    bool alone = true;       ///< no other object of the path acts on its segments
    std::vector<int> spans;  ///< by segment first..last-1, -1: can never wrap; empty where points are conditional
  };
  struct PathStation {
    int point = 0;
    int condition = -1;  ///< coordinate, -1: always there
    double low = 0.0, high = 0.0;
    std::string name;
  };
  struct Path {
    std::string name;
    std::vector<PathStation> stations;
    std::vector<Wrap> wraps;
    std::vector<double> fixed;  ///< length from a station to the next where both are fixed to one link, else -1
    std::array<std::size_t, 2> pairs{};
    bool coupled = false;  ///< several objects may act on one segment
  };
  struct Condition {
    int coordinate = 0;
    double low = 0.0, high = 0.0;
    /// With OpenSim's own margin.
    [[nodiscard]] bool holds(double value) const { return value >= low - 1e-5 && value <= high + 1e-5; }
  };
  /// A path without wraps: a sum of straight segments, one sum for each set of conditions that hold.
  struct StraightPath {
    int muscle = 0;
    std::size_t conditions = 0, end_conditions = 0;  ///< in conditions_
    std::size_t variants = 0;                        ///< in variants_: 2 to the number of conditions
  };
  struct Variant {
    double constant = 0.0;                       ///< length of the segments within links
    std::size_t segments = 0, end_segments = 0;  ///< those between links, in variant_segments_
    std::size_t adds = 0, end_adds = 0;          ///< in variant_adds_
  };
  /// A term of a gradient.
  struct Add {
    std::uint32_t term = 0, pair = 0;
  };
  /// Segments whose ends are fixed to the same two links. They depend on the same coordinates.
  struct LinkPair {
    int a = 0, b = 0;
    std::size_t first = 0, end = 0;  ///< a multiple of kLanes; what is left over is of no path
    std::size_t terms = 0;           ///< of the first coordinate, then those of the next one, ...
    std::vector<int> coordinates;
    std::vector<double> signs;  ///< +1: it moves b, -1: it moves a
  };
  static constexpr std::size_t kLanes = 4;           ///< segments that are computed together
  static constexpr std::size_t kMostWraps = 32;      ///< of a path
  static constexpr std::size_t kMostConditions = 4;  ///< of a path that is compiled into variants

  int point(int link, const Eigen::Vector3d& location);
  int segment(int a, int b);
  void add_object(const Model& model, const Mechanism& mechanism, const WrapObject& object);
  void add_path(const Model& model, const Mechanism& mechanism, const Muscle& muscle);
  void add_function(const Model& model, int muscle);
  [[nodiscard]] PathStation station(const Model& model, const Mechanism& mechanism, const Muscle& muscle,
                                    const PathPoint& point);
  [[nodiscard]] bool never_wraps(const Object& object, const Point& a, const Point& b) const;
  [[nodiscard]] static WrapStatus wrap_status(const Object& object, const Eigen::Vector3d& p, const Eigen::Vector3d& q);
  void list_spans(Path& path);
  void part_wraps(Path& path) const;
  void compile_path(int muscle);
  void compile_straight(int muscle);
  void sort_segments();
  void sort_terms();
  void list_points();
  [[nodiscard]] std::vector<int> coordinates_of(const Path& path) const;
  [[nodiscard]] bool moves(int coordinate, int link) const {
    return moves_[static_cast<std::size_t>(link) * static_cast<std::size_t>(coordinates_) +
                  static_cast<std::size_t>(coordinate)] != 0;
  }

  WrapMode mode_;
  int coordinates_ = 0;
  std::vector<std::uint8_t> moves_;  ///< links x coordinates
  std::vector<Point> points_;
  std::vector<MovingPoint> moving_;
  std::vector<Object> objects_;
  std::vector<Segment> segments_;
  std::vector<Term> terms_;
  std::vector<Span> spans_;
  std::vector<Path> muscles_;
  std::vector<Pair> pairs_;
  std::vector<int> general_;  ///< muscles that are in neither straight_ nor functions_
  PathFunctions functions_;
  std::vector<StraightPath> straight_;
  std::vector<Condition> conditions_;
  std::vector<Variant> variants_;
  std::vector<int> variant_segments_;
  std::vector<Add> variant_adds_;
  /// segments_ from 0 to the end of the last pair have fixed ends: contiguous, so that they are computed together.
  std::vector<LinkPair> link_pairs_;
  std::array<std::vector<double>, 3> end_a_, end_b_;  ///< of those, by axis, in their links
  std::vector<int> points_in_ground_;                 ///< those that wraps and moving points need there
  std::size_t most_stations_ = 0;
  std::size_t most_wraps_ = 0;
  std::size_t most_pair_coordinates_ = 0;
};

}  // namespace veridyn::muscle
