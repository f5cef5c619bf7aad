#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace veridyn::testing {

/// Writes telemetry logs of MAVLink packet by packet: independent of the reader's table of messages, payloads are
/// given as bytes and CRC_EXTRA as the number that MAVLink's generated headers hold.
class TlogWriter {
 public:
  struct Sender {
    std::uint8_t system = 1, component = 1;
  };

  /// A packet of version 2, zeros at the end of its payload left out, received `us` after the log began.
  void packet(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload,
              Sender sender = {1, 1});
  /// One of version 1.
  void packet1(std::uint64_t us, std::uint8_t message, std::uint8_t crc_extra, std::string_view payload,
               Sender sender = {1, 1});
  /// Signed ones end with 13 bytes more.
  void signed_packet(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload,
                     Sender sender = {1, 1});
  [[nodiscard]] std::string& bytes() { return bytes_; }

  /// 2023-11-14 22:13:20 UTC [us].
  static constexpr std::uint64_t kBegin_us = 1'700'000'000'000'000;

 private:
  void stamp(std::uint64_t us);
  void second(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload, Sender sender,
              bool is_signed);

  std::string bytes_;
  std::uint8_t sequence_ = 0;
};

/// Two seconds of an ArduPilot plane (system 1) with its gimbal (component 154) and another aircraft (system 2): all
/// messages that the reader knows of motion, parameters, a text, a message that it does not know.
[[nodiscard]] std::string small_tlog();

}  // namespace veridyn::testing
