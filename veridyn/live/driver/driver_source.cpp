#include "veridyn/live/driver/driver_source.hpp"

#include <array>

#include "veridyn/live/driver/wheel_device.hpp"

namespace veridyn::live {
namespace {

constexpr std::size_t kEventRecord = WheelEventDecoder::kRecord;

/// Writes events one after the other, as far as there is room for them.
class RecordsOut {
 public:
  explicit RecordsOut(std::span<std::uint8_t> out) : out_(out) {}
  [[nodiscard]] bool has_room() const { return size_ + kEventRecord <= out_.size(); }
  void put(const WheelEvent& event) {
    encode_wheel_event(event, out_.subspan(size_).first<kEventRecord>());
    size_ += kEventRecord;
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
};

/// Where the axes are, as events, with the report that ends them.
std::vector<WheelEvent> events_of(std::span<const WheelAxis> axes) {
  std::vector<WheelEvent> events;
  for (const WheelAxis& axis : axes)
    events.push_back({.time = 0, .type = kAxisEvent, .code = axis.code, .value = axis.value});
  events.push_back({.time = 0, .type = kSyncEvent, .code = kSyncReport, .value = 0});
  return events;
}

class WheelSource final : public DriverSource {
 public:
  explicit WheelSource(const std::filesystem::path& path) : device_(path), first_(events_of(device_.axes())) {}

  std::size_t read(Nanoseconds now, std::span<std::uint8_t> out) override {
    RecordsOut records(out);
    for (; begun_ < first_.size() && records.has_room(); ++begun_) {
      WheelEvent event = first_[begun_];
      event.time = now;
      records.put(event);
    }
    while (begun_ == first_.size() && records.has_room()) {
      std::array<WheelEvent, 1> event;
      if (device_.read(event) == 0) break;
      records.put(event[0]);
    }
    return records.size();
  }
  [[nodiscard]] std::optional<Nanoseconds> due() const override { return std::nullopt; }
  [[nodiscard]] int descriptor() const override { return device_.unplugged() ? -1 : device_.descriptor(); }
  [[nodiscard]] bool ended() const override { return device_.unplugged(); }

 private:
  WheelDevice device_;
  std::vector<WheelEvent> first_;
  std::size_t begun_ = 0;
};

class RecordedSource final : public DriverSource {
 public:
  RecordedSource(std::vector<WheelEvent> events, std::span<const WheelAxis> at_rest)
      : events_(events_of(at_rest)), first_(events.empty() ? 0 : events.front().time) {
    for (WheelEvent& event : events_) event.time = first_;
    events_.insert(events_.end(), events.begin(), events.end());
  }

  std::size_t read(Nanoseconds now, std::span<std::uint8_t> out) override {
    if (!begin_) begin_ = now;
    RecordsOut records(out);
    for (; next_ < events_.size() && records.has_room() && ours(events_[next_]) <= now; ++next_) {
      WheelEvent event = events_[next_];
      event.time = ours(event);
      records.put(event);
    }
    return records.size();
  }
  [[nodiscard]] std::optional<Nanoseconds> due() const override {
    if (!begin_) return 0;
    if (ended()) return std::nullopt;
    return ours(events_[next_]);
  }
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] bool ended() const override { return next_ == events_.size(); }

 private:
  [[nodiscard]] Nanoseconds ours(const WheelEvent& event) const { return *begin_ + (event.time - first_); }

  std::vector<WheelEvent> events_;
  Nanoseconds first_;
  std::optional<Nanoseconds> begin_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<DriverSource> wheel_source(const std::filesystem::path& device) {
  return std::make_unique<WheelSource>(device);
}

std::unique_ptr<DriverSource> recorded_source(std::vector<WheelEvent> events, std::span<const WheelAxis> at_rest) {
  return std::make_unique<RecordedSource>(std::move(events), at_rest);
}

void encode_wheel_event(const WheelEvent& event, std::span<std::uint8_t, WheelEventDecoder::kRecord> out) {
  LittleEndianWriter write(out);
  write.put(std::int64_t{event.time / kSecond});
  write.put(std::int64_t{event.time % kSecond / 1000});
  write.put(event.type);
  write.put(event.code);
  write.put(event.value);
}

}  // namespace veridyn::live
