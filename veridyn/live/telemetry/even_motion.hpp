#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "veridyn/live/telemetry/packet_intake.hpp"

namespace veridyn::live {

/// How the motion is had at even times from packets that come at uneven ones.
struct EvenMotionOptions {
  /// How far behind the sender's newest moment the motion is taken [s]. Two intervals of the sender let a packet come
  /// one interval late without a guess; 0 is as quick as can be.
  double delay = 0.02;
  /// For how long the motion goes on in a straight line where no newer packet is there [s]; after that it stays.
  double extrapolate = 0.03;
};

/// The motion at a moment.
struct EvenSample {
  recording::MotionSample sample;
  Nanoseconds arrival = 0;    ///< of the newest packet in it
  double extrapolated = 0.0;  ///< by how much [s]; 0 between packets
  double age = 0.0;           ///< of the newest packet's stamp against the sender's clock now [s]
};

/// Packets in, a motion at any moment out: on lines between packets, attitudes on the arc. Nothing is allocated.
class EvenMotion {
 public:
  explicit EvenMotion(const EvenMotionOptions& options = {}) : options_(options) {}

  /// One that began again forgets those before.
  void add(const Telemetry& telemetry);
  void reset() { count_ = 0; }
  /// @param now by our clock; @param clock of the sender; nothing before the first packet
  [[nodiscard]] std::optional<EvenSample> at(Nanoseconds now, const SenderClock& clock) const;
  [[nodiscard]] const EvenMotionOptions& options() const { return options_; }

 private:
  static constexpr std::size_t kKept = 256;
  [[nodiscard]] const Telemetry& newest(std::size_t back) const { return kept_[(next_ + kKept - 1 - back) % kKept]; }

  EvenMotionOptions options_;
  std::array<Telemetry, kKept> kept_;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace veridyn::live
