#include "veridyn/muscle/path/muscle_path_evaluation.hpp"

namespace veridyn::muscle {

void MusclePaths::add_tension(const Kinematics<double>& kinematics, const double* q, int muscle, double tension,
                              PathWorkspace<double>& workspace, std::span<SpatialVector<double>> by_link) const {
  PathSolver<double>(*this, kinematics, q, workspace, PathPlaces::kEvery).pull(muscle, tension, by_link.data());
}
namespace internal {

template SpheroidArrival<double> spheroid_geodesic<double>(const Spheroid&, const Eigen::Vector3d&,
                                                           const Eigen::Vector3d&, const Eigen::Vector3d&,
                                                           const double&, const double&);
template GeodesicShot<double> shoot<double>(const Eigen::Vector3d&, const Spheroid&, const Eigen::Vector3d&,
                                            const Eigen::Vector3d&, const TangentCircle<double>&, const double&,
                                            const double&, const double&, int);
template void wrap_onto<double>(const WrapSphere&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                WrapResult<double>&);
template void wrap_onto<double>(const WrapCylinder&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                WrapResult<double>&);
template void wrap_onto<double>(const WrapEllipsoid&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                GeodesicMemory*, WrapResult<double>&);

}  // namespace internal

WrapStatus MusclePaths::wrap_status(const Object& object, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  switch (object.shape) {
    case WrapShape::kSphere:
      return muscle::wrap(object.sphere, p, q).status;
    case WrapShape::kCylinder:
      return muscle::wrap(object.cylinder, p, q).status;
    case WrapShape::kEllipsoid:
      return muscle::wrap(object.ellipsoid, p, q).status;
    case WrapShape::kTorus:
      break;
  }
  return muscle::wrap(object.torus, p, q).status;
}

template struct PathWorkspace<double>;
template class PathSolver<double>;
template void MusclePaths::lengths(const Kinematics<double>&, const double*, PathWorkspace<double>&) const;
template void MusclePaths::evaluate(const Kinematics<double>&, const double*, PathWorkspace<double>&) const;
template void MusclePaths::evaluate(const Kinematics<double>&, const double*, PathWorkspace<double>&,
                                    std::span<const std::uint8_t>) const;
template void MusclePaths::speeds(const PathWorkspace<double>&, const double*, double*) const;

}  // namespace veridyn::muscle
