#include "veridyn/camera/calibration/fit_camera.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "veridyn/camera/calibration/calibration_checks.hpp"
#include "veridyn/camera/calibration/homography.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::camera {
namespace {

constexpr int kHomography = 8;

/// Where the camera maps a point, minus where it was seen [px].
struct ImageError {
  Eigen::Vector2d u, image;
  double image_scale;
  template <typename Scalar>
  bool operator()(const Scalar* h, Scalar* error) const {
    const Eigen::Matrix<Scalar, 2, 1> mapped = TrackCamera::project<Scalar>(h, u.cast<Scalar>().eval(), image_scale);
    error[0] = mapped(0) - image(0);
    error[1] = mapped(1) - image(1);
    return true;
  }
};

/// The fitted parameters, and their sum of squares.
struct Fitted {
  TrackCamera::Parameters parameters;
  double squares = 0.0;
  bool converged = false;
};

Fitted least_squares(const CalibrationPoints& points, const PointScaling& track, double image_scale,
                     TrackCamera::Parameters start, bool distorted) {
  ceres::Problem problem;
  problem.AddParameterBlock(start.data(), TrackCamera::kParameters);
  if (!distorted) {
    problem.SetManifold(start.data(), new ceres::SubsetManifold(TrackCamera::kParameters, {8, 9, 10, 11}));
  }
  for (const CalibrationPoint& p : points.points) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ImageError, 2, TrackCamera::kParameters>(
                                 new ImageError{(p.track - track.mean) / track.scale, p.image, image_scale}),
                             nullptr, start.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-13;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {start, 2.0 * summary.final_cost, summary.termination_type == ceres::CONVERGENCE};
}

/// P(F > f) that four more parameters bring the sum of squares from `without` to `with` by chance: the incomplete beta
/// function, which for four degrees of freedom above is x^a (1 + a (1 - x)), x = with / without, a = dof / 2
/// (Abramowitz & Stegun 26.6.4).
double chance_of_four_more(double without, double with, double dof) {
  const double x = without > 0.0 ? std::clamp(with / without, 0.0, 1.0) : 1.0, a = 0.5 * dof;
  return std::pow(x, a) * (1.0 + a * (1.0 - x));
}

void check_fold(const TrackCamera& camera, const CalibrationPoints& points) {
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    if (!camera.to_image(points.points[i].track))
      throw InputError(points.place(i),
                       fmt::format("the fitted distortion folds back {:.0f} px from its centre, before this point, "
                                   "which no lens does: is the point wrong, or are the points too few or too close "
                                   "together for a distortion?",
                                   camera.folding_radius()));
  }
}

void add_covariance(Calibration& c, const CalibrationPoints& points) {
  const int fitted = c.distorted ? TrackCamera::kParameters : kHomography;
  const Eigen::Index rows = 2 * signed_index(points.points.size());
  const double dof = static_cast<double>(rows - fitted);
  double squares = 0.0;
  for (const CalibrationResidual& r : c.residuals) squares += r.image.squaredNorm();
  c.sigma_image = dof > 0.0 ? std::sqrt(squares / dof) : kNaN;
  Eigen::MatrixXd J(rows, fitted);
  for (std::size_t i = 0; i < points.points.size(); ++i)
    J.middleRows<2>(2 * signed_index(i)) = c.camera.J_image_parameters(points.points[i].track).leftCols(fitted);
  const Eigen::VectorXd scale = J.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  J = J * scale.asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(fitted, fitted);
  const Eigen::MatrixXd back = scale.asDiagonal() * numerics::solve_upper(numerics::HouseholderQr(J).R(), identity);
  c.covariance.setZero();
  c.covariance.topLeftCorner(fitted, fitted) = c.sigma_image * c.sigma_image * numerics::product_transposed(back, back);
}

}  // namespace

Eigen::Matrix2d Calibration::track_covariance(const Eigen::Vector2d& track, const Eigen::Matrix2d& image) const {
  // image = f(track, parameters): d track = J^-1 (d image - J_parameters d parameters)
  const Eigen::Matrix2d back = camera.J_image_track(track).inverse();
  const TrackCamera::ParameterJacobian J = camera.J_image_parameters(track);
  const Eigen::Matrix2d seen = image + J * covariance * J.transpose();
  return back * seen * back.transpose();
}

Eigen::Matrix2d Calibration::systematic_covariance(const Eigen::Vector2d& track) const {
  const Eigen::Matrix2d back = camera.J_image_track(track).inverse();
  return systematic_image * systematic_image * (back * back.transpose());
}

std::vector<CalibrationResidual> residuals_of(const TrackCamera& camera, const CalibrationPoints& points) {
  std::vector<CalibrationResidual> all;
  for (const CalibrationPoint& p : points.points) {
    const auto image = camera.to_image(p.track);
    const auto track = camera.to_track(p.image);
    CalibrationResidual r;
    r.image = image ? Eigen::Vector2d(p.image - *image) : Eigen::Vector2d::Constant(kNaN);
    r.track = track ? Eigen::Vector2d(*track - p.track) : Eigen::Vector2d::Constant(kNaN);
    all.push_back(r);
  }
  return all;
}

double rms_track(const std::vector<CalibrationResidual>& residuals) {
  double squares = 0.0;
  for (const CalibrationResidual& r : residuals) squares += r.track.squaredNorm();
  return std::sqrt(squares / static_cast<double>(residuals.size()));
}

Calibration fit_camera(const CalibrationPoints& points, Distortion distortion) {
  check_points(points);
  const std::size_t n = points.points.size();
  if (distortion == Distortion::kRadial && n < 6)
    throw InputError(points.source, fmt::format("holds {} points; a radial distortion needs at least 6", n));
  std::vector<Eigen::Vector2d> track, image;
  for (const CalibrationPoint& p : points.points) {
    track.push_back(p.track);
    image.push_back(p.image);
  }
  const PointScaling on_track = PointScaling::of(track), in_image = PointScaling::of(image);
  double image_scale = 0.0;
  for (const Eigen::Vector2d& p : image) image_scale = std::max(image_scale, (p - in_image.mean).norm());

  // In terms of u = (p - mean) / scale, with the last element 1: it is the denominator at the mean of the points.
  Eigen::Matrix3d to_plane;
  to_plane << on_track.scale, 0.0, on_track.mean(0), 0.0, on_track.scale, on_track.mean(1), 0.0, 0.0, 1.0;
  Eigen::Matrix3d H = direct_linear_homography(points) * to_plane;
  if (!(std::abs(H(2, 2)) > 1e-12 * H.norm()))
    throw InputError(points.source, "no camera sees these points so: the middle of the track is at infinity");
  H /= H(2, 2);
  TrackCamera::Parameters start;
  start << H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), H(2, 0), H(2, 1), in_image.mean, 0.0, 0.0;

  Fitted fitted = least_squares(points, on_track, image_scale, start, false);
  Calibration c;
  const double dof = 2.0 * static_cast<double>(n) - TrackCamera::kParameters;
  if (distortion == Distortion::kRadial || (distortion == Distortion::kAuto && dof > 0.0)) {
    const Fitted radial = least_squares(points, on_track, image_scale, fitted.parameters, true);
    constexpr double kByChance = 0.001;
    c.distorted =
        distortion == Distortion::kRadial || chance_of_four_more(fitted.squares, radial.squares, dof) < kByChance;
    if (c.distorted) fitted = radial;
  }
  c.camera = TrackCamera(fitted.parameters, on_track.mean, on_track.scale, image_scale);
  c.converged = fitted.converged;
  c.points = n;
  check_fold(c.camera, points);
  c.residuals = residuals_of(c.camera, points);
  double squares = 0.0;
  for (const CalibrationResidual& r : c.residuals) squares += r.image.squaredNorm();
  c.rms_image = std::sqrt(squares / static_cast<double>(n));
  c.rms_track = rms_track(c.residuals);
  add_covariance(c, points);
  const NeighbourCorrelation shared = neighbour_correlation(points, c.residuals);
  if (shared.significant() && std::isfinite(c.sigma_image))
    c.systematic_image = c.sigma_image * std::sqrt(std::clamp(shared.correlation, 0.0, 1.0));
  return c;
}

HeldOut hold_out_half(const CalibrationPoints& points, Distortion distortion, std::uint64_t seed) {
  const std::size_t n = points.points.size();
  if (n < 8)
    throw InputError(points.source, fmt::format("holds {} points; half of them fitted and half measured needs 8", n));
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  numerics::RandomStream random(seed, "calibration/held_out");
  for (std::size_t i = n - 1; i > 0; --i) std::swap(order[i], order[random.index(i + 1)]);
  CalibrationPoints first{.source = points.source, .points = {}}, second = first;
  const std::size_t half = n / 2;
  for (std::size_t i = 0; i < n; ++i) (i < half ? first : second).points.push_back(points.points[order[i]]);
  const Calibration c = fit_camera(first, distortion);
  const std::vector<CalibrationResidual> off = residuals_of(c.camera, second);
  HeldOut result{.fitted = half, .held_out = n - half, .rms_fitted = c.rms_track, .rms_held_out = rms_track(off)};
  for (std::size_t i = 0; i < off.size(); ++i) {
    const double distance = off[i].track.norm();
    if (!(distance <= result.worst)) {
      result.worst = distance;
      result.worst_point = order[half + i];
    }
  }
  return result;
}

}  // namespace veridyn::camera
