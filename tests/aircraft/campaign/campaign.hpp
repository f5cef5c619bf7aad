#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/aircraft/campaign/faults.hpp"
#include "tests/support/fault_campaign.hpp"

/// One fault at a time in simulated flights: see `tests/support/fault_campaign.hpp`.
namespace veridyn::aircraft::testing {

using test::Finding;
using test::Trial;

/// A flight with its result.
struct Identified {
  bool refused = false;  ///< an InputError; `message` says which
  std::string message;
  FlightAnalysis analysis;
  test::Confidence confidence;
};

/// What a study says of sensors' noise and turbulence beforehand.
enum class Assumed {
  kTruth,   ///< both as they were simulated
  kNothing  ///< both are measured from the recording
};

/// A flight of a built-in aircraft at its trimmed airspeed, with reference sensors, wind and turbulence.
[[nodiscard]] FlightStudy campaign_flight(const std::string& aircraft, std::uint64_t seed, double duration_s,
                                          const std::string& turbulence = "low_moderate",
                                          Assumed assumed = Assumed::kTruth);

/// Identified on one thread.
[[nodiscard]] Identified identified(const FlightStudy& study);

/// The flight with a fault, against the same flight without it.
[[nodiscard]] Trial try_fault(const FlightStudy& study, const Identified& clean, const Fault& fault);

/// A line a fault: how many aircraft each finding had.
[[nodiscard]] std::string confusion_table(const std::vector<Trial>& trials);

}  // namespace veridyn::aircraft::testing
