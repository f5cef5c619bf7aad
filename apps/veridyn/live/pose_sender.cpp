#include "apps/veridyn/live/pose_sender.hpp"

#include "veridyn/live/camera/pose_packet.hpp"
#include "veridyn/live/rig/live_study.hpp"

namespace veridyn::app {

PoseSender::PoseSender(const std::string& address, const std::string& place) {
  if (!address.empty()) server_.emplace(live::parse_address(address, place), place);
}

void PoseSender::send(const camera::TrackedPose& pose, live::Nanoseconds stamp) {
  if (!server_) return;
  ++sequence_;
  if (!pose.measured) return;
  const live::PosePacket packet = live::encode(
      {.sequence = sequence_, .stamp = stamp, .pose = pose.measured->pose, .covariance = pose.measured->covariance()});
  server_->send({packet.data(), packet.size()});
}

}  // namespace veridyn::app
