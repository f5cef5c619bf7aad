#include "veridyn/recording/channel_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::recording {
namespace {

std::vector<double> shifted(std::span<const double> stamps, double delay_s) {
  std::vector<double> result(stamps.begin(), stamps.end());
  for (double& t : result) t -= delay_s;
  return result;
}

/// One entry of the study's `[data.map]`.
void map_from_study(const Recording& log, const StudyTable& map, const StandardChannel& target,
                    MappedRecording& mapped) {
  const std::string& name = target.name;
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
      const std::vector<double> at =
          interpolated(Channel{raw.name, raw.unit, "", raw.time, in_si(raw, zero, scale, unit)}, selector.times());
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
          raw.time == time ? si : interpolated(Channel{raw.name, raw.unit, "", raw.time, si}, *time);
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

void keep_standard_channels(const Recording& log, std::span<const StandardChannel> standard, const StudyTable& map,
                            MappedRecording& mapped) {
  for (const StandardChannel& target : standard) {
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
}

void apply_channel_map(const Recording& log, std::span<const StandardChannel> standard, const StudyTable& map,
                       MappedRecording& mapped) {
  std::vector<std::string> known;
  for (const StandardChannel& channel : standard) known.push_back(channel.name);
  std::vector<std::string> withdrawn;
  for (const std::string& name : map.keys()) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) {
      map.fail(name, fmt::format("is not a standard channel{}", suggestion(name, known, known.size())));
    }
    if (map.is_text(name) && map.text(name) == "none") {
      std::erase_if(mapped.origins, [&](const ChannelOrigin& origin) { return origin.channel == name; });
      withdrawn.push_back(name);
      continue;
    }
    map_from_study(log, map, standard[static_cast<std::size_t>(at - known.begin())], mapped);
  }
  if (withdrawn.empty()) return;
  Recording kept = without_channels(mapped.recording);
  for (const Channel& channel : mapped.recording.channels()) {
    if (std::find(withdrawn.begin(), withdrawn.end(), channel.name) == withdrawn.end()) kept.add(channel);
  }
  mapped.recording = std::move(kept);
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
