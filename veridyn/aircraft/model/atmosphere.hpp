#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

/// Sea-level density of the standard atmosphere [kg/m^3].
inline constexpr double kSeaLevelDensity = 1.225;

/// State of the air.
template <typename Scalar>
struct Air {
  Scalar temperature;  ///< [K]
  Scalar pressure;     ///< [Pa]
  Scalar density;      ///< [kg/m^3]
};

/// International Standard Atmosphere (ISO 2533) at a geopotential altitude [m], from -5 km to 20 km: temperature falls
/// by 6.5 K/km to 11 km, then stays at 216.65 K. Outside, the nearest layer's formula goes on.
///
/// Check: 5000 m gives 255.65 K, 54019.9 Pa, 0.736116 kg/m^3.
template <typename Scalar>
[[nodiscard]] Air<Scalar> standard_atmosphere(const Scalar& altitude) {
  using std::exp;
  using std::pow;
  constexpr double kR = 287.05287, kT0 = 288.15, kP0 = 101325.0, kLapse = 0.0065, kTropopause = 11000.0;
  constexpr double kExponent = kGravity / (kR * kLapse);
  Air<Scalar> air;
  if (altitude < Scalar(kTropopause)) {
    air.temperature = Scalar(kT0) - Scalar(kLapse) * altitude;
    air.pressure = Scalar(kP0) * pow(air.temperature / Scalar(kT0), kExponent);
  } else {
    const double T11 = kT0 - kLapse * kTropopause;
    const double p11 = kP0 * std::pow(T11 / kT0, kExponent);
    air.temperature = Scalar(T11);
    air.pressure = Scalar(p11) * exp(Scalar(-kGravity / (kR * T11)) * (altitude - Scalar(kTropopause)));
  }
  air.density = air.pressure / (Scalar(kR) * air.temperature);
  return air;
}

}  // namespace veridyn::aircraft
