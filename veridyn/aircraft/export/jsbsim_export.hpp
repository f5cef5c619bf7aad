#pragma once

#include <string>

#include "veridyn/aircraft/export/complete_subject.hpp"
#include "veridyn/aircraft/export/trial_flight.hpp"

namespace veridyn::aircraft {

/// A completed subject as a JSBSim file (`write_jsbsim`) that says of each parameter where it is from, in the
/// description of its function, and in notes of its header where the rest is from and how it flew.
/// @param trial  of the same subject; null: it was not flown
[[nodiscard]] std::string jsbsim_file(const CompletedSubject& completed, const TrialFlight* trial);

}  // namespace veridyn::aircraft
