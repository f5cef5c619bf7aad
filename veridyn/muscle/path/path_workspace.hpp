#pragma once

#include <cstdint>
#include <vector>

#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/wrap_result.hpp"

namespace veridyn::muscle {

/// How good a path's length is, worse values last.
enum class PathFlag : std::uint8_t {
  kFine = 0,
  kFading = 1,  ///< it is letting go of a cylinder, beyond its end
  kFailed = 2,  ///< a geodesic did not converge: straight there
};

/// Results and scratch memory of `MusclePaths`, made once, used by one thread.
template <typename Scalar>
struct PathWorkspace {
  explicit PathWorkspace(const MusclePaths& paths);

  std::vector<Scalar> length;    ///< by muscle [m]
  std::vector<Scalar> gradient;  ///< dL/dq by pair [m/rad or 1]
  std::vector<PathFlag> flag;    ///< by muscle

  using Vector = Vector3<Scalar>;
  /// Of a wrap object, in ground.
  struct Frame {
    Matrix3<Scalar> rotation;
    Vector position;
  };
  /// A point of a path as solved, in ground: a path point or a tangent point.
  struct Node {
    Vector x;
    int link = 0;
    int point = -1;    ///< of a path point
    int station = -1;  ///< of a path point
    int wrap = -1;     ///< of a tangent point
  };
  std::vector<Vector> position;
  std::vector<Vector> moving_slope;
  std::vector<Scalar> segment_length;
  std::vector<Scalar> term;
  std::vector<SpatialVector<Scalar>> local_column;
  std::vector<Frame> object;
  std::vector<WrapResult<Scalar>> span;
  std::vector<std::uint8_t> span_known;
  std::vector<Node> stations;
  std::vector<Node> nodes;
  std::vector<Node> other_nodes;
  WrapResult<Scalar> fresh;
  /// Of the wraps on the path: in `span`, or in `result_solved` where an end is a tangent point.
  std::vector<const WrapResult<Scalar>*> result;
  std::vector<const WrapResult<Scalar>*> other_result;
  std::vector<WrapResult<Scalar>> result_solved;
  std::vector<WrapResult<Scalar>> other_result_solved;
  std::vector<const WrapResult<Scalar>*> first;
  std::vector<WrapResult<Scalar>> first_solved;
  std::vector<int> first_segment;
  std::vector<Vector> before;  ///< tangent points of the last pass
  std::vector<Vector> start;   ///< and of the one before
  std::vector<internal::GeodesicMemory> memory;
};

extern template struct PathWorkspace<double>;  // in muscle_path_evaluation.cpp

}  // namespace veridyn::muscle
