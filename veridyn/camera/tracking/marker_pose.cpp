#include "veridyn/camera/tracking/marker_pose.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::camera {
namespace {

using PoseJacobian = Eigen::Matrix<double, 2, 3>;

Eigen::Matrix2d turned(double heading) {
  const double c = std::cos(heading), s = std::sin(heading);
  Eigen::Matrix2d R;
  R << c, -s, s, c;
  return R;
}

}  // namespace

void MarkerLayout::validate() const {
  if (markers.size() < 2 || markers.size() > 3)
    throw InputError("markers", fmt::format("{} markers; must be two or three", markers.size()));
  if (!(sigma > 0.0 && std::isfinite(sigma))) throw InputError("markers", "sigma must be > 0");
  constexpr double kApart = 0.005;
  std::vector<double> distances;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!markers[i].allFinite()) throw InputError("markers", fmt::format("marker {} is not a place", i + 1));
    for (std::size_t j = 0; j < i; ++j) {
      const double d = (markers[i] - markers[j]).norm();
      if (!(d > kApart)) throw InputError("markers", fmt::format("markers {} and {} are at one place", j + 1, i + 1));
      for (const double other : distances) {
        if (!(std::abs(d - other) > kApart))
          throw InputError("markers", fmt::format("two distances between markers are {:.0f} and {:.0f} mm; they must "
                                                  "differ by more than 5 mm to be distinguishable",
                                                  1e3 * other, 1e3 * d));
      }
      distances.push_back(d);
    }
  }
}

void spots_of(std::span<const Blob> blobs, const Calibration& calibration, std::vector<Spot>& spots) {
  spots.clear();
  for (const Blob& blob : blobs) {
    if (blob.disturbed) continue;
    const auto place = calibration.camera.to_track(blob.centre);
    if (!place) continue;
    const Eigen::Matrix2d back = calibration.camera.J_image_track(*place).inverse();
    Spot spot;
    spot.place = *place;
    spot.noise = back * blob.covariance * back.transpose();
    spot.J_place_parameters = -back * calibration.camera.J_image_parameters(*place);
    if (spot.noise.allFinite()) spots.push_back(spot);
  }
}

std::optional<PoseMeasurement> fit_pose(std::span<const Spot* const> spots, std::span<const std::size_t> which,
                                        const MarkerLayout& layout, const Calibration& calibration) {
  const std::size_t n = spots.size();
  if (n < 2) return std::nullopt;
  Eigen::Vector2d mean_spot = Eigen::Vector2d::Zero(), mean_marker = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    mean_spot += spots[i]->place / static_cast<double>(n);
    mean_marker += layout.markers[which[i]] / static_cast<double>(n);
  }
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d m = layout.markers[which[i]] - mean_marker, z = spots[i]->place - mean_spot;
    along += m.dot(z);
    across += m(0) * z(1) - m(1) * z(0);
  }
  if (!(std::hypot(along, across) > 0.0)) return std::nullopt;
  PoseMeasurement result;
  result.markers = n;
  double heading = std::atan2(across, along);
  Eigen::Vector2d place = mean_spot - turned(heading) * mean_marker;
  Eigen::Matrix3d information;
  Eigen::Matrix<double, 3, TrackCamera::kParameters> through;  // sum H' C^-1 d place / d parameters
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Eigen::Matrix2d R = turned(heading);
    information.setZero();
    through.setZero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    result.chi_square = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector2d arm = R * layout.markers[which[i]];
      PoseJacobian H;
      H << 1.0, 0.0, -arm(1), 0.0, 1.0, arm(0);
      const Eigen::Matrix2d weight =
          (spots[i]->noise + layout.sigma * layout.sigma * Eigen::Matrix2d::Identity()).inverse();
      const Eigen::Vector2d off = spots[i]->place - place - arm;
      information += H.transpose() * weight * H;
      gradient += H.transpose() * weight * off;
      through += H.transpose() * weight * spots[i]->J_place_parameters;
      result.chi_square += off.dot(weight * off);
    }
    const Eigen::Vector3d step = information.ldlt().solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    place += step.head<2>();
    heading += step(2);
  }
  result.pose << place, std::remainder(heading, kFullTurn);
  result.noise = information.inverse();
  const Eigen::Matrix<double, 3, TrackCamera::kParameters> J = result.noise * through;
  result.map = J * calibration.covariance * J.transpose();
  result.map.topLeftCorner<2, 2>() += calibration.systematic_covariance(place);
  if (!result.noise.allFinite()) return std::nullopt;
  return result;
}

}  // namespace veridyn::camera
