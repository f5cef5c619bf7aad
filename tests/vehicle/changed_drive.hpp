#pragma once

#include <functional>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle::testing {

/// A lively drive of the family car, without noise.
inline Recording recorded(double duration = 30.0) {
  return record_drive(lively_drive(family_car(), 1, 0.02, duration), perfect_sensors(), 1);
}

/// The recording with one channel's values changed, as a function of time and value.
inline Recording changed(const Recording& recording, const std::string& name,
                         const std::function<double(double, double)>& change) {
  Recording out = recording::without_channels(recording);
  for (Channel c : recording.channels()) {
    if (c.name == name) {
      for (std::size_t i = 0; i < c.value.size(); ++i) c.value[i] = change(c.times()[i], c.value[i]);
    }
    out.add(std::move(c));
  }
  return out;
}

inline Recording without(const Recording& recording, const std::string& name) {
  Recording out = recording::without_channels(recording);
  for (const Channel& c : recording.channels()) {
    if (c.name != name) out.add(c);
  }
  return out;
}

inline DriveSignals prepared(const Recording& r, const DriveSignalOptions& o = {}) {
  return prepare_drive_signals(mapped(r), o);
}

}  // namespace veridyn::vehicle::testing
