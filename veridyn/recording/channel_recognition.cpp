#include "veridyn/recording/channel_recognition.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/unit_spellings.hpp"
#include "veridyn/recording/gravity.hpp"

namespace veridyn::recording {
namespace {

/// Units that people write at the end of a name, the longest first.
constexpr std::pair<std::string_view, std::string_view> kSuffixes[] = {{"_deg_per_s", "deg/s"},
                                                                       {"_rad_per_s", "rad/s"},
                                                                       {"_deg_s", "deg/s"},
                                                                       {"_rad_s", "rad/s"},
                                                                       {"_degps", "deg/s"},
                                                                       {"_radps", "rad/s"},
                                                                       {"_m_s2", "m/s^2"},
                                                                       {"_mps2", "m/s^2"},
                                                                       {"_m_s_2", "m/s^2"},
                                                                       {"_ft_s", "ft/s"},
                                                                       {"_deg_sec", "deg/s"},
                                                                       {"_rad_sec", "rad/s"},
                                                                       {"_degrees", "deg"},
                                                                       {"_radians", "rad"},
                                                                       {"_knots", "kt"},
                                                                       {"_feet", "ft"},
                                                                       {"_mph", "mph"},
                                                                       {"_psi", "psi"},
                                                                       {"_lbf", "lbf"},
                                                                       {"_kpa", "kPa"},
                                                                       {"_dps", "deg/s"},
                                                                       {"_m_s", "m/s"},
                                                                       {"_mps", "m/s"},
                                                                       {"_fps", "ft/s"},
                                                                       {"_kmh", "km/h"},
                                                                       {"_kph", "km/h"},
                                                                       {"_kts", "kt"},
                                                                       {"_deg", "deg"},
                                                                       {"_rad", "rad"},
                                                                       {"_hpa", "hPa"},
                                                                       {"_rpm", "rpm"},
                                                                       {"_kt", "kt"},
                                                                       {"_ms2", "m/s^2"},
                                                                       {"_pa", "Pa"},
                                                                       {"_ft", "ft"},
                                                                       {"_g", "g"},
                                                                       {"_m", "m"}};

/// A name as aliases have it, and the unit at its end.
struct PlainName {
  std::string name;
  std::string unit;
};

PlainName plain_name(std::string_view text) {
  if (text.size() == 1) return {std::string(text), ""};
  const std::string small = lower(text);
  std::string_view rest = small;
  PlainName plain;
  for (const auto& [suffix, unit] : kSuffixes) {
    if (!rest.ends_with(suffix) || rest.size() == suffix.size()) continue;
    rest.remove_suffix(suffix.size());
    plain.unit = unit;
    break;
  }
  if (rest.size() == 1) {
    plain.name = text.substr(0, 1);
    return plain;
  }
  for (const char c : rest)
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain.name += c;
  if (plain.unit.empty() && plain.name.ends_with("rpm")) plain.unit = "rpm";
  return plain;
}

struct Spread {
  double low = kNaN, middle = kNaN, high = kNaN;
  [[nodiscard]] double largest() const { return std::fmax(std::abs(low), std::abs(high)); }
};

Spread spread_of(const Channel& channel) {
  std::vector<double> values;
  for (const double v : channel.value)
    if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return {};
  const auto [low, high] = std::ranges::minmax(values);
  return {low, upper_median(values), high};
}

/// A unit and how it is known; "?" with what it may be.
struct UnitGuess {
  std::string unit = "?";
  std::string why;
};

/// What the numbers alone say.
UnitGuess unit_by_numbers(const Channel& channel, const StandardChannel& target) {
  const Spread spread = spread_of(channel);
  const std::string range = fmt::format("{:.4g} to {:.4g}", spread.low, spread.high);
  // A turn, and a rate that gyroscopes of aircraft and cars do not reach (2000 deg/s).
  constexpr double kLargestAngle_rad = 6.6, kLargestRate_rad_s = 35.0;
  if (target.unit == "rad") {
    if (spread.largest() > kLargestAngle_rad) return {"deg", fmt::format("{}: beyond a turn in radians", range)};
    return {"?", fmt::format("{}: rad or deg?", range)};
  }
  if (target.unit == "rad/s") {
    if (spread.largest() > kLargestRate_rad_s) return {"deg/s", fmt::format("{}: too fast for rad/s", range)};
    return {"?", fmt::format("{}: rad/s or deg/s?", range)};
  }
  if (target.name == "accel_z") {
    const VerticalAcceleration up = vertical_acceleration(spread.middle, parse_unit(target.unit));
    if (up.holds == VerticalAcceleration::Holds::kGravity)
      return {up.unit.empty() ? target.unit : up.unit, fmt::format("its median of {:.4g} is gravity", spread.middle)};
  }
  if (target.unit == "m/s^2") return {"?", fmt::format("{}: m/s^2 or g?", range)};
  if (target.unit == "m/s") return {"?", fmt::format("{}: m/s, km/h or kt?", range)};
  if (target.name == "static_pressure" && spread.middle > 4e4 && spread.middle < 1.2e5)
    return {"Pa", fmt::format("{}: the atmosphere in pascal", range)};
  if (target.name == "static_pressure" && spread.middle > 400.0 && spread.middle < 1200.0)
    return {"hPa", fmt::format("{}: the atmosphere in hectopascal", range)};
  if (target.unit == "1") {
    if (spread.low >= 0.0 && spread.high <= 1.0) return {"1", fmt::format("{}: a share", range)};
    if (spread.low >= 0.0 && spread.high <= 100.0) return {"%", fmt::format("{}: percent", range)};
  }
  return {"?", range};
}

bool is_bare(const Channel& channel) {
  return channel.unit.same_dimension(Unit{}) && (channel.recorded_unit == "1" || channel.recorded_unit.empty());
}

/// The recognised channel, where its unit is of the right kind.
std::optional<RecognisedChannel> recognised(const Channel& channel, const StandardChannel& target,
                                            std::string_view suffix, const ChannelAlias& alias) {
  const Unit expected = parse_unit(target.unit);
  RecognisedChannel found{.channel = target.name,
                          .source = channel.name,
                          .unit = {},
                          .said = false,
                          .why = {},
                          .note = std::string(alias.note),
                          .open = alias.open,
                          .less = {}};
  if (!is_bare(channel)) {
    if (channel.unit.same_dimension(expected)) return found;
    found.unit = unit_meant(channel.recorded_unit, expected);
    found.said = true;
    found.why = fmt::format("the meaning of '{}' here", channel.recorded_unit);
    return found.unit == channel.recorded_unit ? std::nullopt : std::optional(found);
  }
  if (!suffix.empty()) {
    if (!parse_unit(suffix).same_dimension(expected)) return std::nullopt;
    found.unit = suffix;
    found.said = suffix.size() > 1;  // "_m" and "_g" may be other words' beginnings
    found.why = "by the end of its name";
    return found;
  }
  UnitGuess guess = unit_by_numbers(channel, target);
  found.unit = std::move(guess.unit);
  found.why = std::move(guess.why);
  return found;
}

/// Whether a channel bears a name.
bool bears(const PlainName& plain, const Channel& channel, std::string_view name) {
  if (plain.name == name || channel.name == name) return true;
  // "P (deg/s)" is no pressure; without a unit it may be.
  return name.size() == 1 && name.front() >= 'a' && name.front() <= 'z' && plain.name == upper(name) &&
         !is_bare(channel);
}

/// Channels of one naming have one unit: that of the vertical acceleration is known by gravity.
void share_unit_of_gravity(std::vector<RecognisedChannel>& found) {
  const auto vertical = std::ranges::find(found, "accel_z", &RecognisedChannel::channel);
  if (vertical == found.end() || vertical->unit.empty() || vertical->unit == "?") return;
  const std::string unit = vertical->unit;
  for (RecognisedChannel& one : found) {
    if ((one.channel != "accel_x" && one.channel != "accel_y") || one.unit != "?") continue;
    one.unit = unit;
    one.why = fmt::format("as {}, of which the median is gravity", vertical->source);
  }
}

/// A name in a comment, which ends with its line.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
  return text;
}

/// "# words: a, b, c", wrapped.
std::string listed(std::string_view words, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  constexpr std::size_t kNamesShown = 120, kWidth = 110;
  std::string text, line = fmt::format("# {}:", words);
  for (std::size_t i = 0; i < std::min(names.size(), kNamesShown); ++i) {
    const std::string word = fmt::format(" {}{}", on_one_line(names[i]), i + 1 < names.size() ? "," : "");
    if (line.size() + word.size() > kWidth) {
      text += line + '\n';
      line = "#  ";
    }
    line += word;
  }
  text += line + '\n';
  if (names.size() > kNamesShown)
    text += fmt::format("#   and {} more: `veridyn inspect` lists them\n", names.size() - kNamesShown);
  return text;
}

}  // namespace

Recognition recognise_channels(const Recording& log, const MappedRecording& mapped,
                               std::span<const StandardChannel> standard, std::span<const ChannelAlias> aliases) {
  Recognition result;
  std::set<std::string> taken;
  for (const ChannelOrigin& origin : mapped.origins) taken.insert(origin.source);
  std::vector<std::pair<PlainName, const Channel*>> channels;
  for (const Channel& channel : log.channels()) channels.emplace_back(plain_name(channel.name), &channel);
  for (const StandardChannel& target : standard) {
    if (mapped.recording.has(target.name)) continue;
    std::vector<ChannelAlias> names{{target.name, target.name}};
    const std::string plain = plain_name(target.name).name;
    names.push_back({plain, target.name});
    std::copy_if(aliases.begin(), aliases.end(), std::back_inserter(names),
                 [&](const ChannelAlias& alias) { return alias.channel == target.name; });
    const auto first_called = [&](std::string_view name, const ChannelAlias& alias) {
      std::optional<RecognisedChannel> found;
      for (const auto& [own, channel] : channels) {
        if (!found && !taken.contains(channel->name) && bears(own, *channel, name))
          found = recognised(*channel, target, own.unit, alias);
      }
      return found;
    };
    std::optional<RecognisedChannel> found;
    for (const ChannelAlias& alias : names) {
      if (found) break;
      found = first_called(alias.name, alias);
      if (!found || alias.less.empty()) continue;
      const std::optional<RecognisedChannel> other = first_called(alias.less, alias);
      if (!other || other->unit != found->unit) {
        found.reset();
        continue;
      }
      found->less = other->source;
    }
    if (!found) continue;
    taken.insert(found->source);
    if (!found->less.empty()) taken.insert(found->less);
    result.found.push_back(std::move(*found));
  }
  share_unit_of_gravity(result.found);
  for (const Channel& channel : log.channels())
    if (!taken.contains(channel.name)) result.others.push_back(channel.name);
  return result;
}

MappedRecording with_recognised_channels(MappedRecording mapped, const Recording& log,
                                         std::span<const StandardChannel> standard,
                                         std::span<const ChannelAlias> aliases, const StudyTable& map) {
  std::vector<std::string> without_unit;
  for (const RecognisedChannel& one : recognise_channels(log, mapped, standard, aliases).found) {
    if (map.has(one.channel)) continue;
    if (one.open) {
      mapped.notes.push_back(fmt::format("{} may be {} ({}): not taken; {} = \"{}\" in [data.map] takes it", one.source,
                                         one.channel, one.note, one.channel, one.source));
      continue;
    }
    const auto target = std::ranges::find(standard, one.channel, &StandardChannel::name);
    const Channel& raw = log.at(one.source);
    const std::string unit = one.unit.empty() || one.said ? one.unit : declared_unit(map, *target);
    if (!one.unit.empty() && unit.empty()) {
      if (one.source != one.channel) without_unit.push_back(fmt::format("{} ({})", one.source, one.channel));
      continue;
    }
    std::string note = "by its name";
    if (!unit.empty())
      note +=
          one.said ? fmt::format(", in {}: {}", unit, one.why) : fmt::format(", in {}, as the study declares", unit);
    if (!one.note.empty()) note += ", " + one.note;
    std::vector<double> values = in_si(raw, 0.0, 1.0, unit);
    if (!one.less.empty()) {
      const Channel& less = log.at(one.less);
      const std::vector<double> other =
          interpolated({one.less, {}, "", less.time, in_si(less, 0.0, 1.0, unit)}, *raw.time);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5 * (values[i] - other[i]);
    }
    mapped.recording.add(make_channel(one.channel, target->unit, raw.time, std::move(values)));
    const std::string from = one.less.empty() ? one.source : fmt::format("{}, {}", one.source, one.less);
    mapped.origins.push_back({one.channel, from, raw.rate_Hz(), std::move(note)});
  }
  if (!without_unit.empty()) {
    mapped.notes.push_back(
        fmt::format("known by their names, but without a unit and so not taken: {}; declare units = "
                    "[\"deg\", \"deg/s\", ...] or \"SI\" in [data.map], or map each with its unit",
                    fmt::join(without_unit, ", ")));
  }
  return mapped;
}

std::string map_section(const Recording& log, const MappedRecording& mapped, std::span<const StandardChannel> standard,
                        std::span<const ChannelAlias> aliases) {
  const Recognition recognition = recognise_channels(log, mapped, standard, aliases);
  std::string text;
  if (!mapped.origins.empty()) text += fmt::format("# Mapped by themselves ({}):\n", mapped.log_kind);
  for (const ChannelOrigin& origin : mapped.origins) {
    text += fmt::format("#   {} <- {} ({:.3g} Hz){}\n", origin.channel, on_one_line(origin.source), origin.rate_Hz,
                        origin.note.empty() ? "" : ", " + origin.note);
  }
  std::vector<std::string> left;
  for (const ChannelOrigin& other : mapped.left)
    left.push_back(fmt::format("{} ({:.3g} Hz, {} too)", other.source, other.rate_Hz, other.channel));
  text += listed("left", left);
  if (!recognition.found.empty())
    text += "# Recognised by their names; confirm each, and the unit that the log does not say:\n";
  for (const RecognisedChannel& one : recognition.found) {
    const std::string unit = one.unit.empty() ? std::string() : fmt::format(", unit = {}", toml_text(one.unit));
    std::string line = fmt::format("{} = {{ channel = {}{} }}", one.channel, toml_text(one.source), unit);
    if (unit.empty()) line = fmt::format("{} = {}", one.channel, toml_text(one.source));
    if (!one.less.empty()) {
      line = fmt::format("{} = {{ channels = [{}, {}], weights = [0.5, -0.5]{} }}", one.channel, toml_text(one.source),
                         toml_text(one.less), unit);
    }
    if (one.open) line.insert(0, "# ");  // to be decided by its user
    std::string comment = one.why;
    if (one.unit.empty()) comment = fmt::format("in {}", log.at(one.source).recorded_unit);
    if (!one.note.empty()) comment += (comment.empty() ? "" : "; ") + one.note;
    text += fmt::format("{:<58} # {}\n", line, on_one_line(comment));
  }
  std::vector<std::string> missing;
  for (const StandardChannel& target : standard) {
    const bool found =
        std::ranges::find(recognition.found, target.name, &RecognisedChannel::channel) != recognition.found.end();
    if (!found && !mapped.recording.has(target.name)) missing.push_back(target.name);
  }
  for (const std::string& note : mapped.notes) text += fmt::format("# note: {}\n", on_one_line(note));
  text += listed("not found", missing);
  return text + listed("channels of the log that were not recognised", recognition.others);
}

}  // namespace veridyn::recording
