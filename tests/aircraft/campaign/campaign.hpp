#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/aircraft/campaign/faults.hpp"

/// What becomes of one fault at a time in simulated flights of known truth: is it caught, is it named, or does it end
/// in numbers that are confident and wrong?
namespace veridyn::aircraft::testing {

/// What became of a fault.
enum class Finding {
  kHarmless,     ///< nothing was found, and every parameter that is graded yes is right
  kNamed,        ///< found, and a row that decides is about what is wrong
  kMisnamed,     ///< found, but the rows that decide are about something else
  kNotVerified,  ///< wrong, while a row about what is wrong says that this recording does not verify it
  kMissed        ///< confident and wrong
};
/// "harmless", "named", "misnamed", "not verified", "missed".
[[nodiscard]] std::string_view to_string(Finding finding);

/// A parameter counts as wrong beyond three of its standard errors and this share of the truth.
inline constexpr double kWrongBy = 0.05;

/// A flight with its result.
struct Identified {
  bool refused = false;  ///< an InputError; `message` says which
  std::string message;
  FlightAnalysis analysis;
  /// Parameters that are graded yes, and those of them that are wrong: "Cm_alpha -0.9 +- 0.01 (-0.7)".
  std::size_t confident = 0;
  std::size_t covered = 0;  ///< of the confident ones: the truth is inside the interval of 95 %
  std::map<std::string, std::string> wrong;
};

/// One fault in one flight.
struct Trial {
  std::string aircraft = {}, fault = {};
  Finding finding = Finding::kMissed;
  std::string data = {}, parameters = {};  ///< grades
  std::string reason = {};                 ///< the row that decided, or the parameters that are wrong
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
