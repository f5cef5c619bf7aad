#pragma once

#include <cmath>
#include <string_view>

namespace veridyn::aircraft {

/// 1 / (1 + e^-x) without overflow for any finite x; relative error of a few ulp in the lower tail.
template <typename Scalar>
[[nodiscard]] Scalar logistic(const Scalar& x) {
  using std::exp;
  const Scalar one(1.0);
  if (x < Scalar(0.0)) {
    const Scalar e = exp(x);
    return e / (one + e);
  }
  return one / (one + exp(-x));
}

/// The share of separated flow at angle of attack `alpha` [rad], 0 between -alpha0 and alpha0, 1 far outside (Beard &
/// McLain 2012, eq. 4.10): s = (1 + e1 + e2) / ((1 + e1)(1 + e2)), e1 = e^(-M(alpha - alpha0)), e2 = e^(M(alpha +
/// alpha0)).
///
/// Computed as A + B - A B with A = logistic(M(alpha - alpha0)), B = logistic(-M(alpha + alpha0)), which is the same
/// and neither overflows nor cancels where s is tiny. `sharpness` is M [1/rad].
template <typename Scalar>
[[nodiscard]] Scalar separated_share(const Scalar& alpha, double sharpness, double alpha0) {
  const Scalar a = logistic(Scalar(Scalar(sharpness) * (alpha - Scalar(alpha0))));
  const Scalar b = logistic(Scalar(Scalar(-sharpness) * (alpha + Scalar(alpha0))));
  return a + b - a * b;
}

/// 1 - separated_share without cancellation where hardly any flow is attached.
template <typename Scalar>
[[nodiscard]] Scalar attached_share(const Scalar& alpha, double sharpness, double alpha0) {
  return logistic(Scalar(Scalar(-sharpness) * (alpha - Scalar(alpha0)))) *
         logistic(Scalar(Scalar(sharpness) * (alpha + Scalar(alpha0))));
}

/// Lift coefficient of a flat plate in separated flow: 2 sign(alpha) sin^2(alpha) cos(alpha).
template <typename Scalar>
[[nodiscard]] Scalar flat_plate_lift(const Scalar& alpha) {
  using std::cos;
  using std::sin;
  const Scalar s = sin(alpha);
  const Scalar lift = Scalar(2.0) * s * s * cos(alpha);
  return alpha < Scalar(0.0) ? Scalar(-lift) : lift;
}

/// Drag coefficient of a flat plate in separated flow: 2 sin^2(alpha).
template <typename Scalar>
[[nodiscard]] Scalar flat_plate_drag(const Scalar& alpha) {
  using std::sin;
  const Scalar s = sin(alpha);
  return Scalar(2.0) * s * s;
}

/// What the wing's linear lift turns into beyond stall.
enum class StallForm {
  kFull,        ///< (1-s) CL_lin + s CL_plate with every term of CL in CL_lin; drag likewise
  kSource,      ///< only CL_0 + CL_alpha alpha and CD_0 + CD_alpha alpha are blended, the other terms are added whole
  kSeparation,  ///< Kirchhoff's wing: CL_0 + CL_alpha alpha times ((1 + sqrt(1 - s)) / 2)^2; drag keeps its terms
};
/// "full", as in a study.
[[nodiscard]] std::string_view name_of(StallForm form);

/// How a model behaves beyond stall. Without it the terms hold at every angle of attack.
///
/// The flat plate does not fit every wing (the UltraStick 120's tunnel data keep CL at 1.0 out to 42 deg). Alternatives
/// are `kSeparation`, which levels off at a quarter of the linear lift, and spline terms such as
/// `spline(alpha, 12 deg, 2)`, which need no blend at all.
struct StallBlend {
  double M = 50.0;       ///< sharpness [1/rad]
  double alpha0 = 0.47;  ///< angle of attack where half of the flow is separated [rad]
  StallForm form = StallForm::kFull;
  bool drag = true;  ///< whether drag is blended as well (the last_letter tables with a drag parabola do not)

  friend bool operator==(const StallBlend&, const StallBlend&) = default;
};

}  // namespace veridyn::aircraft
