// What a path looks like at one pose: for drawings and messages.
#include <algorithm>
#include <cmath>

#include "veridyn/muscle/path/path_solver.hpp"

namespace veridyn::muscle {
namespace {

/// How deep a point lies inside an object; negative outside.
double depth(const Eigen::Vector3d& p, const WrapObject& object) {
  const Eigen::Vector3d& d = object.dimensions;
  switch (object.shape) {
    case WrapShape::kSphere:
      return d[0] - p.norm();
    case WrapShape::kCylinder:
      return d[0] - p.head<2>().norm();
    case WrapShape::kEllipsoid: {
      const Eigen::Vector3d scaled = p.cwiseQuotient(d);
      const double steepness = 2.0 * scaled.cwiseQuotient(d).norm();
      return std::min((1.0 - scaled.squaredNorm()) / std::max(steepness, 1e-9), d.minCoeff());
    }
    case WrapShape::kTorus:
      return d[0] - std::hypot(p.head<2>().norm() - d[1], p.z());
  }
  return -1.0;
}

}  // namespace

std::vector<Eigen::Vector3d> MusclePaths::polyline(const Kinematics<double>& kinematics, const double* q, int muscle,
                                                   int arc_points) const {
  PathWorkspace<double> workspace(*this);
  PathSolver<double> solver(*this, kinematics, q, workspace, PathPlaces::kEvery);
  const std::size_t n = solver.nodes_of(muscle);
  const Path& path = muscles_[muscle];
  std::vector<Eigen::Vector3d> line;
  for (std::size_t k = 0; k < n; ++k) {
    const auto& node = workspace.nodes[k];
    line.push_back(node.x);
    if (node.wrap < 0 || k + 1 == n || workspace.nodes[k + 1].wrap != node.wrap) continue;
    // Between the tangent points: a Bezier arc with the right ends and directions, laid onto the surface.
    const WrapResult<double>& r = solver.result(static_cast<std::size_t>(node.wrap));
    const int index = path.wraps[node.wrap].object;
    const auto& frame = workspace.object[index];
    const Object& object = objects_[index];
    const Eigen::Vector3d d1 = (r.r1 - workspace.nodes[k - 1].x).normalized() * r.surface_length / 3.0;
    const Eigen::Vector3d d2 = (workspace.nodes[k + 2].x - r.r2).normalized() * r.surface_length / 3.0;
    for (int i = 1; i <= arc_points; ++i) {
      const double t = static_cast<double>(i) / (arc_points + 1), u = 1.0 - t;
      const Eigen::Vector3d x =
          u * u * u * r.r1 + 3.0 * u * u * t * (r.r1 + d1) + 3.0 * u * t * t * (r.r2 - d2) + t * t * t * r.r2;
      Eigen::Vector3d local = frame.rotation.transpose() * (x - frame.position);
      if (object.shape == WrapShape::kSphere) local *= object.sphere.radius / local.norm();
      if (object.shape == WrapShape::kEllipsoid) local /= local.cwiseQuotient(object.ellipsoid.radii).norm();
      if (object.shape == WrapShape::kCylinder) local.head<2>() *= object.cylinder.radius / local.head<2>().norm();
      line.push_back(frame.rotation * local + frame.position);
    }
  }
  return line;
}

std::vector<std::string> MusclePaths::touched(const Kinematics<double>& kinematics, const double* q, int muscle) const {
  PathWorkspace<double> workspace(*this);
  PathSolver<double> solver(*this, kinematics, q, workspace, PathPlaces::kEvery);
  const std::size_t n = solver.nodes_of(muscle);
  const Path& path = muscles_[muscle];
  std::vector<std::string> names;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const int wrap = workspace.nodes[k].wrap;
    if (wrap >= 0 && workspace.nodes[k + 1].wrap == wrap) names.push_back(objects_[path.wraps[wrap].object].name);
  }
  return names;
}

std::vector<MusclePaths::PointInside> MusclePaths::points_inside(const Kinematics<double>& kinematics,
                                                                 const double* q) const {
  PathWorkspace<double> workspace(*this);
  const PathSolver<double> solver(*this, kinematics, q, workspace, PathPlaces::kEvery);
  std::vector<PointInside> found;
  for (int muscle = 0; muscle < muscles(); ++muscle) {
    const Path& path = muscles_[muscle];
    for (const Wrap& wrap : path.wraps) {
      const Object& object = objects_[wrap.object];
      const auto& frame = workspace.object[wrap.object];
      for (int i = wrap.first; i <= wrap.last; ++i) {
        const PathStation& station = path.stations[i];
        const Eigen::Vector3d local = frame.rotation.transpose() * (workspace.position[station.point] - frame.position);
        const double below = depth(local, object.description);
        const auto same = [&](const PointInside& other) {
          return other.muscle == muscle && other.point == station.name && other.object == object.name;
        };
        if (below > 0.0 && std::none_of(found.begin(), found.end(), same))
          found.push_back({muscle, station.name, object.name, below});
      }
    }
  }
  return found;
}

}  // namespace veridyn::muscle
