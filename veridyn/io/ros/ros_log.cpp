#include "veridyn/io/ros/ros_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/ros/message_clock.hpp"
#include "veridyn/io/ros/message_cursor.hpp"
#include "veridyn/io/ros/message_definition.hpp"
#include "veridyn/io/ulog/px4_units.hpp"

namespace veridyn::io::internal {
namespace {

constexpr std::size_t kMostTopics = 4096, kMostTransforms = 1000, kListed = 8;
/// Fewer messages on another clock than these are latched ones, from before the recording.
constexpr std::size_t kMessagesToNote = 10;

double seconds(Nanoseconds ns) { return 1e-9 * static_cast<double>(ns); }

/// "2024-05-03", UTC; empty where the clock does not count from 1970.
std::string date_of(Nanoseconds ns) {
  using namespace std::chrono;
  const year_month_day day(floor<days>(sys_time<nanoseconds>(nanoseconds(ns))));
  const int year = static_cast<int>(day.year());
  if (year < 2000 || year > 2100) return {};
  return fmt::format("{:04}-{:02}-{:02}", year, static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
}

/// A definition of messages, or why there is none.
std::optional<RosLayout> layout_of(const RosTopic& topic, RosEncoding encoding, std::string& obstacle) {
  const bool text = topic.schema_encoding == "ros2msg" || topic.schema_encoding == "ros1msg";
  std::optional<RosDefinitions> definitions;
  if (text && !topic.schema.empty()) {
    definitions = parse_ros_definitions(topic.type, topic.schema);
  } else {
    definitions.emplace();
    definitions->root = plain_ros_type(topic.type);
  }
  std::optional<RosLayout> layout;
  if (definitions) layout = ros_layout(*definitions, encoding);
  if (!layout) {
    obstacle = text && !topic.schema.empty() ? "its definition cannot be understood"
               : topic.schema_encoding.empty()
                   ? "the recording holds no definition of it"
                   : fmt::format("its definition is in {}", one_line(topic.schema_encoding, 20));
  }
  return layout;
}

/// NaN in the rows where a field says that others hold nothing; without the field nothing happens. Fields that never
/// hold anything are taken away.
void blank(std::vector<LogField>& fields, std::string_view which, const std::vector<bool>& none) {
  const bool never = std::ranges::all_of(none, [](bool n) { return n; });
  if (never) {
    std::erase_if(fields, [&](const LogField& field) { return field.name.starts_with(which); });
    return;
  }
  if (std::ranges::none_of(none, [](bool n) { return n; })) return;
  for (LogField& field : fields) {
    if (!field.name.starts_with(which)) continue;
    std::vector<double> values = field.values.numbers();
    for (std::size_t i = 0; i < values.size(); ++i)
      if (none[i]) values[i] = kNaN;
    field.values = Column(std::move(values));
  }
}

/// What a message says it does not hold: -1 as the first covariance of an Imu, a NavSatFix without a fix.
void blank_absent(std::string_view type, std::vector<LogField>& fields,
                  const std::map<std::string, std::string>& constants) {
  const std::size_t rows = fields.empty() ? 0 : fields.front().values.size();
  const auto rows_where = [&](std::string_view name, auto&& absent) {
    std::vector<bool> none(rows, false);
    for (const LogField& field : fields)
      for (std::size_t i = 0; field.name == name && i < rows; ++i) none[i] = absent(field.values.number(i));
    return none;
  };
  if (type == "sensor_msgs/Imu") {
    for (const char* part : {"orientation", "angular_velocity", "linear_acceleration"}) {
      const std::string covariance = std::string(part) + "_covariance";
      std::vector<bool> none = rows_where(covariance + "[0]", [](double v) { return v == -1.0; });
      const auto constant = constants.find(covariance);
      if (constant != constants.end() && constant->second.starts_with("-1 ")) none.assign(rows, true);
      blank(fields, std::string(part) + '.', none);
    }
  } else if (type == "sensor_msgs/NavSatFix") {
    const std::vector<bool> none = rows_where("status.status", [](double v) { return v < 0.0; });
    for (const char* part : {"latitude", "longitude", "altitude"}) blank(fields, part, none);
  }
}

bool is_px4_type(std::string_view type) { return type.starts_with("px4_msgs/"); }

/// Without the slash ahead. What PX4 sends has the names of its ULogs: "vehicle_attitude" of
/// "/fmu/out/vehicle_attitude_v1".
std::string topic_name(const RosTopic& topic) {
  std::string name = one_line(std::string_view(topic.name).substr(topic.name.starts_with('/') ? 1 : 0));
  constexpr std::string_view kSent = "fmu/out/";
  const std::size_t sent = name.rfind(kSent);
  if (!is_px4_type(topic.type) || sent == std::string::npos) return name;
  name.erase(0, sent + kSent.size());
  const std::size_t version = name.rfind("_v");
  if (version != std::string::npos && version + 2 < name.size() &&
      name.find_first_not_of("0123456789", version + 2) == std::string::npos)
    name.resize(version);
  return name;
}

std::string listed(const std::vector<std::string>& all) {
  const std::size_t shown = std::min(all.size(), kListed);
  std::string text = fmt::format("{}", fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (all.size() > shown) text += fmt::format(" and {} more", all.size() - shown);
  return text;
}

}  // namespace

std::string one_line(std::string_view text, std::size_t longest) {
  std::string result = printable(text.substr(0, longest));
  std::ranges::replace_if(
      result, [](char c) { return c == '\n' || c == '\t'; }, '?');
  return result;
}

std::size_t RosLog::topic(const RosTopic& topic) {
  const auto known = std::ranges::find(entries_, topic, &Entry::described);
  if (known != entries_.end()) return static_cast<std::size_t>(known - entries_.begin());
  if (entries_.size() >= kMostTopics) return kNoTopic;
  Entry entry;
  entry.described = topic;
  entry.name = topic_name(topic);
  const bool ros1 = topic.encoding == "ros1";
  if (topic.encoding != "cdr" && !ros1) {
    entry.obstacle = fmt::format("its messages are in {}", one_line(topic.encoding, 20));
  } else if (entry.name.ends_with("tf_static") && plain_ros_type(topic.type) == "tf2_msgs/TFMessage") {
    entry.transforms = true;
  } else {
    const RosEncoding encoding = ros1 ? RosEncoding::kRos1 : RosEncoding::kCdr;
    std::optional<RosLayout> layout = layout_of(topic, encoding, entry.obstacle);
    if (layout) entry.table.emplace(*std::move(layout), encoding);
  }
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

void RosLog::add(std::size_t topic, Nanoseconds logged, std::string_view payload) {
  if (messages_ == 0) first_ = logged;
  const std::uint64_t place = messages_++;
  restarts_.add(seconds(logged), place);
  if (topic == kNoTopic) return;
  Entry& entry = entries_[topic];
  ++entry.messages;
  if (entry.table) {
    entry.restarts.add(seconds(logged), place);
    if (!entry.table->add(payload, logged, place)) ++entry.lost;
  } else if (entry.transforms) {
    take_transforms(payload, entry.described.encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr);
  }
}

void RosLog::take_transforms(std::string_view payload, RosEncoding encoding) {
  bool swapped = false;
  if (encoding == RosEncoding::kCdr) {
    if (payload.size() < 4) return;
    swapped = payload[1] == 0;
    payload.remove_prefix(4);
  }
  MessageCursor cursor(payload, encoding, swapped);
  const std::uint32_t count = cursor.count();
  for (std::uint32_t i = 0; i < count && !cursor.failed(); ++i) {
    if (encoding == RosEncoding::kRos1) (void)cursor.count();  // of headers
    (void)cursor.count(), (void)cursor.count();                // stamp
    const std::string parent = one_line(cursor.text()), child = one_line(cursor.text());
    std::string numbers;
    for (int k = 0; k < 7; ++k) numbers += fmt::format("{}{:.17g}", k == 0 ? "" : " ", cursor.real());
    if (cursor.failed() || transforms_.size() >= kMostTransforms || parent.size() + child.size() > 200) continue;
    transforms_[fmt::format("transform {} to {}", parent, child)] = numbers;
  }
}

void RosLog::finish(Log& log) {
  restarts_.finish();
  // Files may hold one topic after the other: the clock goes back only where it does so within a topic.
  const bool restarts = std::ranges::any_of(entries_, [](Entry& entry) {
    entry.restarts.finish();
    return entry.restarts.shift_at(UINT64_MAX) != 0.0;
  });
  if (!restarts) restarts_ = {};
  log.frame = Frame::kFrd;  // PX4's own
  for (Entry& entry : entries_) {
    log.damage.records_lost += entry.lost;
    if (!entry.table || entry.table->rows() == 0) continue;
    describe(entry, log);
    if (!is_px4_type(entry.described.type)) log.frame = Frame::kFlu;
    log.topics.push_back(made_topic(entry, log));
  }
  log.information.insert(transforms_.begin(), transforms_.end());
  if (const std::string date = date_of(first_); messages_ > 0 && !date.empty()) log.information["date"] = date;
  note_obstacles(log);
  if (log.topics.empty()) {
    throw InputError(log.source, log.damage.notes.empty()
                                     ? std::string("holds no messages")
                                     : "holds no messages that can be read; " + log.damage.notes.back());
  }
  if (!moved_.empty())
    log.damage.notes.push_back(fmt::format(
        "stamps on another clock than the log's, moved so that the least delay is none: {}", listed(moved_)));
  if (!without_stamp_.empty())
    log.damage.notes.push_back(fmt::format(
        "messages without a stamp, which have the time at which they were logged: {}", listed(without_stamp_)));
  restarts_.report_to(log);
  for (double& t : log.restarts) t -= seconds(first_);
  *this = RosLog();
}

LogTopic RosLog::made_topic(Entry& entry, Log& log) {
  MessageTable& table = *entry.table;
  LogTopic topic;
  topic.name = entry.name;
  MessageTimes moments = message_times(table.stamps(), table.logged());
  if (table.layout().has_stamp && moments.without_stamp > 0)
    without_stamp_.push_back(fmt::format("{} of {}", moments.without_stamp, entry.name));
  if (moments.moved >= kMessagesToNote)
    moved_.push_back(fmt::format("{} ({:.6g} s away)", entry.name, std::abs(seconds(moments.moved_by))));
  std::vector<double> stamps;
  stamps.reserve(moments.times.size());
  for (const Nanoseconds t : moments.times)
    stamps.push_back(
        seconds(static_cast<Nanoseconds>(static_cast<std::uint64_t>(t) - static_cast<std::uint64_t>(first_))));
  moments = {};
  restarts_.shift(stamps, table.places());
  OrderedStamps ordered = order_stamps(std::move(stamps));
  topic.spikes = ordered.spikes;
  topic.reordered = ordered.reordered;
  topic.doubled = ordered.doubled;
  std::map<std::string, std::string> constants;
  topic.fields = table.take_fields(constants);
  blank_absent(plain_ros_type(entry.described.type), topic.fields, constants);
  if (is_px4_type(entry.described.type)) {
    for (LogField& field : topic.fields) {
      const Px4Unit known = px4_unit(topic.name, field.name.substr(0, field.name.find('[')));
      field.unit = known.unit;
      field.scale = known.scale;
    }
  }
  for (const auto& [name, value] : constants) log.information.emplace(fmt::format("{}.{}", entry.name, name), value);
  if (!ordered.row.empty() || ordered.time.empty())
    for (LogField& field : topic.fields) field.values = field.values.picked(ordered.row);
  topic.time = make_time_base(std::move(ordered.time));
  entry.table.reset();
  return topic;
}

void RosLog::describe(const Entry& entry, Log& log) const {
  const MessageTable& table = *entry.table;
  log.information.emplace("type of " + entry.name, one_line(entry.described.type));
  if (table.several_frames()) return;
  if (!table.frame().empty()) log.information.emplace("frame of " + entry.name, one_line(table.frame()));
  if (!table.child_frame().empty())
    log.information.emplace("child frame of " + entry.name, one_line(table.child_frame()));
}

void RosLog::note_obstacles(Log& log) const {
  std::vector<std::string> not_decoded, lost;
  for (const Entry& entry : entries_) {
    if (!entry.obstacle.empty() && entry.messages > 0)
      not_decoded.push_back(fmt::format("{} ({}; {})", entry.name, one_line(entry.described.type, 80), entry.obstacle));
    if (entry.lost > 0) lost.push_back(fmt::format("{} of {}", entry.lost, entry.name));
  }
  if (!not_decoded.empty()) log.damage.notes.push_back(fmt::format("topics not decoded: {}", listed(not_decoded)));
  if (!lost.empty())
    log.damage.notes.push_back(
        fmt::format("messages left out, since they are not as their definition says: {}", listed(lost)));
}

}  // namespace veridyn::io::internal
