#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"

namespace veridyn::recording {

/// A topic of a recording of ROS.
struct RosTopic {
  std::string name;   ///< as its channels begin: "imu/data"
  std::string type;   ///< "sensor_msgs/Imu"
  std::string frame;  ///< `header.frame_id`, empty where it says none, or several
  std::string child_frame;
};

/// What a recording of ROS (`io::read_mcap`) says of its topics and frames beside their channels.
class RosTopics {
 public:
  explicit RosTopics(const Recording& log);

  [[nodiscard]] bool empty() const { return topics_.empty(); }
  /// Those of a type whose channel of this name behind the topic holds numbers that change: most samples first.
  [[nodiscard]] std::vector<RosTopic> alive(std::initializer_list<std::string_view> types,
                                            std::string_view channel) const;
  /// The channel of a topic; null where it does not hold numbers that change.
  [[nodiscard]] const Channel* alive_channel(const RosTopic& topic, std::string_view channel) const;
  [[nodiscard]] const Recording& log() const { return log_; }
  /// What turns components in a frame into those of base_link (else base_footprint), by /tf_static; nothing where no
  /// transform leads from one to the other.
  [[nodiscard]] std::optional<Eigen::Matrix3d> R_base_from(std::string_view frame) const;

 private:
  const Recording& log_;
  std::vector<RosTopic> topics_;
};

/// The numbers of a channel at the stamps of another of its topic: as they are where they have the same stamps, between
/// them where samples that held nothing were taken out of one of them.
[[nodiscard]] std::vector<double> at_stamps_of(const Channel& channel, const Channel& other);
/// Whether numbers are there that differ from each other.
[[nodiscard]] bool changes(std::span<const double> values);
/// Whether a recording is one of ROS.
[[nodiscard]] bool is_ros(const Recording& log);

}  // namespace veridyn::recording
