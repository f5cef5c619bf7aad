#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/units.hpp"

namespace veridyn {

/// Body frame of a recording. Converting between them is explicit.
enum class Frame {
  kUnspecified,
  kFrd,  ///< x forward, y right, z down (aircraft)
  kFlu,  ///< x forward, y left, z up (vehicles, ISO 8855)
};

/// A stretch of time [s], begin < end.
struct TimeSpan {
  double begin = 0.0;
  double end = 0.0;
  [[nodiscard]] double duration() const { return end - begin; }
  [[nodiscard]] bool contains(double t) const { return t >= begin && t <= end; }
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

/// Time stamps [s] shared by the channels of one message or table.
using TimeBase = std::shared_ptr<const std::vector<double>>;

/// One recorded quantity on its own time base.
///
/// Values are in SI and radians; `unit` is that SI unit with the recorded one as `recorded_unit`. Stamps never
/// decrease. Samples that the recorder missed are absent (a gap in time) or NaN (an empty cell); neither is filled in.
struct Channel {
  std::string name;
  Unit unit;
  std::string recorded_unit = "1";
  TimeBase time;
  std::vector<double> value;

  [[nodiscard]] std::size_t size() const { return value.size(); }
  [[nodiscard]] bool empty() const { return value.empty(); }
  [[nodiscard]] std::span<const double> times() const {
    return time ? std::span<const double>(*time) : std::span<const double>();
  }
  /// First and last stamp; {0, 0} when empty.
  [[nodiscard]] TimeSpan span() const;
  /// 1 / median interval between stamps [Hz]; 0 with fewer than two samples.
  [[nodiscard]] double rate_Hz() const;
  /// Stretches between neighbouring finite samples that are longer than `limit_s`; by default 5 median intervals.
  [[nodiscard]] std::vector<TimeSpan> gaps(double limit_s = 0.0) const;
};

/// Something that happened at a moment: a flight mode, a message, an armed state.
struct Event {
  double time = 0.0;
  std::string kind;
  std::string text;
};

/// What sensors recorded of a moving thing: named channels, each with unit and time base, and what came with them.
class Recording {
 public:
  std::string source;  ///< file name, for messages and reports
  Frame frame = Frame::kUnspecified;
  std::vector<Event> events;
  std::map<std::string, double> parameters;        ///< of the autopilot, where the log holds them
  std::map<std::string, std::string> information;  ///< firmware, vehicle type and the like
  std::vector<std::string> warnings;               ///< what the reader could not read or had to repair, in words

  /// Adds a channel.
  /// @throws InputError when sizes differ, a stamp is not finite or decreases, or the name is taken or empty.
  void add(Channel channel);
  /// Adds a channel, replacing one of the same name.
  void set(Channel channel);

  [[nodiscard]] std::span<const Channel> channels() const { return channels_; }
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  /// The channel, or null.
  [[nodiscard]] const Channel* find(std::string_view name) const;
  /// The channel.
  /// @throws InputError naming the channel and what the recording has instead.
  [[nodiscard]] const Channel& at(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names() const;
  /// From the earliest to the latest stamp of any channel; {0, 0} when empty.
  [[nodiscard]] TimeSpan span() const;

 private:
  std::vector<Channel> channels_;
  std::map<std::string, std::size_t, std::less<>> index_;
};

/// A time base from stamps [s].
[[nodiscard]] TimeBase make_time_base(std::vector<double> stamps);

/// A channel whose values are already in SI; `unit` is an SI unit such as "m/s^2" or "rad".
[[nodiscard]] Channel make_channel(std::string name, std::string_view unit, TimeBase time, std::vector<double> value);

}  // namespace veridyn
