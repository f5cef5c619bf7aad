#include "veridyn/live/virtual/virtual_vehicle.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/live/virtual/motion_packet.hpp"

namespace veridyn::live {
namespace {

using recording::MotionSample;

/// World velocity of sample k [m/s], z up: of its place where that is known, else along its nose.
Eigen::Vector3d velocity(const std::vector<MotionSample>& drive, std::size_t k) {
  if (drive[k].position_from == recording::Origin::kAbsent)
    return drive[k].attitude * Eigen::Vector3d(drive[k].speed, 0.0, 0.0);
  const MotionSample &a = drive[k > 0 ? k - 1 : 0], &b = drive[std::min(k + 1, drive.size() - 1)];
  const Eigen::Vector2d v = (b.position - a.position) / (b.time - a.time);
  return {v.x(), v.y(), 0.0};
}

std::vector<PacketedMotion> packeted(std::vector<MotionSample> drive) {
  for (MotionSample& s : drive) s = recording::in_frame(s, Frame::kFlu);
  std::vector<PacketedMotion> out;
  out.reserve(drive.size());
  for (std::size_t k = 0; k < drive.size(); ++k) {
    const MotionSample& s = drive[k];
    out.push_back({.sequence = 0,
                   .time = s.time,
                   .position = {s.position.x(), s.position.y(), 0.0},
                   .velocity = velocity(drive, k),
                   .force = s.force,
                   .rate = s.rate,
                   .attitude = s.attitude});
  }
  return out;
}

}  // namespace

VirtualVehicle::VirtualVehicle(std::vector<MotionSample> drive, const VirtualVehicleOptions& options)
    : VirtualVehicle(packeted(std::move(drive)), options) {}

VirtualVehicle::VirtualVehicle(std::vector<PacketedMotion> drive, const VirtualVehicleOptions& options)
    : drive_(std::move(drive)), options_(options), random_(options.seed, "virtual vehicle") {
  VERIDYN_ASSERT(drive_.size() >= 2 && options.rate > 0.0);
  schedule();
}

void VirtualVehicle::schedule() {
  const double late = options_.jitter > 0.0 ? random_.uniform(0.0, options_.jitter) : 0.0;
  // The order of packets is kept: a late one holds up those behind it, as on one wire.
  due_ = std::max(due_, nanoseconds(static_cast<double>(number_) / options_.rate + late));
}

std::optional<std::string_view> VirtualVehicle::next() {
  const double passed = static_cast<double>(number_) / options_.rate;
  const double length = drive_.back().time - drive_.front().time;
  const double at = drive_.front().time + std::fmod(passed, length);
  if (at < drive_[at_].time) at_ = 0;
  while (at_ + 2 < drive_.size() && drive_[at_ + 1].time <= at) ++at_;
  const PacketedMotion &a = drive_[at_], &b = drive_[at_ + 1];
  const double part = std::clamp((at - a.time) / (b.time - a.time), 0.0, 1.0);
  const auto line = [&](const auto& from, const auto& to) { return (from + part * (to - from)).eval(); };
  constexpr double kItsZero = 1000.0;  // [s]: its clock is not ours
  encode_motion({.sequence = static_cast<std::uint32_t>(number_ % 0xffffffffU),
                 .time = kItsZero + passed * (1.0 + options_.clock_drift),
                 .position = line(a.position, b.position),
                 .velocity = line(a.velocity, b.velocity),
                 .force = line(a.force, b.force),
                 .rate = line(a.rate, b.rate),
                 .attitude = a.attitude.slerp(part, b.attitude)},
                packet_);
  ++number_;
  schedule();
  if (options_.loss > 0.0 && random_.uniform() < options_.loss) {
    ++lost_;
    return std::nullopt;
  }
  ++sent_;
  return std::string_view(packet_.data(), packet_.size());
}

}  // namespace veridyn::live
