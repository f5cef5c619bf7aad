#include "veridyn/camera/calibration/track_camera.hpp"

#include <ceres/jet.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::camera {
namespace internal {

double fold_of(double k1, double k2) noexcept {
  // With s = r^2: 5 k2 s^2 + 3 k1 s + 1 = 0, in the form that survives k2 -> 0.
  const double square = 9.0 * k1 * k1 - 20.0 * k2;
  if (!(square >= 0.0)) return kInfinity;
  const double root = std::sqrt(square);
  double smallest = kInfinity;
  for (const double below : {-3.0 * k1 + root, -3.0 * k1 - root}) {
    if (below > 0.0) smallest = std::min(smallest, 2.0 / below);
  }
  return std::sqrt(smallest);
}

double distorted_share(double s, double k1, double k2, double fold) noexcept {
  const double plain = std::sqrt(s);
  if (!std::isfinite(plain)) return kNaN;
  if (plain == 0.0) return 1.0;
  const auto profile = [&](double r) { return r * (1.0 + r * r * (k1 + k2 * r * r)); };
  // The profile grows from 0 to the fold: a bracket, and Newton's steps within it.
  double low = 0.0, high = fold;
  if (std::isfinite(high)) {
    if (!(plain < profile(high))) return kNaN;
  } else {
    high = plain;
    for (int i = 0; i < 200 && profile(high) < plain; ++i) high *= 2.0;
  }
  double r = std::min(plain, high);
  for (int i = 0; i < 100; ++i) {
    const double error = profile(r) - plain;
    (error > 0.0 ? high : low) = r;
    double next = r - error / (1.0 + r * r * (3.0 * k1 + 5.0 * k2 * r * r));
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool done = std::abs(next - r) <= 1e-15 * r;
    r = next;
    if (done) break;
  }
  return r / plain;
}

}  // namespace internal

TrackCamera::TrackCamera(const Parameters& parameters, const Eigen::Vector2d& track_centre, double track_scale,
                         double image_scale)
    : parameters_(parameters), track_centre_(track_centre), track_scale_(track_scale), image_scale_(image_scale) {
  if (!parameters.allFinite() || !track_centre.allFinite())
    throw InputError("camera", "a parameter of the map is not a finite number");
  if (!(track_scale > 0.0 && std::isfinite(track_scale) && image_scale > 0.0 && std::isfinite(image_scale)))
    throw InputError("camera", "the scales of track and image must be > 0");
  Eigen::Matrix3d H;
  H << parameters(0), parameters(1), parameters(2), parameters(3), parameters(4), parameters(5), parameters(6),
      parameters(7), 1.0;
  // Rows 1 and 2 are in pixels; the determinant is compared in units of the image.
  const double determinant = H.determinant() / (image_scale * image_scale);
  if (!(std::abs(determinant) > 1e-12))
    throw InputError("camera", "the homography maps the track onto a line and cannot be inverted");
  back_ = H.inverse();
  folding_ = internal::fold_of(parameters(10), parameters(11));
}

double TrackCamera::folding_radius() const noexcept { return folding_ * image_scale_; }

std::optional<Eigen::Vector2d> TrackCamera::to_image(const Eigen::Vector2d& track) const noexcept {
  const Eigen::Vector2d u = normalised(track);
  if (!(parameters_(6) * u(0) + parameters_(7) * u(1) + 1.0 > 0.0)) return std::nullopt;
  const Eigen::Vector2d image = project<double>(parameters_.data(), u, image_scale_);
  if (!image.allFinite()) return std::nullopt;
  return image;
}

std::optional<Eigen::Vector2d> TrackCamera::to_track(const Eigen::Vector2d& image) const noexcept {
  const Eigen::Vector2d centre = parameters_.segment<2>(8), d = image - centre;
  const double r2 = d.squaredNorm() / (image_scale_ * image_scale_);
  if (!(r2 < folding_ * folding_)) return std::nullopt;
  const Eigen::Vector2d plain = centre + d * (1.0 + r2 * (parameters_(10) + parameters_(11) * r2));
  const Eigen::Vector3d u = back_ * plain.homogeneous();
  if (!(u(2) != 0.0)) return std::nullopt;
  const Eigen::Vector2d normal = u.head<2>() / u(2);
  if (!(parameters_(6) * normal(0) + parameters_(7) * normal(1) + 1.0 > 0.0)) return std::nullopt;
  const Eigen::Vector2d track = track_centre_ + track_scale_ * normal;
  if (!track.allFinite()) return std::nullopt;
  return track;
}

Eigen::Matrix2d TrackCamera::J_image_track(const Eigen::Vector2d& track) const noexcept {
  using Jet = ceres::Jet<double, 2>;
  Eigen::Matrix<Jet, kParameters, 1> h;
  for (int i = 0; i < kParameters; ++i) h(i) = Jet(parameters_(i));
  const Eigen::Vector2d n = normalised(track);
  const Eigen::Matrix<Jet, 2, 1> u(Jet(n(0), 0), Jet(n(1), 1));
  const Eigen::Matrix<Jet, 2, 1> image = project<Jet>(h.data(), u, image_scale_);
  Eigen::Matrix2d J;
  for (int i = 0; i < 2; ++i) J.row(i) = image(i).v.transpose() / track_scale_;
  return J;
}

TrackCamera::ParameterJacobian TrackCamera::J_image_parameters(const Eigen::Vector2d& track) const noexcept {
  using Jet = ceres::Jet<double, kParameters>;
  Eigen::Matrix<Jet, kParameters, 1> h;
  for (int i = 0; i < kParameters; ++i) h(i) = Jet(parameters_(i), i);
  const Eigen::Vector2d n = normalised(track);
  const Eigen::Matrix<Jet, 2, 1> image =
      project<Jet>(h.data(), Eigen::Matrix<Jet, 2, 1>(Jet(n(0)), Jet(n(1))), image_scale_);
  ParameterJacobian J;
  for (int i = 0; i < 2; ++i) J.row(i) = image(i).v.transpose();
  return J;
}

}  // namespace veridyn::camera
