#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::vehicle {

/// How the parameters of a vehicle are estimated.
enum class VehicleMethod : std::size_t {
  kOutputError,
  kOls,  ///< equation error by ordinary least squares; so also the next three
  kTls,
  kGtls,
  kPcaGtls,
  kGiven,  ///< not found here: an estimate of a method that is none of these, which is validated
  kNone
};
/// Their names in studies and results, in the order of the enum.
inline constexpr std::array<std::string_view, 7> kVehicleMethodNames{"output error", "OLS",   "TLS", "GTLS",
                                                                     "PCA-GTLS",     "given", "none"};
/// As study files and estimates name it.
[[nodiscard]] constexpr std::string_view to_string(VehicleMethod method) {
  return kVehicleMethodNames[static_cast<std::size_t>(method)];
}

/// Equation error by one of the regressions.
[[nodiscard]] constexpr VehicleMethod vehicle_method(estimation::Method method) {
  switch (method) {
    case estimation::Method::kOls:
      return VehicleMethod::kOls;
    case estimation::Method::kTls:
      return VehicleMethod::kTls;
    case estimation::Method::kGtls:
      return VehicleMethod::kGtls;
    case estimation::Method::kPcaGtls:
      break;
  }
  return VehicleMethod::kPcaGtls;
}

/// The method of a name, kGiven for an unknown one.
[[nodiscard]] constexpr VehicleMethod vehicle_method(std::string_view name) {
  for (std::size_t i = 0; i < kVehicleMethodNames.size(); ++i) {
    if (kVehicleMethodNames[i] == name) return static_cast<VehicleMethod>(i);
  }
  return VehicleMethod::kGiven;
}

}  // namespace veridyn::vehicle
