#pragma once

#include <type_traits>

/// What the muscle's curves need of their scalar beyond arithmetic: double or a dual number with the members `a`
/// (value) and `v` (derivatives), as ceres::Jet<double, N> is.
namespace veridyn::muscle {

template <typename Scalar>
concept DualNumber = requires(const Scalar& x) {
  x.a;
  x.v;
};

/// The number without its derivatives.
template <typename Scalar>
[[nodiscard]] constexpr double value_of(const Scalar& x) {
  if constexpr (DualNumber<Scalar>)
    return value_of(x.a);
  else
    return x;
}

/// f(x) for a function whose value and slope at value_of(x) are known.
template <typename Scalar>
[[nodiscard]] Scalar chain(const Scalar& x, double value, double slope) {
  if constexpr (DualNumber<Scalar>) {
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(x.a)>, double>, "first derivatives only");
    Scalar y(value);
    y.v = slope * x.v;
    return y;
  } else {
    (void)x;
    (void)slope;
    return value;
  }
}

/// A curve's value and slope at one point.
struct CurveValue {
  double value = 0.0;
  double slope = 0.0;
};

}  // namespace veridyn::muscle
