#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"

namespace veridyn::testing {

/// A recording as `io::to_recording` makes it of ROS, topic by topic; samples 0.1 s apart.
class RosRecording {
 public:
  explicit RosRecording(std::size_t rows) {
    std::vector<double> stamps(rows);
    for (std::size_t i = 0; i < rows; ++i) stamps[i] = 0.1 * static_cast<double>(i);
    time_ = make_time_base(std::move(stamps));
    log_.source = "drive.mcap";
    log_.frame = Frame::kFlu;
  }

  /// A topic without channels yet.
  RosRecording& topic(const std::string& name, const std::string& type, const std::string& frame = "",
                      const std::string& child_frame = "") {
    topic_ = name;
    log_.information["type of " + name] = type;
    if (!frame.empty()) log_.information["frame of " + name] = frame;
    if (!child_frame.empty()) log_.information["child frame of " + name] = child_frame;
    return *this;
  }
  RosRecording& channel(const std::string& field, std::string_view unit, std::vector<double> values) {
    log_.add(make_channel(topic_ + field, unit, time_, std::move(values)));
    return *this;
  }
  RosRecording& vectors(const std::string& field, std::string_view unit, const std::vector<Eigen::Vector3d>& values) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      std::vector<double> part;
      for (const Eigen::Vector3d& v : values) part.push_back(v(axis));
      (void)channel(field + std::string(".") + "xyz"[axis], unit, std::move(part));
    }
    return *this;
  }
  RosRecording& attitudes(const std::string& field, const std::vector<Eigen::Matrix3d>& R_world_from_body) {
    std::vector<double> parts[4];
    for (const Eigen::Matrix3d& R : R_world_from_body) {
      const Eigen::Quaterniond q(R);
      for (const auto& [i, v] : {std::pair(0, q.x()), std::pair(1, q.y()), std::pair(2, q.z()), std::pair(3, q.w())})
        parts[i].push_back(v);
    }
    for (int i = 0; i < 4; ++i) (void)channel(field + std::string(".") + "xyzw"[i], "1", parts[i]);
    return *this;
  }
  RosRecording& transform(const std::string& parent, const std::string& child, const std::string& numbers) {
    log_.information["transform " + parent + " to " + child] = numbers;
    return *this;
  }
  [[nodiscard]] const Recording& log() const { return log_; }

 private:
  Recording log_;
  TimeBase time_;
  std::string topic_;
};

}  // namespace veridyn::testing
