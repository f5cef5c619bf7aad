#pragma once

#include <optional>
#include <string_view>

#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// What came in, and where.
struct Incoming {
  LinkOf link = LinkOf::kTelemetry;
  Datagram datagram;
};

/// What goes in and out of a rig: sockets, or what a test puts in their place.
class LiveLinks {
 public:
  virtual ~LiveLinks() = default;
  /// The next datagram; waits for one until `until`. Nothing when that time has come, whatever may be there still.
  virtual std::optional<Incoming> next(Clock& clock, Nanoseconds until) = 0;
  /// An order to the platform. @return whether it was handed over
  virtual bool send(std::string_view order) = 0;
  /// A command to the car, where there is one. @return whether it was handed over
  virtual bool send_command(std::string_view /*command*/) { return false; }
};

}  // namespace veridyn::live
