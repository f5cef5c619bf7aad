#include "veridyn/aircraft/export/jsbsim_export.hpp"

#include <fmt/format.h>

#include <utility>

#include "veridyn/aircraft/model/jsbsim.hpp"

namespace veridyn::aircraft {

std::string jsbsim_file(const CompletedSubject& completed, const TrialFlight* trial) {
  JsbsimNotes notes;
  for (const SourcedValue& value : completed.values) {
    if (value.parameter)
      notes.parameters[value.name] = value.text;
    else
      notes.header.push_back(fmt::format("{}: {}", value.name, value.text));
  }
  if (trial != nullptr) {
    notes.header.emplace_back("flown before it was written:");
    for (std::string& line : trial_lines(*trial)) notes.header.push_back(std::move(line));
  }
  return write_jsbsim(completed.subject, notes);
}

}  // namespace veridyn::aircraft
