#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/live/serial/little_endian.hpp"
#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// One event of an input device as the Linux kernel numbers them (linux/input-event-codes.h).
struct WheelEvent {
  Nanoseconds time = 0;
  std::uint16_t type = 0;
  std::uint16_t code = 0;
  std::int32_t value = 0;

  bool operator==(const WheelEvent&) const = default;
};

/// The types and codes that are of use here; the kernel never changes them.
inline constexpr std::uint16_t kSyncEvent = 0, kKeyEvent = 1, kAxisEvent = 3;
inline constexpr std::uint16_t kSyncReport = 0, kSyncDropped = 3;
inline constexpr std::uint16_t kAxisX = 0, kAxisWheel = 8;
/// Axes are numbered below it.
inline constexpr std::size_t kAxisCodes = 64;

/// "ABS_X", "ABS_WHEEL", ...; "ABS_33" where the kernel has no name.
[[nodiscard]] std::string axis_name(std::uint16_t code);
/// Its number; nothing where no axis is called so.
[[nodiscard]] std::optional<std::uint16_t> axis_code(std::string_view name);

/// What a device says of one of its axes.
struct WheelAxis {
  std::uint16_t code = 0;
  std::int32_t lowest = 0, highest = 0;
  std::int32_t value = 0;  ///< now
};

/// Reads the records that a device file delivers, and that a recording of one (`cat /dev/input/event5 > drive.events`)
/// holds: struct input_event of a 64-bit little-endian machine, 24 bytes: seconds i64, microseconds i64, type u16, code
/// u16, value i32. Chunks may be of any size. Allocates nothing and does not throw.
class WheelEventDecoder {
 public:
  static constexpr std::size_t kRecord = 24;

  /// Takes bytes from the front to the end of the next record, or all of them where there is none. A record whose time
  /// cannot be is counted and left out.
  [[nodiscard]] std::optional<WheelEvent> next(Bytes& bytes);
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }
  /// Bytes of a record that is not complete.
  [[nodiscard]] std::size_t pending() const { return size_; }

 private:
  std::array<std::uint8_t, kRecord> record_ = {};
  std::size_t size_ = 0;
  std::uint64_t damaged_ = 0;
};

/// All events of a recording.
/// @throws InputError naming file and byte: no such file, a record that cannot be, a last one that is cut off, time
/// that goes back
[[nodiscard]] std::vector<WheelEvent> read_wheel_events(const std::filesystem::path& file);

/// The position of every axis from events. Axes change together at a report; where the kernel says that it dropped
/// events, what follows is left out up to the next report.
class WheelAxes {
 public:
  WheelAxes() = default;
  explicit WheelAxes(std::span<const WheelAxis> axes);

  /// @return whether a report is complete: now `value` is of one moment
  bool take(const WheelEvent& event);
  /// Of axes that were never heard of: 0, and `heard_of` is false.
  [[nodiscard]] std::int32_t value(std::uint16_t code) const { return code < kAxisCodes ? values_[code] : 0; }
  [[nodiscard]] bool heard_of(std::uint16_t code) const { return code < kAxisCodes && heard_[code]; }
  /// Of the last report.
  [[nodiscard]] Nanoseconds time() const { return time_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::array<std::int32_t, kAxisCodes> values_ = {}, pending_ = {};
  std::array<bool, kAxisCodes> heard_ = {}, pending_heard_ = {};
  Nanoseconds time_ = 0;
  std::uint64_t dropped_ = 0;
  bool dropping_ = false;
};

}  // namespace veridyn::live
