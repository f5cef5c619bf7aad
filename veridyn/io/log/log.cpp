#include "veridyn/io/log/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "veridyn/core/error.hpp"

namespace veridyn::io {
namespace {

/// A last stamp so far after everything else in the log that it is a damaged one [s].
constexpr double kStrayStamp_s = 60.0;

void drop_stray_last_rows(Log& log) {
  // The two latest stamps of each topic are enough to know the latest stamp of all others.
  for (int round = 0; round < 8; ++round) {
    LogTopic* latest = nullptr;
    for (LogTopic& topic : log.topics) {
      if (topic.size() > 0 && (latest == nullptr || topic.time->back() > latest->time->back())) latest = &topic;
    }
    if (latest == nullptr) return;
    double others = -INFINITY;
    for (const LogTopic& topic : log.topics) {
      if (&topic != latest && topic.size() > 0) others = std::max(others, topic.time->back());
    }
    if (latest->size() > 1) others = std::max(others, (*latest->time)[latest->size() - 2]);
    if (!std::isfinite(others) || latest->time->back() - others <= kStrayStamp_s) return;
    std::vector<double> stamps(latest->time->begin(), latest->time->end() - 1);
    for (LogField& field : latest->fields) field.values.shorten(stamps.size());
    latest->time = make_time_base(std::move(stamps));
    ++latest->spikes;
  }
}

Unit unit_of(const LogField& field) {
  try {
    return parse_unit(field.unit);
  } catch (const InputError&) {
    return Unit{};
  }
}

void add_damage(const Log& log, Recording& recording) {
  const LogDamage& damage = log.damage;
  if (damage.bytes_lost > 0 || damage.records_lost > 0) {
    recording.warnings.push_back(
        fmt::format("damaged: {} bytes and at least {} records lost", damage.bytes_lost, damage.records_lost));
  }
  if (damage.dropouts > 0) {
    recording.warnings.push_back(
        fmt::format("the logger reported {} dropouts, {:.3f} s in all", damage.dropouts, damage.dropout_s));
  }
  for (const std::string& note : damage.notes) recording.warnings.push_back(note);
}

std::string channel_name(const std::string& prefix, const std::string& field) {
  if (prefix.empty()) return field;
  const bool element = field.empty() || field.front() == '[';
  return element ? prefix + field : prefix + "." + field;
}

template <typename SomeLog>
Recording convert(SomeLog& log, const RecordingOptions& options) {
  Recording recording;
  recording.source = log.source;
  recording.frame = log.frame;
  recording.events = log.events;
  recording.parameters = log.parameters;
  recording.information = log.information;
  recording.information.emplace("format", log.format);
  add_damage(log, recording);
  std::set<std::string> unknown_units;
  std::map<std::string, int> seen;
  for (auto& topic : log.topics) {
    if (topic.schema) continue;
    if (options.keep_topic && !options.keep_topic(topic.name)) continue;
    // Two definitions of one name (a log of two firmwares) are kept separate.
    std::string prefix = topic.full_name();
    if (const int number = ++seen[prefix]; number > 1) prefix += fmt::format("~{}", number);
    for (auto& field : topic.fields) {
      if (field.values.is_text()) continue;
      const Unit unit = unit_of(field);
      if (unit.name == "1" && field.unit != "1") unknown_units.insert(field.unit);
      Channel channel;
      channel.name = channel_name(prefix, field.name);
      channel.unit = unit.si();
      channel.recorded_unit = field.unit;
      channel.time = topic.time;
      channel.value = field.values.numbers(unit.scale * field.scale, unit.offset);
      recording.add(std::move(channel));
      if constexpr (!std::is_const_v<SomeLog>) field.values = Column();
    }
  }
  if (!unknown_units.empty()) {
    recording.warnings.push_back(
        fmt::format("units not known and values left as they are: {}", fmt::join(unknown_units, ", ")));
  }
  return recording;
}

}  // namespace

const LogField* LogTopic::find(std::string_view field) const {
  for (const LogField& candidate : fields) {
    if (candidate.name == field) return &candidate;
  }
  return nullptr;
}

std::string LogTopic::full_name() const { return instance > 0 ? fmt::format("{}[{}]", name, instance) : name; }

const LogTopic* Log::find(std::string_view name, int instance) const {
  for (const LogTopic& topic : topics) {
    if (topic.name == name && topic.instance == instance) return &topic;
  }
  return nullptr;
}

std::size_t Log::count(std::string_view name) const {
  std::size_t rows = 0;
  for (const LogTopic& topic : topics) {
    if (topic.name == name) rows += topic.size();
  }
  return rows;
}

Recording to_recording(const Log& log, const RecordingOptions& options) { return convert(log, options); }

Recording to_recording(Log&& log, const RecordingOptions& options) { return convert(log, options); }

namespace internal {

std::string printable(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 ? (c != '\n' && c != '\t') : byte > 0x7e) c = '?';
  }
  return result;
}

void finish(Log& log) {
  drop_stray_last_rows(log);
  std::stable_sort(log.events.begin(), log.events.end(),
                   [](const Event& a, const Event& b) { return a.time < b.time; });
  const auto note = [&](std::size_t LogTopic::*member, std::string_view what) {
    std::size_t total = 0;
    std::vector<std::string> names;
    for (const LogTopic& topic : log.topics) {
      if (topic.schema || topic.*member == 0) continue;
      total += topic.*member;
      if (names.size() < 6) names.push_back(fmt::format("{} {}", topic.full_name(), topic.*member));
    }
    if (total > 0) log.damage.notes.push_back(fmt::format("{} samples {} ({})", total, what, fmt::join(names, ", ")));
  };
  note(&LogTopic::spikes, "dropped: their time stamps lie far off");
  note(&LogTopic::reordered, "were out of order in time and have been sorted");
  note(&LogTopic::doubled, "have the time stamp of the sample before");
}

}  // namespace internal
}  // namespace veridyn::io
