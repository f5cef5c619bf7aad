#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace veridyn::camera {

/// How a camera sees the plane of the track: a homography of the image that the lens would show without distortion, and
/// radial distortion about a centre.
///
/// Track: x, y on the plane [m], z up. Image: x to the right, y down [px], the middle of the first pixel is (0, 0).
/// With u = (p - track_centre) / track_scale for a point p of the track that is seen at `image`,
///     q = c + (image - c) (1 + k1 r^2 + k2 r^4),   r = |image - c| / image_scale     without distortion [px]
///     q = (h0 u + h1 v + h2, h3 u + h4 v + h5) / (h6 u + h7 v + 1)
/// (Hartley & Zisserman, Multiple View Geometry, 2004, eq. 2.2 and 7.6). The polynomial takes the distortion out of
/// what was seen; the other way about, with as many terms, follows wide-angle lenses less well. The scales only make
/// the numbers of order one.
class TrackCamera {
 public:
  static constexpr int kParameters = 12;
  /// h0 ... h5 [px], h6, h7 [-], centre x, y [px], k1, k2 [-].
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  using ParameterJacobian = Eigen::Matrix<double, 2, kParameters>;

  TrackCamera() = default;
  /// @throws InputError("camera", ...) unless all numbers are finite, the scales are > 0 and the homography can be
  /// inverted.
  TrackCamera(const Parameters& parameters, const Eigen::Vector2d& track_centre, double track_scale,
              double image_scale);

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const Eigen::Vector2d& track_centre() const noexcept { return track_centre_; }
  [[nodiscard]] double track_scale() const noexcept { return track_scale_; }
  [[nodiscard]] double image_scale() const noexcept { return image_scale_; }

  /// Where a point of the track [m] is in the image [px]: the distortion is inverted by Newton's method to rounding.
  /// Nothing behind the camera, where the distortion folds back, and for what is not finite. Does not throw or
  /// allocate.
  [[nodiscard]] std::optional<Eigen::Vector2d> to_image(const Eigen::Vector2d& track) const noexcept;
  /// Where a point of the image [px] is on the track [m]. Nothing where no point of the track is seen there: beyond the
  /// horizon, and where the distortion folds back. Does not throw or allocate.
  [[nodiscard]] std::optional<Eigen::Vector2d> to_track(const Eigen::Vector2d& image) const noexcept;
  /// d image / d track [px/m] at a point of the track that `to_image` knows.
  [[nodiscard]] Eigen::Matrix2d J_image_track(const Eigen::Vector2d& track) const noexcept;
  /// d image / d parameters at a point of the track that `to_image` knows.
  [[nodiscard]] ParameterJacobian J_image_parameters(const Eigen::Vector2d& track) const noexcept;

  /// Radius [px] about the centre in the image beyond which the distortion folds back; infinite where it never does:
  /// the smallest root of 1 + 3 k1 r^2 + 5 k2 r^4.
  [[nodiscard]] double folding_radius() const noexcept;

  /// A normalised point u as `to_image` maps it, without the checks, for doubles and for ceres::Jet; `h` are the
  /// parameters. NaN where the distortion folds back.
  template <typename Scalar>
  static Eigen::Matrix<Scalar, 2, 1> project(const Scalar* h, const Eigen::Matrix<Scalar, 2, 1>& u, double image_scale);

 private:
  [[nodiscard]] Eigen::Vector2d normalised(const Eigen::Vector2d& track) const noexcept {
    return (track - track_centre_) / track_scale_;
  }

  Parameters parameters_ = Parameters::Zero();
  Eigen::Vector2d track_centre_ = Eigen::Vector2d::Zero();
  double track_scale_ = 1.0, image_scale_ = 1.0;
  Eigen::Matrix3d back_ = Eigen::Matrix3d::Identity();  ///< inverse homography
  double folding_ = 0.0;                                ///< in units of image_scale
};

namespace internal {

/// g with g + k1 s g^3 + k2 s^2 g^5 = 1: the radius in the image over that without distortion, of which s is the
/// square. NaN where the distortion folds back before. `fold` as `fold_of`.
[[nodiscard]] double distorted_share(double s, double k1, double k2, double fold) noexcept;
/// The smallest r > 0 with 1 + 3 k1 r^2 + 5 k2 r^4 = 0; infinite where there is none.
[[nodiscard]] double fold_of(double k1, double k2) noexcept;

inline double value_of(double x) noexcept { return x; }
template <typename Jet>
double value_of(const Jet& x) noexcept {
  return x.a;
}

}  // namespace internal

template <typename Scalar>
Eigen::Matrix<Scalar, 2, 1> TrackCamera::project(const Scalar* h, const Eigen::Matrix<Scalar, 2, 1>& u,
                                                 double image_scale) {
  using Vector = Eigen::Matrix<Scalar, 2, 1>;
  using internal::value_of;
  const Scalar w = h[6] * u(0) + h[7] * u(1) + Scalar(1.0);
  const Vector q((h[0] * u(0) + h[1] * u(1) + h[2]) / w, (h[3] * u(0) + h[4] * u(1) + h[5]) / w);
  const Vector centre(h[8], h[9]);
  const Vector d = q - centre;
  const Scalar s = d.squaredNorm() / Scalar(image_scale * image_scale);
  const Scalar &k1 = h[10], &k2 = h[11];
  const double v1 = value_of(k1), v2 = value_of(k2);
  const double g = internal::distorted_share(value_of(s), v1, v2, internal::fold_of(v1, v2));
  // One more step of Newton's method in the scalar's own arithmetic brings the derivatives.
  const double g2 = g * g;
  const Scalar error = (s * (k1 + k2 * s * g2) * g2 + Scalar(1.0)) * g - Scalar(1.0);
  const Scalar slope = s * (Scalar(3.0) * k1 + Scalar(5.0) * k2 * s * g2) * g2 + Scalar(1.0);
  return centre + d * (g - error / slope);
}

}  // namespace veridyn::camera
