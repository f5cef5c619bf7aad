#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {

/// Which points `PathSolver` computes the ground positions of.
enum class PathPlaces {
  kNeeded,  ///< those that lengths and gradients need
  kEvery,   ///< all, for drawings and checks
};

/// View of compiled paths, the kinematics of one pose and a workspace, all of which must outlive it: evaluates the
/// paths there. Its definitions are in `path_solver_straight.hpp` (points, objects, straight segments),
/// `path_solver_wrapping.hpp` (which objects a path wraps over, and where), `path_solver_length.hpp` (lengths and
/// gradients of what was found) and `path_solver_opensim.hpp` (OpenSim's own constructions).
template <typename Scalar>
class PathSolver {
 public:
  using Vector = Vector3<Scalar>;
  using Node = typename PathWorkspace<Scalar>::Node;
  using Path = MusclePaths::Path;

  PathSolver(const MusclePaths& paths, const Kinematics<Scalar>& kinematics, const Scalar* q,
             PathWorkspace<Scalar>& workspace, PathPlaces places);

  /// All muscles but those of `skip` (by muscle, may be empty) that wrap or are given by functions.
  template <bool kGradient>
  void all(std::span<const std::uint8_t> skip = {});
  /// Solves one path; its nodes are in the workspace. Returns their number: none of a path by a function.
  std::size_t nodes_of(int muscle);
  /// Adds what a tension along one path does to the links that it pulls, by link, forces in ground.
  void pull(int muscle, const Scalar& tension, SpatialVector<Scalar>* by_link);
  /// Of a wrap that is on the path solved last.
  const WrapResult<Scalar>& result(std::size_t wrap) const { return *w_.result[wrap]; }

 private:
  static Eigen::Vector3d value_of(const Vector& v) { return values_of(v); }
  static double value_of(const Scalar& v) { return muscle::value_of(v); }

  // path_solver_straight.hpp
  void place(PathPlaces places);
  template <bool kGradient>
  void segments();
  /// All segments of two links.
  template <bool kGradient>
  void segments_between(const MusclePaths::LinkPair& pair);

  // path_solver_wrapping.hpp
  /// What an object does to one segment, in ground; true if it wraps.
  bool wrap_between(const MusclePaths::Object& object, int index, const MusclePaths::Wrap& wrap, bool single,
                    const Vector& p_ground, const Vector& q_ground, WrapResult<Scalar>& r,
                    internal::GeodesicMemory* memory = nullptr);
  /// Active points of a path into w_.stations.
  void stations(const Path& path);
  /// What each object does to the path through its points only: w_.first, w_.first_segment (-1: nothing).
  bool detect(const Path& path, PathFlag& flag);
  /// Puts the wraps of `mask` on the path of points: w_.nodes, w_.result. Returns the number of nodes.
  std::size_t solve(const Path& path, unsigned mask);
  /// The same without regard to whether objects cross.
  std::size_t solve_all(const Path& path, unsigned mask);
  /// Whether the n nodes solved last leave one object inside another one, or objects did not settle.
  bool crossing(std::size_t n) const;
  /// The same on the side `side_`, object after object until all tangent points settle.
  std::size_t settle(const Path& path, unsigned mask);
  /// Whether nodes lie next to those of the best path so far: on one side no other solution is that near.
  bool as_before(std::size_t n) const;
  void swap_with_other();
  /// Anderson's acceleration, two passes deep: of the point where the later of two neighbouring objects faces the
  /// other.
  struct Acceleration {
    int known = 0;
    Eigen::Vector3d residual = Eigen::Vector3d::Zero(), image = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, 2> residual_change = Eigen::Matrix<double, 3, 2>::Zero();
    Eigen::Matrix<double, 3, 2> image_change = Eigen::Matrix<double, 3, 2>::Zero();
  };
  void accelerate(std::size_t n, double moved, Acceleration& a);
  /// Segment of the path as it is now on which wrap i acts (n: none), with its result in w_.result[i].
  std::size_t choose(std::size_t i, const MusclePaths::Wrap& wrap, std::size_t n);
  void insert(const Path& path, std::size_t i, std::size_t at, std::size_t& n);
  /// Takes a wrap off the nodes; returns where it was, 0: nowhere (a path begins with a point).
  std::size_t remove(int wrap, std::size_t& n);

  // path_solver_length.hpp
  template <bool kGradient>
  Scalar general(const Path& path, PathFlag& flag);
  /// Length over the objects of `mask`, of which those of `fading` count in part; its gradient times `factor` added.
  template <bool kGradient>
  Scalar letting_go(const Path& path, unsigned mask, unsigned fading, const Scalar& factor);
  /// Length of the nodes, and its gradient times `factor`.
  template <bool kGradient>
  Scalar measure(const Path& path, std::size_t n, const Scalar& factor);
  bool is_moving(int point) const { return paths_.points_[point].moving >= 0; }
  /// A covector g along a line through x that grows with the motion of `to` and against that of `from`.
  void add_string(const Path& path, const Scalar& factor, const Vector& x, const Vector& g, int from, int to);
  void add_moving(const Path& path, const Scalar& factor, int point, const Vector& g);

  // path_solver_opensim.hpp
  WrapResult<Scalar> as_opensim(const MusclePaths::Object& object, const MusclePaths::Wrap& wrap, bool single,
                                const Vector& p, const Vector& q);
  std::size_t solve_as_opensim(const Path& path, std::size_t n);
  WrapStatus inside_somewhere(const Path& path, std::size_t i, std::size_t n);

  const MusclePaths& paths_;
  const Kinematics<Scalar>& kinematics_;
  const Scalar* q_;
  PathWorkspace<Scalar>& w_;
  SpatialVector<Scalar>* by_link_ = nullptr;  ///< where `add_string` adds forces of `tension_`; null: nowhere
  Scalar tension_{};
  std::size_t n_stations_ = 0;
  bool settled_ = true;  ///< what `settle` did last
  int side_ = 0;
  bool repeats_ = false;     ///< this side's solution is the best path so far
  double give_up_ = 0.0;     ///< length above which another side is abandoned
  std::size_t other_n_ = 0;  ///< nodes of the best path so far
  static constexpr double kNearlySettled = 1e-3;
  static constexpr int kAcceleratedPasses = 12;
  static constexpr int kMostPasses = 200;
  static constexpr int kMostChanges = 8;
};

extern template class PathSolver<double>;  // in muscle_path_evaluation.cpp

}  // namespace veridyn::muscle
