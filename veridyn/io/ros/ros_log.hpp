#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/clock_restarts.hpp"
#include "veridyn/io/log/log.hpp"
#include "veridyn/io/ros/message_table.hpp"

namespace veridyn::io::internal {

/// The beginning of a text of a recording as it may stand in a name or a message: printable, on one line.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = 200);

/// A topic as a recording describes it.
struct RosTopic {
  std::string name;             ///< "/imu/data"
  std::string type;             ///< "sensor_msgs/msg/Imu"
  std::string encoding;         ///< of its messages: "cdr", "ros1"
  std::string schema_encoding;  ///< of its definition: "ros2msg", "ros1msg", empty where there is none
  std::string schema;

  friend bool operator==(const RosTopic&, const RosTopic&) = default;
};

/// Makes a log of messages of ROS, whatever they lie in.
///
/// A topic's definition, or where it has none a standard message's, says what its messages are. Its fields are named
/// `linear_acceleration.x`, elements of arrays `ranges[3]`, of a sequence next to `name` (JointState) by these:
/// `position[left_wheel]`. Texts and sequences of messages make no columns, nor do sequences of more than 64 numbers.
/// Topics that PX4 sends (px4_msgs, /fmu/out/...) have the names and units of its ULogs. The frame is that of REP 103,
/// flu, but of a recording of nothing else than these.
/// In `Log::information` stand `type of TOPIC`, `frame of TOPIC`, `child frame of TOPIC`, `transform PARENT to CHILD`
/// of /tf_static (translation, quaternion x y z w), covariances that never change, and `date` (UTC) of the beginning.
class RosLog {
 public:
  /// Of the topic, for `add`. A topic that is described twice alike is one. Beyond 4096 of them messages are only
  /// counted.
  [[nodiscard]] std::size_t topic(const RosTopic& topic);
  /// The next message of a topic, and when it was logged. What cannot be decoded is counted.
  void add(std::size_t topic, Nanoseconds logged, std::string_view payload);
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  static constexpr std::size_t kNoTopic = SIZE_MAX;
  /// The topics as columns, times from when the first message was logged. Empties this.
  /// @throws InputError where not one message can be decoded: why
  void finish(Log& log);

 private:
  struct Entry {
    RosTopic described;
    std::string name;  ///< without the slash ahead
    std::optional<MessageTable> table;
    bool transforms = false;  ///< /tf_static
    std::string obstacle;     ///< why it cannot be decoded
    std::uint64_t messages = 0, lost = 0;
    ClockRestarts restarts;  ///< of this topic alone
  };

  void take_transforms(std::string_view payload, RosEncoding encoding);
  [[nodiscard]] LogTopic made_topic(Entry& entry, Log& log);
  void describe(const Entry& entry, Log& log) const;
  void note_obstacles(Log& log) const;

  std::vector<Entry> entries_;
  std::map<std::string, std::string> transforms_;
  ClockRestarts restarts_;
  std::uint64_t messages_ = 0;
  Nanoseconds first_ = 0;
  std::vector<std::string> moved_, without_stamp_;  // for the notes
};

}  // namespace veridyn::io::internal
