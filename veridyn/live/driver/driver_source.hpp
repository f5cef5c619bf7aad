#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/live/driver/wheel_event.hpp"

namespace veridyn::live {

/// Who drives: events of a wheel with its pedals as the records of 24 bytes that a device file delivers
/// (`WheelEventDecoder`), whatever they come from, so that one recording holds all of them.
class DriverSource {
 public:
  virtual ~DriverSource() = default;
  /// Whole records that have come by then, at most as many as `out` holds; the first ones say where every axis is.
  /// Allocates nothing and does not throw. @return bytes
  virtual std::size_t read(Nanoseconds now, std::span<std::uint8_t> out) = 0;
  /// When there is something to be read again, where that is known; a device has a descriptor instead.
  [[nodiscard]] virtual std::optional<Nanoseconds> due() const = 0;
  /// To wait for; -1: none.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// No more will come: unplugged, or the recording is over.
  [[nodiscard]] virtual bool ended() const = 0;
};

/// A wheel that is plugged in. @throws InputError as `WheelDevice`
[[nodiscard]] std::unique_ptr<DriverSource> wheel_source(const std::filesystem::path& device);

/// Recorded events in their own time, from the first reading on; stamps become those of the reader's clock.
/// @param at_rest where the axes are before the first event
[[nodiscard]] std::unique_ptr<DriverSource> recorded_source(std::vector<WheelEvent> events,
                                                            std::span<const WheelAxis> at_rest);

/// The record of an event.
void encode_wheel_event(const WheelEvent& event, std::span<std::uint8_t, WheelEventDecoder::kRecord> out);

}  // namespace veridyn::live
