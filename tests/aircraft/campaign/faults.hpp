#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/fault_campaign.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::aircraft::testing {

/// One thing that is wrong with a flight: what its sensors recorded, or what is said of the aircraft.
struct Fault {
  std::string name;    ///< "accelerometer in g"
  test::NamedBy rows;  ///< what names it
  std::function<void(FlightStudy&)> apply;
};

/// All faults of the campaign, in the order of its table: sensor by sensor, units, signs, frames, scales, biases,
/// delays, samples, then the time base and the aircraft.
[[nodiscard]] const std::vector<Fault>& faults();

/// The fault of that name.
[[nodiscard]] const Fault& fault(const std::string& name);

}  // namespace veridyn::aircraft::testing
