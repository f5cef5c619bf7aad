#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Method;
using estimation::RegressionData;
using estimation::RegressionEstimate;

/// Influence of every row on the first two parameters of an estimate: theta_hat - theta = sum of rows.
Eigen::MatrixXd influence(const RegressionData& data, const RegressionEstimate& estimate) {
  const auto n = data.parameters();
  Eigen::MatrixXd W = data.error_covariance;
  Eigen::MatrixXd M = data.regressors.transpose() * data.regressors;
  if (estimate.method == Method::kOls) {
    W.setZero();
    W(n, n) = 1.0;
  } else {
    M -= static_cast<double>(data.rows()) * W.topLeftCorner(n, n);
    // All of the residual is variance of W's combination.
    Eigen::VectorXd h(n + 1);
    h << estimate.theta, -1.0;
    const double beyond = estimate.residual_sd * estimate.residual_sd - h.dot(W * h);
    W(n, n) += std::max(0.0, beyond);
  }
  const estimation::RowMatrix scores =
      estimation::errors_in_variables_scores(data.regressors, data.regressand, W, estimate.theta,
                                             estimation::ErrorRatio::kKnown)
          .rows();
  const Eigen::VectorXd scale = data.regressors.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
  const Eigen::MatrixXd all =
      scale.asDiagonal() * numerics::solve_linear(scaled, Eigen::MatrixXd(scale.asDiagonal() * scores.transpose()));
  return all.topRows(2).transpose();
}

/// The four coefficients' covariance: what each regression gives for its two, and the correlation between the two
/// regressions from their scores over the same rows.
Eigen::Matrix4d joint_covariance(const DriveRegressions& data, const RegressionEstimate& first,
                                 const RegressionEstimate& second) {
  estimation::RowMatrix both(data.first.rows(), 4);
  both << influence(data.first, first), influence(data.second, second);
  const auto segments = estimation::segment_ranges(data.first.rows(), data.first.segment);
  const Eigen::Index window = std::max(first.lag_window, second.lag_window);
  const Eigen::Matrix4d S = estimation::long_run_covariance(both, segments, window).matrix;
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  P.topLeftCorner<2, 2>() = first.covariance.topLeftCorner(2, 2);
  P.bottomRightCorner<2, 2>() = second.covariance.topLeftCorner(2, 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (Eigen::Index j = 2; j < 4; ++j) {
      const double norm = std::sqrt(S(i, i) * S(j, j));
      if (!(norm > 0.0)) continue;
      P(i, j) = P(j, i) = std::clamp(S(i, j) / norm, -0.99, 0.99) * std::sqrt(P(i, i) * P(j, j));
    }
  }
  // Corners from two sources may together be indefinite: then their correlation is taken down.
  for (double share = 1.0; share > 0.05; share *= 0.8) {
    Eigen::Matrix4d Q = P;
    Q.topRightCorner<2, 2>() *= share;
    Q.bottomLeftCorner<2, 2>() *= share;
    const Eigen::Vector4d scale = Q.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    if (numerics::PivotedCholesky(scale.asDiagonal() * Q * scale.asDiagonal()).smallest_pivot() > 1e-6) return Q;
  }
  P.topRightCorner<2, 2>().setZero();
  P.bottomLeftCorner<2, 2>().setZero();
  return P;
}

/// The four coefficients of the regressions, and their derivatives with respect to C_f, C_r and I_z.
struct BicycleCoefficients {
  Eigen::Vector4d value;
  Eigen::Matrix<double, 4, 3> slope;
};

/// Those of the bicycle with x = (C_f, C_r, I_z).
BicycleCoefficients coefficients(const Eigen::Vector3d& x, const VehicleParameters<double>& p, bool direct) {
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  const double C_f = x(0), C_r = x(1), I = x(2);
  BicycleCoefficients out;
  Eigen::Vector4d& f = out.value;
  Eigen::Matrix<double, 4, 3>& J = out.slope;
  if (direct) {
    f << 2.0 * C_f / m, 2.0 * C_r / m, 2.0 * a * C_f / I, -2.0 * b * C_r / I;
    J << 2.0 / m, 0.0, 0.0,           //
        0.0, 2.0 / m, 0.0,            //
        2.0 * a / I, 0.0, -f(2) / I,  //
        0.0, -2.0 * b / I, -f(3) / I;
    return out;
  }
  const double g_f = 0.5 / (L * C_f), g_r = 0.5 / (L * C_r);
  f << m * (b * g_f - a * g_r), I * (g_f + g_r), m * a * g_r, I * g_r;
  J << -m * b * g_f / C_f, m * a * g_r / C_r, 0.0,  //
      -I * g_f / C_f, -I * g_r / C_r, g_f + g_r,    //
      0.0, -m * a * g_r / C_r, 0.0,                 //
      0.0, -I * g_r / C_r, g_r;
  return out;
}

/// A bicycle (C_f, C_r, I_z) from coefficients, exact where they are consistent.
Eigen::Vector3d bicycle_of(const Eigen::Vector4d& theta, const VehicleParameters<double>& p, bool direct) {
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  if (direct)
    return {0.5 * m * theta(0), 0.5 * m * theta(1), 0.5 * m * (a * theta(0) / theta(2) - b * theta(1) / theta(3))};
  const double g_r = theta(2) / (m * a), g_f = (theta(0) + theta(2)) / (m * b);
  return {0.5 / (L * g_f), 0.5 / (L * g_r), theta(3) / g_r};
}

/// The bicycle nearest to four coefficients under their covariance.
struct NearestBicycle {
  Eigen::Vector3d value;       ///< C_f, C_r, I_z
  Eigen::Matrix3d covariance;  ///< of value
  double chi_square = 0.0;     ///< of what the coefficients are off by, small angles allowed for
};

/// By Gauss-Newton from `start`, in units of it; the consistency equation is one, so few steps.
NearestBicycle nearest_bicycle(const Eigen::Vector4d& theta, const Eigen::Matrix4d& P, const Eigen::Vector3d& start,
                               const VehicleParameters<double>& p, bool direct) {
  const Eigen::Vector4d scale = P.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const numerics::PivotedCholesky factor(scale.asDiagonal() * P * scale.asDiagonal());
  Eigen::Vector3d x = start;
  Eigen::Matrix3d normal;
  for (int step = 0; step < 30; ++step) {
    const BicycleCoefficients at = coefficients(x, p, direct);
    const Eigen::Matrix<double, 4, 3> A = scale.asDiagonal() * at.slope * start.asDiagonal();
    const Eigen::Vector4d e = scale.asDiagonal() * (theta - at.value);
    normal = A.transpose() * factor.solve(Eigen::MatrixXd(A));
    const Eigen::Vector3d move =
        numerics::solve_symmetric(normal, Eigen::VectorXd(A.transpose() * factor.solve(Eigen::VectorXd(e))));
    Eigen::Vector3d next = x + start.cwiseProduct(move);
    for (int halving = 0; halving < 20 && !(next.minCoeff() > 0.0); ++halving) next = 0.5 * (next + x);
    const double moved = (next - x).cwiseQuotient(start).cwiseAbs().maxCoeff();
    x = next;
    if (moved < 1e-12) break;
  }
  const Eigen::Vector4d e = scale.asDiagonal() * (theta - coefficients(x, p, direct).value);
  // The error of the small angles is no contradiction.
  const Eigen::Vector4d small_angles =
      kSmallAngleError * Eigen::Vector4d(direct ? theta(0) : theta(2), theta(1), theta(2), theta(3));
  Eigen::Matrix4d widened = P;
  widened.diagonal() += small_angles.cwiseAbs2();
  const numerics::PivotedCholesky allowed(scale.asDiagonal() * widened * scale.asDiagonal());
  return {x, start.asDiagonal() * normal.inverse() * start.asDiagonal(), e.dot(allowed.solve(Eigen::VectorXd(e)))};
}

/// What (1) alone determines: the understeer gradient and the steer bias.
AxleEstimate understeer_of(const DriveRegressions& data, const RegressionEstimate& first) {
  AxleEstimate out;
  out.method = first.method;
  out.covariance.setConstant(kInfinity);
  out.understeer_sigma = out.steer_bias_sigma = kInfinity;
  if (!first.usable() || data.direct) return out;
  out.understeer = first.theta(0);
  out.understeer_sigma = std::sqrt(first.covariance(0, 0));
  out.steer_bias = first.theta(2);
  out.steer_bias_sigma = std::sqrt(first.covariance(2, 2));
  out.understeer_only = true;
  out.degrees_of_freedom = first.degrees_of_freedom;
  return out;
}

AxleEstimate axles_of(const DriveRegressions& data, const RegressionEstimate& first, const RegressionEstimate& second,
                      const VehicleParameters<double>& p) {
  AxleEstimate out = understeer_of(data, first);
  if (!first.usable() || !second.usable()) {
    out.message = first.usable() ? second.message : first.message;
    return out;
  }
  const auto unexcited = [](const RegressionEstimate& e) {
    return std::max(e.parameters[0].unexcited_share, e.parameters[1].unexcited_share) > 0.05;
  };
  Eigen::Vector4d theta;
  theta << first.theta.head(2), second.theta.head(2);
  const Eigen::Vector3d start = bicycle_of(theta, p, data.direct);
  if (unexcited(first) || unexcited(second)) {
    out.message = fmt::format("not excited: {}{}{}", first.unexcited.empty() ? "" : first.unexcited[0].text,
                              first.unexcited.empty() || second.unexcited.empty() ? "" : ", ",
                              second.unexcited.empty() ? "" : second.unexcited[0].text);
    return out;
  }
  if (!(start.minCoeff() > 0.0) || !start.allFinite()) {
    out.message =
        fmt::format("gives C_f = {:.4g}, C_r = {:.4g}, I_z = {:.4g}: none of a vehicle", start(0), start(1), start(2));
    return out;
  }
  const NearestBicycle nearest = nearest_bicycle(theta, joint_covariance(data, first, second), start, p, data.direct);
  const Eigen::Vector3d& x = nearest.value;
  out.value = x;
  out.covariance = nearest.covariance;
  out.consistency_p =
      std::isfinite(nearest.chi_square) ? numerics::chi_square_upper_p(std::max(0.0, nearest.chi_square), 1.0) : 0.0;
  out.degrees_of_freedom = std::min(first.degrees_of_freedom, second.degrees_of_freedom);
  out.usable = x.allFinite() && x.minCoeff() > 0.0 && out.covariance.allFinite();
  out.understeer_only = false;
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  const Eigen::Vector3d slope(-0.5 * m * b / (L * x(0) * x(0)), 0.5 * m * a / (L * x(1) * x(1)), 0.0);
  out.understeer = 0.5 * m / L * (b / x(0) - a / x(1));
  out.understeer_sigma = std::sqrt(slope.dot(out.covariance * slope));
  out.message = fmt::format("{} over {} rows", estimation::to_string(out.method), data.first.rows());
  return out;
}

}  // namespace

const AxleEstimate* DriveRegressionResult::find(Method method) const {
  for (const AxleEstimate& e : axles) {
    if (e.method == method) return &e;
  }
  return nullptr;
}

DriveRegressionResult equation_error(DriveRegressions data, const VehicleParameters<double>& known,
                                     const estimation::RegressionOptions& options) {
  DriveRegressionResult out;
  out.data = std::move(data);
  const auto least = 10 * (out.data.first.parameters() + out.data.second.parameters());
  if (out.data.first.rows() < least) {
    out.reason = fmt::format("{} rows are left within the segments, {} are needed", out.data.first.rows(), least);
    return out;
  }
  out.first = estimation::compare(out.data.first, options);
  out.second = estimation::compare(out.data.second, options);
  for (const RegressionEstimate& first : out.first.estimates) {
    const RegressionEstimate* second = out.second.find(first.method);
    if (second != nullptr) out.axles.push_back(axles_of(out.data, first, *second, known));
  }
  out.recommends = out.first.recommends && out.second.recommends;
  if (out.recommends)
    out.recommended = out.first.recommended == out.second.recommended ? out.first.recommended : Method::kGtls;
  out.reason = out.first.recommends ? out.second.reason : out.first.reason;
  return out;
}

}  // namespace veridyn::vehicle
