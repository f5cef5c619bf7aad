#pragma once

#include <string>
#include <vector>

#include "veridyn/live/driver/wheel_event.hpp"

namespace veridyn::live::testing {

/// Writes what a device file delivers.
class RecordedWheel {
 public:
  RecordedWheel& axis(std::uint16_t code, std::int32_t value) { return event(kAxisEvent, code, value); }
  RecordedWheel& report() { return event(kSyncEvent, kSyncReport, 0); }
  RecordedWheel& wait(Nanoseconds time) {
    time_ += time;
    return *this;
  }
  RecordedWheel& event(std::uint16_t type, std::uint16_t code, std::int32_t value) {
    events.push_back({.time = time_, .type = type, .code = code, .value = value});
    return *this;
  }
  /// Hands every event to `take`.
  void play(const auto& take) const {
    for (const WheelEvent& each : events) take(each);
  }
  [[nodiscard]] std::string bytes() const {
    std::string result;
    for (const WheelEvent& each : events) {
      std::array<std::uint8_t, WheelEventDecoder::kRecord> record;
      LittleEndianWriter write(record);
      write.put(static_cast<std::int64_t>(each.time / kSecond));
      write.put(static_cast<std::int64_t>(each.time % kSecond / 1000));
      write.put(each.type);
      write.put(each.code);
      write.put(each.value);
      result.append(reinterpret_cast<const char*>(record.data()), record.size());
    }
    return result;
  }

  std::vector<WheelEvent> events;

 private:
  Nanoseconds time_ = 100 * kSecond;
};

}  // namespace veridyn::live::testing
