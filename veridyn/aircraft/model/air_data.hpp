#pragma once

#include <cmath>

#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {

/// Airspeed [m/s], angle of attack and sideslip [rad].
template <typename Scalar>
struct AirData {
  Scalar Va{0.0};
  Scalar alpha{0.0};
  Scalar beta{0.0};
};

/// Air data from the velocity relative to the air in body axes: Va = |v|, alpha = atan2(w, u), beta = asin(v / Va). All
/// zero when the velocity is.
template <typename Scalar>
[[nodiscard]] AirData<Scalar> air_data(const numerics::Vector3<Scalar>& v_r) {
  using std::asin;
  using std::atan2;
  using std::sqrt;
  AirData<Scalar> air;
  const Scalar square = v_r.squaredNorm();
  if (!(square > Scalar(0.0))) return air;
  air.Va = sqrt(square);
  air.alpha = atan2(v_r(2), v_r(0));
  air.beta = asin(v_r(1) / air.Va);
  return air;
}

/// Velocity relative to the air in body axes: Va [cos a cos b, sin b, sin a cos b].
template <typename Scalar>
[[nodiscard]] numerics::Vector3<Scalar> air_velocity(const Scalar& Va, const Scalar& alpha, const Scalar& beta) {
  using std::cos;
  using std::sin;
  const Scalar cb = cos(beta);
  return numerics::Vector3<Scalar>(Va * cos(alpha) * cb, Va * sin(beta), Va * sin(alpha) * cb);
}

}  // namespace veridyn::aircraft
