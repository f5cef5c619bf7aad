#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "veridyn/live/time/clock.hpp"
#include "veridyn/live/virtual/motion_packet.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::live {

/// How packets of a virtual vehicle come.
struct VirtualVehicleOptions {
  double rate = 100.0;       ///< [Hz]
  double jitter = 0.0;       ///< packets are sent late by a random time up to this [s]
  double loss = 0.0;         ///< share of packets that are not sent
  double clock_drift = 0.0;  ///< its clock runs fast by this share
  std::uint64_t seed = 1;
};

/// Sends a drive as packets `veridyn` of its own clock, again and again; between two rounds the vehicle is put back to
/// the start. Knows nothing of clocks and sockets.
class VirtualVehicle {
 public:
  static constexpr std::size_t kPacketBytes = kMotionPacketBytes;

  /// @param drive stamps growing, frame flu or frd, two samples at least
  VirtualVehicle(std::vector<recording::MotionSample> drive, const VirtualVehicleOptions& options = {});
  /// @param drive times growing, two motions at least
  VirtualVehicle(std::vector<PacketedMotion> drive, const VirtualVehicleOptions& options = {});

  /// When the next packet is to be sent, from the beginning.
  [[nodiscard]] Nanoseconds due() const { return due_; }
  /// The packet that is due, nothing where it is lost; moves on to the next one.
  std::optional<std::string_view> next();
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  void schedule();
  std::vector<PacketedMotion> drive_;
  VirtualVehicleOptions options_;
  std::array<char, kPacketBytes> packet_{};
  std::uint64_t number_ = 0, sent_ = 0, lost_ = 0;
  std::size_t at_ = 0;
  Nanoseconds due_ = 0;
  numerics::RandomStream random_;
};

}  // namespace veridyn::live
