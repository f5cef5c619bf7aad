#pragma once

#include <cstddef>
#include <string_view>

#include "veridyn/core/enum_array.hpp"
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
/// How many there are.
inline constexpr std::size_t kVehicleMethods = 7;
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<VehicleMethod, std::string_view, kVehicleMethods> kVehicleMethodNames{
    "output error", "OLS", "TLS", "GTLS", "PCA-GTLS", "given", "none"};
/// As study files and estimates name it.
[[nodiscard]] constexpr std::string_view to_string(VehicleMethod method) { return kVehicleMethodNames[method]; }

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
  for (const VehicleMethod method : enumerators<VehicleMethod, kVehicleMethods>()) {
    if (kVehicleMethodNames[method] == name) return method;
  }
  return VehicleMethod::kGiven;
}

}  // namespace veridyn::vehicle
