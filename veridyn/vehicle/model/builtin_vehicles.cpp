#include "veridyn/vehicle/model/builtin_vehicles.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::vehicle {
namespace {

VehicleParameters<double> one_to_five() {
  VehicleParameters<double> p;
  p.mass = 8.8;
  p.unsprung_mass = 0.32;
  p.a = 0.25;
  p.b = 0.20;
  p.track_f = p.track_r = 0.3;
  p.cg_height = 0.084;
  p.I_x = 0.188;
  p.I_y = 0.512;
  p.I_z = 0.352;
  p.C_f = 100.0;
  p.C_r = 200.0;
  p.K_sf = p.K_sr = 160.0;
  p.C_sf = p.C_sr = 80.0;
  p.K_tf = p.K_tr = 160.0;
  return p;
}

/// Ride at 1.25 and 1.35 Hz with damping ratios of 0.3; more of the roll stiffness in front.
VehicleParameters<double> saloon() {
  VehicleParameters<double> p;
  p.mass = 1500.0;
  p.unsprung_mass = 38.0;
  p.a = 1.15;
  p.b = 1.55;
  p.track_f = p.track_r = 1.55;
  p.cg_height = 0.54;
  p.I_x = 520.0;
  p.I_y = 2300.0;
  p.I_z = 2500.0;
  p.C_f = 60000.0;
  p.C_r = 70000.0;
  p.K_sf = 26000.0;
  p.K_sr = 23000.0;
  p.C_sf = 1900.0;
  p.C_sr = 1650.0;
  p.K_bf = 12000.0;
  p.K_br = 4000.0;
  p.K_tf = p.K_tr = 210000.0;
  p.mu = 0.95;
  return p;
}

}  // namespace

std::span<const BuiltinVehicle> builtin_vehicles() {
  static const std::array<BuiltinVehicle, 3> vehicles{{
      {"reference", "full-size car of the reference manoeuvre: 1100 kg, wheelbase 2.25 m, 20 m/s", {}, 20.0, {}, {}},
      {"reference_1to5",
       "the published model of the reference car, one fifth its size: 8.8 kg, wheelbase 0.45 m, 4 m/s",
       one_to_five(),
       4.0,
       {},
       {}},
      {"saloon", "a saloon of usual numbers, our own: 1500 kg, wheelbase 2.7 m", saloon(), 25.0,
       AxleSuspension{.roll_centre = 0.04, .roll_steer = -0.05, .compliance_steer = -3e-6},
       AxleSuspension{.roll_centre = 0.10, .roll_steer = 0.04, .compliance_steer = 0.5e-6}},
  }};
  return vehicles;
}

const BuiltinVehicle& builtin_vehicle(std::string_view name, std::string_view place) {
  std::vector<std::string> names;
  for (const BuiltinVehicle& vehicle : builtin_vehicles()) {
    if (vehicle.name == name) return vehicle;
    names.push_back(vehicle.name);
  }
  throw InputError(place, fmt::format("no built-in vehicle is called '{}'{}", name, suggestion(name, names)));
}

}  // namespace veridyn::vehicle
