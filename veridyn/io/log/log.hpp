#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/io/log/column.hpp"

namespace veridyn::io {

/// One field of a topic. `scale * values.number(i)` is in `unit`, which is written as `parse_unit` reads it; "1" also
/// where the log does not say.
struct LogField {
  std::string name;  ///< empty, or "[0]", where the topic is the quantity itself
  std::string unit = "1";
  double scale = 1.0;
  Column values;
  /// Of an array that is not a series (MATLAB): column-major extents; otherwise empty.
  std::vector<std::size_t> shape{};

  [[nodiscard]] double value(std::size_t i) const { return scale * values.number(i); }
};

/// One kind of message of a log with all its samples: IMU, sensor_combined, a table. One entry for each instance.
struct LogTopic {
  std::string name;
  int instance = 0;
  TimeBase time;  ///< [s] on the clock of the log; never decreases. One stamp for each row; null for tables.
  std::vector<LogField> fields;
  bool schema = false;  ///< describes the log itself (formats, units, parameters); makes no channels

  std::size_t spikes = 0;     ///< rows dropped because their stamp lay far off
  std::size_t reordered = 0;  ///< rows that stood before a later one and were sorted
  std::size_t doubled = 0;    ///< rows with the stamp of the row before; kept

  [[nodiscard]] std::size_t size() const { return time ? time->size() : 0; }
  [[nodiscard]] const LogField* find(std::string_view field) const;
  /// "IMU", and "IMU[1]" for further instances.
  [[nodiscard]] std::string full_name() const;
};

/// What of a log could not be read, and what the logger itself lost.
struct LogDamage {
  std::uint64_t bytes_lost = 0;    ///< bytes that belong to no readable record
  std::uint64_t records_lost = 0;  ///< at least this many records were cut, overwritten or unreadable
  std::uint64_t dropouts = 0;      ///< pauses that the logger reported
  double dropout_s = 0.0;          ///< their total duration [s]
  std::vector<std::string> notes;  ///< in words, at most one line per kind of trouble

  [[nodiscard]] bool any() const { return bytes_lost > 0 || records_lost > 0 || dropouts > 0; }
};

/// A log as it was written, whatever its format: topics of raw columns, messages, parameters, and what was lost.
struct Log {
  std::string source;  ///< file name
  std::string format;  ///< "ArduPilot DataFlash", "PX4 ULog", ...
  Frame frame = Frame::kUnspecified;
  std::vector<LogTopic> topics;
  std::vector<Event> events;  ///< flight modes, armed states, messages, in order of time
  std::map<std::string, double> parameters;
  std::map<std::string, double> default_parameters;  ///< what the firmware would use, where the log says so
  std::map<std::string, std::string> information;
  LogDamage damage;
  std::vector<double> restarts;  ///< when the vehicle or its clock restarted, times going on [s]
  std::size_t part = 0;          ///< which part of its file it is, from 1 (`log_parts.hpp`); 0: all of it
  std::size_t parts = 0;         ///< of a table whose clock restarts: how many parts the file has

  [[nodiscard]] const LogTopic* find(std::string_view name, int instance = 0) const;
  /// Rows of all instances of a topic.
  [[nodiscard]] std::size_t count(std::string_view name) const;
};

/// Which part of a log becomes channels.
struct RecordingOptions {
  /// Asked with `LogTopic::name`; empty keeps all. A one-hour log holds hundreds of channels, few of which are needed.
  std::function<bool(std::string_view)> keep_topic;
};

/// The channels of a log: `TOPIC.field` (`TOPIC` and `TOPIC[0]` of fields without a name), `IMU[1].AccX` for further
/// instances, in SI and radians; the fields of a topic share their time base. Text columns and topics that describe the
/// log itself make no channels. Parameters, events and information are carried over, and every damage becomes a
/// warning. The rvalue form releases each column once it is converted, which halves the peak of memory.
[[nodiscard]] Recording to_recording(const Log& log, const RecordingOptions& options = {});
/// The same, releasing each column of the log once it is converted.
[[nodiscard]] Recording to_recording(Log&& log, const RecordingOptions& options = {});

namespace internal {

/// Texts from logs go to terminals, JSON and HTML: control characters and bytes outside ASCII become '?'.
[[nodiscard]] std::string printable(std::string_view text);

/// The last duties of every reader: drops a last row whose stamp lies more than a minute after everything else in the
/// log, sorts the events, and puts what was dropped, sorted and doubled into the notes.
void finish(Log& log);

}  // namespace internal
}  // namespace veridyn::io
