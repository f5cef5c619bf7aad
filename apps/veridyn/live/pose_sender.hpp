#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/live/camera/pose_server.hpp"

namespace veridyn::app {

/// Sends the poses of single pictures over TCP.
class PoseSender {
 public:
  /// @param address empty: to nobody @param place of the address, for messages
  PoseSender(const std::string& address, const std::string& place);
  [[nodiscard]] bool sends() const { return server_.has_value(); }
  /// @param stamp  of the picture
  void send(const camera::TrackedPose& pose, live::Nanoseconds stamp);

 private:
  std::optional<live::PoseServer> server_;
  std::uint32_t sequence_ = 0;
};

}  // namespace veridyn::app
