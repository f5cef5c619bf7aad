#pragma once

#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::live::test {

/// The published 1:5 car with springs and tyres that carry it as radio-controlled cars have them, and wheels that fit.
inline vehicle::Vehicle one_to_five() {
  const Study study = Study::parse(
      "kind = 'vehicle'\nbuiltin = 'reference_1to5'\nmu = 0.9\nK_s = 1500\nC_s = 40\nK_t = 8000\n"
      "[longitudinal]\nwheel_radius = 0.06\nwheel_inertia = 3.2e-4\ndrag_area = 0.026\n",
      "car.toml");
  return vehicle::read_vehicle(study.root(), vehicle::VehicleNeeds::kFourWheel);
}

}  // namespace veridyn::live::test
