#include "veridyn/camera/calibration/homography.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"

namespace veridyn::camera {

PointScaling PointScaling::of(std::span<const Eigen::Vector2d> points) {
  PointScaling s;
  const double n = static_cast<double>(points.size());
  for (const Eigen::Vector2d& p : points) s.mean += p / n;
  double distance = 0.0;
  for (const Eigen::Vector2d& p : points) distance += (p - s.mean).norm() / n;
  s.scale = distance / std::sqrt(2.0);
  return s;
}

Eigen::Matrix3d direct_linear_homography(const CalibrationPoints& points) {
  check_points(points);
  std::vector<Eigen::Vector2d> track, image;
  for (const CalibrationPoint& p : points.points) {
    track.push_back(p.track);
    image.push_back(p.image);
  }
  const PointScaling a = PointScaling::of(track), b = PointScaling::of(image);
  Eigen::Matrix<double, Eigen::Dynamic, 9> A(2 * signed_index(track.size()), 9);
  for (std::size_t i = 0; i < track.size(); ++i) {
    const Eigen::RowVector3d u = ((track[i] - a.mean) / a.scale).homogeneous().transpose();
    const Eigen::Vector2d q = (image[i] - b.mean) / b.scale;
    A.row(2 * signed_index(i)) << u, Eigen::RowVector3d::Zero(), -q(0) * u;
    A.row(2 * signed_index(i) + 1) << Eigen::RowVector3d::Zero(), u, -q(1) * u;
  }
  // The right singular vector of A is an eigenvector of A'A too, but with half the digits.
  Eigen::MatrixXd rows = A;
  if (rows.rows() < 9) {
    rows.conservativeResize(9, 9);
    rows.bottomRows(9 - A.rows()).setZero();
  }
  const Eigen::VectorXd h = numerics::singular_values(rows, numerics::SingularVectors::kFullV).V.col(8);
  Eigen::Matrix3d H;
  H << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
  Eigen::Matrix3d from_track, to_image;
  from_track << 1.0 / a.scale, 0.0, -a.mean(0) / a.scale, 0.0, 1.0 / a.scale, -a.mean(1) / a.scale, 0.0, 0.0, 1.0;
  to_image << b.scale, 0.0, b.mean(0), 0.0, b.scale, b.mean(1), 0.0, 0.0, 1.0;
  const Eigen::Matrix3d full = to_image * H * from_track;
  return full / full.norm();
}

}  // namespace veridyn::camera
