#include "veridyn/recording/channel_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/unit_spellings.hpp"

namespace veridyn::recording {
namespace {

/// The key of `[data.map]` that is no channel.
constexpr const char* kUnits = "units";

std::vector<double> shifted(std::span<const double> stamps, double delay_s) {
  std::vector<double> result(stamps.begin(), stamps.end());
  for (double& t : result) t -= delay_s;
  return result;
}

/// The standard channel of this name; the study is refused where there is none.
const StandardChannel& standard_channel(const StudyTable& map, const std::string& name,
                                        std::span<const StandardChannel> standard) {
  std::vector<std::string> known;
  for (const StandardChannel& channel : standard) {
    if (channel.name == name) return channel;
    known.push_back(channel.name);
  }
  map.fail(name, fmt::format("is not a standard channel{}", suggestion(name, known, known.size())));
}

/// What an entry of `[data.map]` makes of the log's channels.
struct MappedValues {
  TimeBase time;
  std::vector<double> values;
  std::string from;  ///< in words
};

/// How a standard channel is made. Study table `[data.map.CHANNEL]`.
struct MapEntry {
  std::string channel, selector;
  std::vector<std::string> channels;
  std::vector<double> weights;
  StudyTable cases = StudyTable();
  std::string unit;  ///< empty: that of the channel
  double zero = 0.0, scale = 1.0, delay_s = 0.0;
};

void check_entry(const StudyTable& table, MapEntry& entry) {
  std::string source;
  for (const char* key : {"channel", "channels", "switch"}) {
    if (!table.has(key)) continue;
    if (!source.empty()) table.fail(key, fmt::format("and {} exclude each other", source));
    source = key;
  }
  if (source != "channels" && table.has("weights")) table.fail("weights", "are of several channels");
  if ((source == "switch") != table.has("cases"))
    table.fail("cases", source == "switch" ? "are missing: which channel it selects" : "are of a switch");
  if (table.has("weights") && entry.weights.size() != entry.channels.size())
    table.fail("weights", fmt::format("has {} numbers for {} channels", entry.weights.size(), entry.channels.size()));
}

const KeyTable<MapEntry>& entry_keys() {
  using M = MapEntry;
  static const auto table =
      KeyTable<M>(
          "CHANNEL",
          "A standard channel that is not a channel of the log as it is: scale (raw - zero), of one channel, of "
          "several or of those that a switch selects.")
          .text("channel", &M::channel, "of the log")
          .texts("channels", &M::channels, "or several, whose weighted sum is taken")
          .numbers("weights", &M::weights, "1", kAnyNumber, "of these")
          .otherwise("their mean")
          .text("switch", &M::selector, "or a channel that selects others")
          .other({"cases", "", "`{ 1 = \"de_in\", 2 = \"de\" }`", "",
                  "the channel for each value of the switch; other values leave a gap", true},
                 [](const StudyTable& t, const std::string& key, M& m) {
                   m.cases = t.table(key);
                   for (const std::string& value : m.cases.keys()) static_cast<void>(m.cases.text(value));
                 })
          .text("unit", &M::unit, "of the result")
          .otherwise("that of the log's channel")
          .number("zero", &M::zero, "1", kAnyNumber, "taken off the raw number")
          .number("scale", &M::scale, "1", kAnyNumber, "factor, applied after `zero` is subtracted")
          .number("delay", &M::delay_s, "s", kAnyNumber, "how late the sensor reports; taken off its stamps")
          .check(check_entry);
  return table;
}

MapEntry read_entry(const StudyTable& table, const StandardChannel& target) {
  MapEntry entry = entry_keys().read(table);
  if (entry.unit.empty()) return entry;
  try {
    const Unit expected = parse_unit(target.unit);
    static_cast<void>(parse_unit_like(entry.unit, expected));
    entry.unit = unit_meant(entry.unit, expected);
  } catch (const InputError& wrong) {
    table.fail("unit", wrong.what());
  }
  return entry;
}

const Channel& source_of(const Recording& log, const StudyTable& table, std::string_view key,
                         const std::string& channel) {
  if (const Channel* found = log.find(channel)) return *found;
  table.fail(key, fmt::format("{} has no channel '{}'{}", log.source, channel, suggestion(channel, log.names())));
}

/// Where the log's unit has two meanings, the one that the channel needs; empty: as the log has it.
std::string other_meaning(const Channel& raw, const StandardChannel& target) {
  const Unit expected = parse_unit(target.unit);
  if (raw.unit.same_dimension(expected)) return {};
  const std::string meant = unit_meant(raw.recorded_unit, expected);
  return meant == raw.recorded_unit ? std::string() : meant;
}

void check_dimension(const StudyTable& table, std::string_view key, const Channel& raw, std::string_view unit,
                     const StandardChannel& target) {
  const Unit actual = unit.empty() ? raw.unit : parse_unit(unit);
  if (actual.same_dimension(parse_unit(target.unit))) return;
  table.fail(key, fmt::format("channel '{}' is in [{}], but {} is in [{}]", raw.name, actual.si_name(), target.name,
                              target.unit));
}

/// The channel that another one, the switch, selects at each moment.
MappedValues switched(const Recording& log, const StudyTable& table, const MapEntry& entry,
                      const StandardChannel& target) {
  const Channel& selector = source_of(log, table, "switch", entry.selector);
  const StudyTable& cases = entry.cases;
  MappedValues out{.time = selector.time, .values = std::vector<double>(selector.size(), kNaN), .from = {}};
  std::vector<std::string> parts;
  for (const std::string& key : cases.keys()) {
    const std::string channel = cases.text(key);
    const Channel& raw = source_of(log, cases, key, channel);
    check_dimension(cases, key, raw, entry.unit, target);
    const std::vector<double> at = interpolated(
        Channel{raw.name, raw.unit, "", raw.time, in_si(raw, entry.zero, entry.scale, entry.unit)}, selector.times());
    double number = 0.0;
    try {
      number = std::stod(key);
    } catch (const std::exception&) {
      cases.fail(key, "a case is a number that the switch channel takes");
    }
    for (std::size_t i = 0; i < out.values.size(); ++i) {
      if (selector.value[i] == number) out.values[i] = at[i];
    }
    parts.push_back(fmt::format("{} when {} = {}", channel, entry.selector, key));
  }
  out.from = fmt::format("{}", fmt::join(parts, ", "));
  return out;
}

/// The weighted sum of several channels, by default their mean.
MappedValues weighted_sum(const Recording& log, const StudyTable& table, const MapEntry& entry,
                          const StandardChannel& target) {
  const std::vector<std::string>& names = entry.channels;
  const std::vector<double> weights = entry.weights.empty()
                                          ? std::vector<double>(names.size(), 1.0 / static_cast<double>(names.size()))
                                          : entry.weights;
  MappedValues out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Channel& raw = source_of(log, table, "channels", names[i]);
    check_dimension(table, "channels", raw, entry.unit, target);
    const std::vector<double> si = in_si(raw, entry.zero, entry.scale, entry.unit);
    if (i == 0) {
      out.time = raw.time;
      out.values.assign(si.size(), 0.0);
    }
    const std::vector<double> at =
        raw.time == out.time ? si : interpolated(Channel{raw.name, raw.unit, "", raw.time, si}, *out.time);
    for (std::size_t k = 0; k < out.values.size(); ++k) out.values[k] += weights[i] * at[k];
  }
  out.from = fmt::format("{}", fmt::join(names, ", "));
  return out;
}

/// One entry of the study's `[data.map]`.
MappedValues map_from_study(const Recording& log, const StudyTable& map, const StandardChannel& target) {
  if (!map.is_table(target.name)) {
    const std::string channel = map.text(target.name);
    const Channel& raw = source_of(log, map, target.name, channel);
    const bool bare = raw.unit.same_dimension(Unit{}) && raw.recorded_unit == "1";
    const std::string unit = bare ? declared_unit(map, target) : other_meaning(raw, target);
    check_dimension(map, target.name, raw, unit, target);
    return {raw.time, in_si(raw, 0.0, 1.0, unit), channel};
  }
  const StudyTable table = map.table(target.name);
  const MapEntry entry = read_entry(table, target);
  MappedValues out;
  if (!entry.selector.empty()) {
    out = switched(log, table, entry, target);
  } else if (!entry.channels.empty()) {
    out = weighted_sum(log, table, entry, target);
  } else {
    if (entry.channel.empty()) table.fail("channel", "is missing: give channel, channels or switch");
    out.from = entry.channel;
    const Channel& raw = source_of(log, table, "channel", out.from);
    const std::string unit = entry.unit.empty() ? other_meaning(raw, target) : entry.unit;
    check_dimension(table, "channel", raw, unit, target);
    out.time = raw.time;
    out.values = in_si(raw, entry.zero, entry.scale, unit);
  }
  if (entry.delay_s != 0.0) out.time = make_time_base(shifted(*out.time, entry.delay_s));
  return out;
}

}  // namespace

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

MappedRecording with_standard_channels(MappedRecording mapped, const Recording& log,
                                       std::span<const StandardChannel> standard, const StudyTable& map) {
  for (const StandardChannel& target : standard) {
    const Channel* channel = log.find(target.name);
    if (channel == nullptr || map.has(target.name)) continue;
    const Unit expected = parse_unit(target.unit);
    if (!channel->unit.same_dimension(expected) && channel->unit.same_dimension(Unit{})) {
      const std::string unit = declared_unit(map, target);
      if (unit.empty()) {
        mapped.notes.push_back(
            fmt::format("{} has no unit: write {}[{}] in the header, or map it with its unit, or "
                        "declare units = [...] in [data.map]",
                        target.name, target.name, target.unit));
        continue;
      }
      mapped.recording.add(make_channel(target.name, target.unit, channel->time, in_si(*channel, 0.0, 1.0, unit)));
      mapped.origins.push_back(
          {target.name, target.name, channel->rate_Hz(), fmt::format("in {}, as the study declares", unit)});
      mapped.log_kind = "standard names";
      continue;
    }
    if (const std::string meant = other_meaning(*channel, target); !meant.empty()) {
      mapped.recording.add(make_channel(target.name, target.unit, channel->time, in_si(*channel, 0.0, 1.0, meant)));
      mapped.origins.push_back({target.name, target.name, channel->rate_Hz(), fmt::format("in {}", meant)});
      mapped.log_kind = "standard names";
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
  return mapped;
}

std::string declared_unit(const StudyTable& map, const StandardChannel& target) {
  if (!map.has(kUnits)) return {};
  if (map.is_text(kUnits) && map.text(kUnits) == "SI") return target.unit;
  for (const std::string& unit : map.texts(kUnits)) {
    try {
      const Unit expected = parse_unit(target.unit);
      if (parse_unit(unit_meant(unit, expected)).same_dimension(expected)) return unit_meant(unit, expected);
    } catch (const InputError& wrong) {
      map.fail(kUnits, wrong.what());
    }
  }
  return {};
}

void check_channel_map(const StudyTable& map, std::span<const StandardChannel> standard) {
  for (const std::string& name : map.keys()) {
    if (name == kUnits) {
      static_cast<void>(declared_unit(map, {"", "1"}));
      continue;
    }
    static_cast<void>(standard_channel(map, name, standard));
    if (!map.is_table(name)) {
      static_cast<void>(map.text(name));
      continue;
    }
    static_cast<void>(entry_keys().read(map.table(name)));
  }
}

const KeyTable<ChannelMap>& ChannelMap::keys() {
  static const auto table =
      KeyTable<ChannelMap>("map",
                           "Which channel of the log is which standard one, `airspeed = \"ARSP.Airspeed\"`; a table "
                           "says how it is made, and `\"none\"` takes a channel away.")
          .other({kUnits, "", "`[\"deg\", \"deg/s\", \"kt\"]`, or `\"SI\"`", "none",
                  "units for channels without one in the log: each gets the listed unit of its dimension", true},
                 [](const StudyTable& t, const std::string&, ChannelMap&) {
                   static_cast<void>(declared_unit(t, {"", "1"}));
                 })
          // Which names there may be, only the domain knows: `with_channel_map`.
          .within("CHANNEL", entry_keys(), [](const StudyTable&, ChannelMap&) {});
  return table;
}

MappedRecording with_channel_map(MappedRecording mapped, const Recording& log,
                                 std::span<const StandardChannel> standard, const StudyTable& map) {
  std::vector<std::string> withdrawn;
  static_cast<void>(declared_unit(map, {"", "1"}));
  for (const std::string& name : map.keys()) {
    if (name == kUnits) continue;
    const StandardChannel& channel = standard_channel(map, name, standard);
    if (map.is_text(name) && map.text(name) == "none") {
      std::erase_if(mapped.origins, [&](const ChannelOrigin& origin) { return origin.channel == name; });
      withdrawn.push_back(name);
      continue;
    }
    MappedValues made = map_from_study(log, map, channel);
    const double rate = Channel{name, {}, "", made.time, made.values}.rate_Hz();
    mapped.recording.set(make_channel(name, channel.unit, std::move(made.time), std::move(made.values)));
    std::erase_if(mapped.origins, [&](const ChannelOrigin& origin) { return origin.channel == name; });
    mapped.origins.push_back({name, std::move(made.from), rate, "mapped in the study"});
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

}  // namespace veridyn::recording
