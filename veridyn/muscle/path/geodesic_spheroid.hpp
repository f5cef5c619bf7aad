#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "veridyn/muscle/model/scalar.hpp"

/// Geodesics of a spheroid (radii A, A, B) by Bessel's auxiliary sphere; Karney (2013), J. Geodesy 87:43 describes it.
///
/// In coordinates y = x / a the spheroid is the unit sphere, and a geodesic is a great circle there whose longitude is
/// stretched: y(sigma) = R_z(delta) (y1 cos sigma + tau1 sin sigma). With z the height on that circle, e = 1 - B^2/A^2,
/// W = sqrt(1 - e (1 - z^2)) and Clairaut's constant c = rho sin(azimuth) / A,
///
///     ds/dsigma = A W,   ddelta/dsigma = -e c / (1 + W),
///
/// smooth integrands along a given arc, for Gauss-Legendre quadrature: no step depends on the one before it. The
/// deviation J of neighbouring geodesics is a sum of two known ones: z', from turning about the axis, and
/// W z - z' I with I = int e z^2 / W dsigma, from varying c.
namespace veridyn::muscle::internal {

/// Which axis of an ellipsoid is one of revolution.
struct Spheroid {
  int axis = -1;  ///< -1: none
  double equator = 0.0;
  double eccentricity2 = 0.0;  ///< 1 - B^2/A^2; negative: prolate
  double panel = 0.0;          ///< half-width of a panel of the quadrature [rad of sigma]
};

inline Spheroid spheroid(const Eigen::Vector3d& a) {
  Spheroid s;
  for (int k = 0; k < 3; ++k)
    if (a[(k + 1) % 3] == a[(k + 2) % 3]) s.axis = k;
  if (s.axis < 0) return s;
  s.equator = a[(s.axis + 1) % 3];
  const double ratio = a[s.axis] / s.equator;
  s.eccentricity2 = 1.0 - ratio * ratio;
  // W vanishes at this distance from the real axis of sigma (bounded from below: acosh and asinh); with eight points a
  // panel of half-width w leaves an error of (d/w + sqrt(1 + d^2/w^2))^-16, 1e-9 for d/w = 1.7, and a small factor.
  double distance = 10.0;
  if (s.eccentricity2 < 0.0) {
    const double x = std::min(3.0, ratio / std::sqrt(-s.eccentricity2)) - 1.0;
    distance = std::sqrt(2.0 * x) * (1.0 - x / 12.0);
  } else if (s.eccentricity2 > 0.0) {
    distance = ratio;  // y / sqrt(1 + y^2) with y = ratio / sqrt(e)
  }
  s.panel = std::min(0.7, distance / 1.7);
  return s;
}

/// Where a geodesic arrives.
template <typename Scalar>
struct SpheroidArrival {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 position, direction;
  Scalar length;  ///< of the arc
  Scalar speed;   ///< d length / d sigma at its end
  Scalar jacobi, jacobi_slope;
};

/// Integrals over sigma along the great circle of the auxiliary sphere that starts at height z1 with slope v1 =
/// dz/dsigma, and the end of that arc.
template <typename Scalar>
struct SpheroidIntegrals {
  Scalar length;        ///< of W
  Scalar turn;          ///< of 1/(1 + W)
  Scalar deviation;     ///< of z^2/W
  Scalar cosine, sine;  ///< of `sigma`
};

template <typename Scalar>
SpheroidIntegrals<Scalar> spheroid_integrals(const Spheroid& s, const Scalar& z1, const Scalar& v1,
                                             const Scalar& sigma) {
  using std::cos;
  using std::sin;
  using Points = Eigen::Array<Scalar, 4, 1>;
  const double e = s.eccentricity2;
  // Gauss-Legendre points in pairs about the middle of a panel.
  const double panels = 1.0 + std::floor(std::abs(value_of(sigma)) / (2.0 * s.panel));
  const Scalar half = sigma * (0.5 / panels);
  const Eigen::Array4d point(0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623);
  const Eigen::Array4d point_weight(0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626);
  const Points x = point.cast<Scalar>() * half;
  const Points xx = x * x;
  const auto c = [](double v) { return Scalar(v); };
  const Points sine =
      x *
      (((((xx * c(1.0 / 6227020800.0) - c(1.0 / 39916800.0)) * xx + c(1.0 / 362880.0)) * xx - c(1.0 / 5040.0)) * xx +
        c(1.0 / 120.0)) *
           xx * xx -
       xx * c(1.0 / 6.0) + c(1.0));
  const Points cosine =
      (((((xx * c(1.0 / 479001600.0) - c(1.0 / 3628800.0)) * xx + c(1.0 / 40320.0)) * xx - c(1.0 / 720.0)) * xx +
        c(1.0 / 24.0)) *
           xx -
       c(0.5)) *
          xx +
      c(1.0);
  const Scalar cos_half = cos(half), sin_half = sin(half);
  const Scalar cos_panel = cos_half * cos_half - sin_half * sin_half;
  const Scalar sin_panel = Scalar(2.0) * sin_half * cos_half;
  Scalar cos_mid = cos_half, sin_mid = sin_half;
  Points sum_length = Points::Constant(c(0.0)), sum_turn = sum_length, sum_deviation = sum_length;
  for (double panel = 1.0;; panel += 1.0) {
    const Scalar z_mid = z1 * cos_mid + v1 * sin_mid;
    const Scalar v_mid = v1 * cos_mid - z1 * sin_mid;
    const Points even = cosine * z_mid, odd = sine * v_mid;
    const Points za = even + odd, zb = even - odd;
    const Points za2 = za * za, zb2 = zb * zb;
    const Points wa = (za2 * c(e) + c(1.0 - e)).sqrt(), wb = (zb2 * c(e) + c(1.0 - e)).sqrt();
    const Points sum = wa + wb, product = wa * wb;
    sum_length += sum;
    sum_turn += (sum + c(2.0)) / (product + sum + c(1.0));
    sum_deviation += (za2 * wb + zb2 * wa) / product;
    if (panel >= panels) break;
    const Scalar was = cos_mid;
    cos_mid = cos_mid * cos_panel - sin_mid * sin_panel;
    sin_mid = sin_mid * cos_panel + was * sin_panel;
  }
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): a copy for derivatives, a reference for double
  const Points weight = point_weight.cast<Scalar>();
  return {(sum_length * weight).sum() * half, (sum_turn * weight).sum() * half, (sum_deviation * weight).sum() * half,
          cos_mid * cos_half - sin_mid * sin_half, sin_mid * cos_half + cos_mid * sin_half};
}

/// From r1 (on the surface) along the unit tangent t1, `sigma` on the auxiliary sphere. `jacobi`: J at r1, where
/// dJ/ds = 1.
template <typename Scalar>
SpheroidArrival<Scalar> spheroid_geodesic(const Spheroid& s, const Eigen::Vector3d& a,
                                          const Eigen::Matrix<Scalar, 3, 1>& r1, const Eigen::Matrix<Scalar, 3, 1>& t1,
                                          const Scalar& jacobi, const Scalar& sigma) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const int k = s.axis, i = (k + 1) % 3, j = (k + 2) % 3;
  const double e = s.eccentricity2, equator = s.equator;
  const auto stretch = [&](const Scalar& z2) { return Scalar(1.0 - e) + z2 * e; };
  const Vector3 inverse = a.cwiseInverse().cast<Scalar>();
  const Vector3 y1 = r1.cwiseProduct(inverse);
  const Scalar w1 = sqrt(stretch(y1[k] * y1[k]));
  const Scalar clairaut = (r1[i] * t1[j] - r1[j] * t1[i]) * (1.0 / equator);
  const Scalar turn1 = clairaut * (-e) / (Scalar(1.0) + w1);
  Vector3 tau1 = t1.cwiseProduct(inverse) * (w1 * equator);
  tau1[i] += turn1 * y1[j];
  tau1[j] -= turn1 * y1[i];
  const Scalar &z1 = y1[k], &v1 = tau1[k];

  const SpheroidIntegrals<Scalar> integrals = spheroid_integrals<Scalar>(s, z1, v1, sigma);
  const Scalar turn = integrals.turn * clairaut * (-e);
  const Scalar deviation = integrals.deviation * e;
  const Scalar &cos_sigma = integrals.cosine, &sin_sigma = integrals.sine;
  const Vector3 y2 = y1 * cos_sigma + tau1 * sin_sigma;
  const Vector3 tau2 = tau1 * cos_sigma - y1 * sin_sigma;
  const Scalar &z2 = y2[k], &v2 = tau2[k];
  const Scalar w2 = sqrt(stretch(z2 * z2));
  const Scalar turn2 = clairaut * (-e) / (Scalar(1.0) + w2);
  const Scalar cos_turn = cos(turn), sin_turn = sin(turn);
  SpheroidArrival<Scalar> arrival;
  arrival.length = integrals.length * equator;
  arrival.speed = w2 * equator;
  const Scalar ax = y2[i] * cos_turn - y2[j] * sin_turn, ay = y2[j] * cos_turn + y2[i] * sin_turn;
  const Scalar bx = tau2[i] * cos_turn - tau2[j] * sin_turn, by = tau2[j] * cos_turn + tau2[i] * sin_turn;
  const Scalar per_speed = Scalar(1.0) / w2;  // equator radius cancels, but along the axis
  arrival.position[i] = ax * equator;
  arrival.position[j] = ay * equator;
  arrival.position[k] = z2 * a[k];
  arrival.direction[i] = (bx - turn2 * ay) * per_speed;
  arrival.direction[j] = (by + turn2 * ax) * per_speed;
  arrival.direction[k] = v2 * per_speed * (a[k] / equator);

  // Everything over h^2 = z^2 + z'^2 stays bounded as h goes to zero along the equator.
  const Scalar per_h2 = Scalar(1.0) / (z1 * z1 + v1 * v1 + Scalar(1e-100));
  const Scalar change = (z2 * z2 - z1 * z1) * per_h2 * e / (w1 + w2);  // (W2 - W1) / h^2
  const Scalar l1 = jacobi / w1;
  const Scalar common = (v1 * equator + z1 * l1) * (deviation * per_h2);
  const Scalar both = z1 * l1 + v1 * equator;
  arrival.jacobi = jacobi * cos_sigma + w1 * sin_sigma * equator + change * z2 * both - common * v2;
  arrival.jacobi_slope =
      (w1 * cos_sigma * equator - jacobi * sin_sigma + change * v2 * both + common * z2) / arrival.speed;
  return arrival;
}

// In muscle_path_evaluation.cpp.
extern template SpheroidArrival<double> spheroid_geodesic<double>(const Spheroid&, const Eigen::Vector3d&,
                                                                  const Eigen::Vector3d&, const Eigen::Vector3d&,
                                                                  const double&, const double&);

}  // namespace veridyn::muscle::internal
