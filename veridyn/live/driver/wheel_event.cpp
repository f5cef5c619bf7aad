#include "veridyn/live/driver/wheel_event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::live {
namespace {

struct AxisName {
  std::uint16_t code;
  std::string_view name;
};
constexpr std::array kAxisNames = {
    AxisName{0, "ABS_X"},      AxisName{1, "ABS_Y"},      AxisName{2, "ABS_Z"},        AxisName{3, "ABS_RX"},
    AxisName{4, "ABS_RY"},     AxisName{5, "ABS_RZ"},     AxisName{6, "ABS_THROTTLE"}, AxisName{7, "ABS_RUDDER"},
    AxisName{8, "ABS_WHEEL"},  AxisName{9, "ABS_GAS"},    AxisName{10, "ABS_BRAKE"},   AxisName{16, "ABS_HAT0X"},
    AxisName{17, "ABS_HAT0Y"}, AxisName{18, "ABS_HAT1X"}, AxisName{19, "ABS_HAT1Y"},   AxisName{32, "ABS_VOLUME"},
    AxisName{40, "ABS_MISC"},
};

constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
// Beyond it a time does not fit nanoseconds.
constexpr std::int64_t kLatestSecond = INT64_MAX / kSecond - 1;

}  // namespace

std::string axis_name(std::uint16_t code) {
  const auto* const known =
      std::find_if(kAxisNames.begin(), kAxisNames.end(), [&](const AxisName& axis) { return axis.code == code; });
  return known != kAxisNames.end() ? std::string(known->name) : fmt::format("ABS_{}", code);
}

std::optional<std::uint16_t> axis_code(std::string_view name) {
  const auto* const known =
      std::find_if(kAxisNames.begin(), kAxisNames.end(), [&](const AxisName& axis) { return axis.name == name; });
  if (known != kAxisNames.end()) return known->code;
  if (!name.starts_with("ABS_")) return std::nullopt;
  const std::string_view digits = name.substr(4);
  std::uint16_t code = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code);
  if (error != std::errc() || end != digits.data() + digits.size() || code >= kAxisCodes) return std::nullopt;
  return code;
}

std::optional<WheelEvent> WheelEventDecoder::next(Bytes& bytes) {
  while (!bytes.empty()) {
    const std::size_t taken = std::min(bytes.size(), kRecord - size_);
    std::copy_n(bytes.begin(), taken, record_.begin() + size_);
    size_ += taken;
    bytes = bytes.subspan(taken);
    if (size_ < kRecord) break;
    size_ = 0;
    LittleEndianReader read(record_);
    const auto second = read.get<std::int64_t>();
    const auto microsecond = read.get<std::int64_t>();
    WheelEvent event;
    event.type = read.get<std::uint16_t>();
    event.code = read.get<std::uint16_t>();
    event.value = read.get<std::int32_t>();
    if (second < 0 || second > kLatestSecond || microsecond < 0 || microsecond >= kMicrosecondsPerSecond) {
      ++damaged_;
      continue;
    }
    event.time = second * kSecond + microsecond * 1000;
    return event;
  }
  return std::nullopt;
}

std::vector<WheelEvent> read_wheel_events(const std::filesystem::path& file) {
  const std::string content = read_file(file);
  const Bytes all(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  constexpr std::size_t kRecord = WheelEventDecoder::kRecord;
  std::vector<WheelEvent> events;
  events.reserve(all.size() / kRecord);
  WheelEventDecoder decoder;
  for (std::size_t at = 0; at < all.size(); at += kRecord) {
    const std::string place = fmt::format("{}: byte {}", file.string(), at);
    Bytes record = all.subspan(at, std::min(kRecord, all.size() - at));
    if (record.size() < kRecord)
      throw InputError(place, fmt::format("the last event is cut off: {} of {} bytes", record.size(), kRecord));
    const std::optional<WheelEvent> event = decoder.next(record);
    if (!event) throw InputError(place, "not an event of an input device: its time cannot be");
    if (!events.empty() && event->time < events.back().time)
      throw InputError(place, "an event before the one before it");
    events.push_back(*event);
  }
  return events;
}

WheelAxes::WheelAxes(std::span<const WheelAxis> axes) {
  for (const WheelAxis& axis : axes) {
    if (axis.code >= kAxisCodes) continue;
    values_[axis.code] = pending_[axis.code] = axis.value;
    heard_[axis.code] = pending_heard_[axis.code] = true;
  }
}

bool WheelAxes::take(const WheelEvent& event) {
  if (event.type == kSyncEvent && event.code == kSyncDropped) {
    dropping_ = true;
    ++dropped_;
    pending_ = values_;
    pending_heard_ = heard_;
  } else if (event.type == kSyncEvent && event.code == kSyncReport) {
    time_ = event.time;
    const bool complete = !dropping_;
    dropping_ = false;
    if (!complete) return false;
    values_ = pending_;
    heard_ = pending_heard_;
    return true;
  } else if (event.type == kAxisEvent && event.code < kAxisCodes && !dropping_) {
    pending_[event.code] = event.value;
    pending_heard_[event.code] = true;
  }
  return false;
}

}  // namespace veridyn::live
