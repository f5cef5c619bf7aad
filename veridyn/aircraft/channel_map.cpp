#include "veridyn/aircraft/channel_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/aircraft/channel_rules.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> standard_names() {
  std::vector<std::string> names;
  for (const StandardChannel& channel : standard_channels()) names.push_back(channel.name);
  return names;
}

const StandardChannel& standard(std::string_view name) {
  const auto all = standard_channels();
  const auto found = std::find_if(all.begin(), all.end(), [&](const StandardChannel& c) { return c.name == name; });
  VERIDYN_ASSERT(found != all.end());
  return *found;
}

/// What came with a recording, without its channels.
Recording without_channels(const Recording& recording) {
  Recording result;
  result.source = recording.source;
  result.frame = recording.frame;
  result.events = recording.events;
  result.parameters = recording.parameters;
  result.information = recording.information;
  result.warnings = recording.warnings;
  return result;
}

/// Numbers as the log has them, in SI. Where the log's unit is of another kind than `unit` (volts of a vane,
/// microseconds of a servo) the recorded numbers are scaled and then are in `unit`.
std::vector<double> in_si(const Channel& raw, double zero, double scale, std::string_view unit) {
  const Unit given = parse_unit(unit);
  const bool keeps_unit = unit.empty() || (!raw.unit.same_dimension(Unit{}) && raw.unit.same_dimension(given));
  const Unit recorded = keeps_unit || raw.unit.same_dimension(Unit{}) ? Unit{} : parse_unit(raw.recorded_unit);
  std::vector<double> values(raw.value.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] =
        keeps_unit ? scale * (raw.value[i] - zero) : given.to_si(scale * (recorded.from_si(raw.value[i]) - zero));
  }
  return values;
}

std::vector<double> shifted(std::span<const double> stamps, double delay_s) {
  std::vector<double> result(stamps.begin(), stamps.end());
  for (double& t : result) t -= delay_s;
  return result;
}

/// One entry of the study's `[data.map]`.
void map_from_study(const Recording& log, const StudyTable& map, const std::string& name, MappedRecording& mapped) {
  const StandardChannel& target = standard(name);
  const auto source = [&](const StudyTable& table, std::string_view key, const std::string& channel) -> const Channel& {
    if (const Channel* found = log.find(channel)) return *found;
    table.fail(key, fmt::format("{} has no channel '{}'{}", log.source, channel, suggestion(channel, log.names())));
  };
  const auto finish = [&](TimeBase time, std::vector<double> values, std::string from) {
    const double rate = Channel{name, {}, "", time, values}.rate_Hz();
    mapped.recording.set(make_channel(name, target.unit, std::move(time), std::move(values)));
    std::erase_if(mapped.origins, [&](const ChannelOrigin& origin) { return origin.channel == name; });
    mapped.origins.push_back({name, std::move(from), rate, "mapped in the study"});
  };
  const auto check_dimension = [&](const StudyTable& table, std::string_view key, const Channel& raw,
                                   std::string_view unit) {
    const Unit actual = unit.empty() ? raw.unit : parse_unit(unit);
    const Unit expected = parse_unit(target.unit);
    if (actual.same_dimension(expected)) return;
    table.fail(
        key, fmt::format("channel '{}' is in [{}], but {} is in [{}]", raw.name, actual.si_name(), name, target.unit));
  };

  if (!map.is_table(name)) {
    const std::string channel = map.text(name);
    const Channel& raw = source(map, name, channel);
    check_dimension(map, name, raw, "");
    finish(raw.time, raw.value, channel);
    return;
  }
  const StudyTable entry = map.table(name);
  const std::string unit = entry.text_or("unit", "");
  if (!unit.empty()) {
    try {
      static_cast<void>(parse_unit_like(unit, parse_unit(target.unit)));
    } catch (const InputError& wrong) {
      entry.fail("unit", wrong.what());
    }
  }
  const double zero = entry.number_or("zero", "1", 0.0);
  const double scale = entry.number_or("scale", "1", 1.0);
  const double delay = entry.number_or("delay", "s", 0.0);
  TimeBase time;
  std::vector<double> values;
  std::string from;
  if (entry.has("switch")) {
    const std::string selector_name = entry.text("switch");
    const Channel& selector = source(entry, "switch", selector_name);
    const StudyTable cases = entry.table("cases");
    time = selector.time;
    values.assign(selector.size(), kNaN);
    std::vector<std::string> parts;
    for (const std::string& key : cases.keys()) {
      const std::string channel = cases.text(key);
      const Channel& raw = source(cases, key, channel);
      check_dimension(cases, key, raw, unit);
      const std::vector<double> at = internal::interpolated(
          Channel{raw.name, raw.unit, "", raw.time, in_si(raw, zero, scale, unit)}, selector.times());
      double number = 0.0;
      try {
        number = std::stod(key);
      } catch (const std::exception&) {
        cases.fail(key, "a case is a number that the switch channel takes");
      }
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (selector.value[i] == number) values[i] = at[i];
      }
      parts.push_back(fmt::format("{} when {} = {}", channel, selector_name, key));
    }
    from = fmt::format("{}", fmt::join(parts, ", "));
  } else if (entry.has("channels")) {
    const std::vector<std::string> names = entry.texts("channels");
    const std::vector<double> weights =
        entry.has("weights") ? entry.numbers("weights", "1")
                             : std::vector<double>(names.size(), 1.0 / static_cast<double>(names.size()));
    if (weights.size() != names.size())
      entry.fail("weights", fmt::format("has {} numbers for {} channels", weights.size(), names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Channel& raw = source(entry, "channels", names[i]);
      check_dimension(entry, "channels", raw, unit);
      const std::vector<double> si = in_si(raw, zero, scale, unit);
      if (i == 0) {
        time = raw.time;
        values.assign(si.size(), 0.0);
      }
      const std::vector<double> at =
          raw.time == time ? si : internal::interpolated(Channel{raw.name, raw.unit, "", raw.time, si}, *time);
      for (std::size_t k = 0; k < values.size(); ++k) values[k] += weights[i] * at[k];
    }
    from = fmt::format("{}", fmt::join(names, ", "));
  } else {
    from = entry.text("channel");
    const Channel& raw = source(entry, "channel", from);
    check_dimension(entry, "channel", raw, unit);
    time = raw.time;
    values = in_si(raw, zero, scale, unit);
  }
  if (delay != 0.0) time = make_time_base(shifted(*time, delay));
  finish(std::move(time), std::move(values), std::move(from));
}

}  // namespace

std::span<const StandardChannel> standard_channels() {
  static const std::vector<StandardChannel> channels{{"accel_x", "m/s^2"},
                                                     {"accel_y", "m/s^2"},
                                                     {"accel_z", "m/s^2"},
                                                     {"gyro_x", "rad/s"},
                                                     {"gyro_y", "rad/s"},
                                                     {"gyro_z", "rad/s"},
                                                     {"roll", "rad"},
                                                     {"pitch", "rad"},
                                                     {"yaw", "rad"},
                                                     {"vel_north", "m/s"},
                                                     {"vel_east", "m/s"},
                                                     {"vel_down", "m/s"},
                                                     {"lat", "rad"},
                                                     {"lon", "rad"},
                                                     {"alt", "m"},
                                                     {"pos_north", "m"},
                                                     {"pos_east", "m"},
                                                     {"pos_down", "m"},
                                                     {"airspeed", "m/s"},
                                                     {"dynamic_pressure", "Pa"},
                                                     {"static_pressure", "Pa"},
                                                     {"air_temperature", "K"},
                                                     {"air_density", "kg/m^3"},
                                                     {"alpha", "rad"},
                                                     {"beta", "rad"},
                                                     {"elevator", "rad"},
                                                     {"aileron", "rad"},
                                                     {"rudder", "rad"},
                                                     {"throttle", "1"},
                                                     {"thrust", "N"},
                                                     {"engine_speed", "rad/s"},
                                                     {"mag_x", "T"},
                                                     {"mag_y", "T"},
                                                     {"mag_z", "T"}};
  return channels;
}

MappedRecording map_channels(const Recording& log, const StudyTable& map, const SurfaceThrows& throws) {
  MappedRecording mapped;
  mapped.recording = without_channels(log);
  mapped.recording.frame = Frame::kFrd;
  if (log.frame == Frame::kFlu) {
    throw InputError(log.source, "its frame is flu (z up), an aircraft recording is frd (z down): convert it first");
  }
  mapped.log_kind = "study";
  for (const StandardChannel& target : standard_channels()) {
    const Channel* channel = log.find(target.name);
    if (channel == nullptr || map.has(target.name)) continue;
    const Unit expected = parse_unit(target.unit);
    if (!channel->unit.same_dimension(expected) && channel->unit.same_dimension(Unit{})) {
      mapped.notes.push_back(fmt::format("{} has no unit: write {}[{}] in the header, or map it with its unit",
                                         target.name, target.name, target.unit));
      continue;
    }
    if (!channel->unit.same_dimension(expected)) {
      throw InputError(log.source, fmt::format("channel '{}' is in [{}], expected [{}]", target.name,
                                               channel->unit.si_name(), target.unit));
    }
    mapped.recording.add(*channel);
    mapped.origins.push_back({target.name, target.name, channel->rate_Hz(), ""});
    mapped.log_kind = "standard names";
  }
  internal::MapBuilder builder(log, mapped);
  if (internal::is_ardupilot(log)) {
    mapped.log_kind = "ArduPilot";
    internal::map_ardupilot(builder, throws);
  } else if (internal::is_px4(log)) {
    mapped.log_kind = "PX4";
    internal::map_px4(builder, throws);
  }
  const std::vector<std::string> known = standard_names();
  std::vector<std::string> withdrawn;
  for (const std::string& name : map.keys()) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      map.fail(name, fmt::format("is not a standard channel{}", suggestion(name, known, known.size())));
    }
    if (map.is_text(name) && map.text(name) == "none") {
      std::erase_if(mapped.origins, [&](const ChannelOrigin& origin) { return origin.channel == name; });
      withdrawn.push_back(name);
      continue;
    }
    map_from_study(log, map, name, mapped);
  }
  if (withdrawn.empty()) return mapped;
  Recording kept = without_channels(mapped.recording);
  for (const Channel& channel : mapped.recording.channels()) {
    if (std::find(withdrawn.begin(), withdrawn.end(), channel.name) == withdrawn.end()) kept.add(channel);
  }
  mapped.recording = std::move(kept);
  return mapped;
}

void require_channels(const MappedRecording& mapped, std::span<const std::string> needed, std::string_view purpose) {
  std::vector<std::string> missing;
  for (const std::string& name : needed) {
    if (!mapped.recording.has(name)) missing.push_back(name);
  }
  if (missing.empty()) return;
  const std::vector<std::string> present = mapped.recording.names();
  throw InputError(
      mapped.recording.source,
      fmt::format("has no {} ({} log), which {} needed for {}; it has {}{}", fmt::join(missing, ", "), mapped.log_kind,
                  missing.size() == 1 ? "is" : "are", purpose,
                  present.empty() ? "no channel that can be used" : fmt::format("{}", fmt::join(present, ", ")),
                  mapped.notes.empty() ? "" : fmt::format(" ({})", fmt::join(mapped.notes, "; "))));
}

namespace internal {

void MapBuilder::apply(std::span<const ChannelRule> rules) {
  for (const ChannelRule& rule : rules) {
    if (mapped(rule.channel)) continue;
    const Channel* raw = alive(rule.source);
    if (raw == nullptr) continue;
    put(rule.channel, standard(rule.channel).unit, raw->time,
        in_si(*raw, 0.0, raw->unit.same_dimension(Unit{}) ? rule.scale : 1.0, rule.unit), rule.source, rule.note);
  }
}

void MapBuilder::put(std::string channel, std::string unit, TimeBase time, std::vector<double> value,
                     std::string source, std::string note) {
  Channel made = make_channel(std::move(channel), unit, std::move(time), std::move(value));
  mapped_.origins.push_back({made.name, std::move(source), made.rate_Hz(), std::move(note)});
  mapped_.recording.set(std::move(made));
}

void MapBuilder::note(std::string text) {
  if (std::find(mapped_.notes.begin(), mapped_.notes.end(), text) == mapped_.notes.end())
    mapped_.notes.push_back(std::move(text));
}

const Channel* MapBuilder::alive(std::string_view name) {
  const Channel* channel = log_.find(name);
  if (channel == nullptr) return nullptr;
  const auto first =
      std::find_if(channel->value.begin(), channel->value.end(), [](double v) { return std::isfinite(v); });
  if (first == channel->value.end()) {
    note(fmt::format("{} holds no numbers", name));
    return nullptr;
  }
  const bool changes =
      std::any_of(first, channel->value.end(), [&](double v) { return std::isfinite(v) && v != *first; });
  if (!changes && channel->size() > 1) {
    note(fmt::format("{} is {} throughout", name, *first));
    return nullptr;
  }
  return channel;
}

std::vector<double> interpolated(const Channel& channel, std::span<const double> at) {
  const auto times = channel.times();
  std::vector<double> result(at.size(), kNaN);
  std::size_t j = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    while (j + 1 < times.size() && times[j + 1] <= at[i]) ++j;
    if (times.empty() || at[i] < times.front() || at[i] > times.back()) continue;
    if (j + 1 >= times.size() || times[j + 1] == times[j]) {
      result[i] = channel.value[j];
      continue;
    }
    const double share = (at[i] - times[j]) / (times[j + 1] - times[j]);
    result[i] = share == 0.0 ? channel.value[j] : (1.0 - share) * channel.value[j] + share * channel.value[j + 1];
  }
  return result;
}

}  // namespace internal

}  // namespace veridyn::aircraft
