#pragma once

#include <cstdint>
#include <string_view>

#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// What the operator, the page or a signal asks of the rig.
enum class OperatorRequest : std::uint8_t {
  kStart = 0,
  kPark = 1,
  kEmergency = 2,
  kRelease = 3,
  kSignsRight = 4,
  kSignsWrong = 5
};

/// What was recorded of a run: everything that went in and every step, in the order in which the rig saw them. Fed to
/// a rig of the same study they give the same orders, bit for bit.
struct LiveRecord {
  enum class Kind : std::uint8_t {
    kDatagram = 1,  ///< `link`, `datagram`
    kRequest = 2,   ///< `request`
    kKnob = 3,      ///< `knob`, `count`, `value`: one of `count`, which take effect together
    kStep = 4,      ///< `order`: what was sent to the platform
    kCommand = 5,   ///< `order`: what was sent to the car
  };
  Kind kind = Kind::kStep;
  Nanoseconds time = 0;  ///< when the rig saw it; of a step or command the step's own time
  LinkOf link = LinkOf::kTelemetry;
  Datagram datagram;
  OperatorRequest request = OperatorRequest::kStart;
  std::uint16_t knob = 0, count = 0;  ///< which of the values of the design's knobs, of how many
  double value = 0.0;
  std::string_view order;  ///< bytes
  Nanoseconds sent = 0;    ///< of a step or command: when it had been handed to the kernel
};

}  // namespace veridyn::live
