#include "veridyn/recording/ros_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/gravity.hpp"
#include "veridyn/recording/ros_topics.hpp"

namespace veridyn::recording {
namespace {

constexpr std::array<std::string_view, 3> kAxes{".x", ".y", ".z"};

bool contains_any(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::string small = lower(name);
  return std::ranges::any_of(words, [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

bool is_receiver(const RosTopic& topic) {
  return contains_any(topic.frame, {"gps", "gnss", "navsat"}) || contains_any(topic.name, {"gps", "gnss", "navsat"});
}

bool is_command(const RosTopic& topic) {
  return contains_any(topic.name, {"cmd", "command", "setpoint", "target", "desired", "reference"});
}

class MotionFinder {
 public:
  explicit MotionFinder(const Recording& log) : topics_(log) {}

  RosMotion find() {
    find_imu();
    find_magnetic_field();
    find_odometry();
    find_twists();
    return std::move(motion_);
  }

 private:
  struct Attitude {
    TimeBase time;
    std::vector<Eigen::Quaterniond> q;  ///< world from base_link; NaN where there is none
  };

  /// Of several topics that hold the same the first is taken.
  void note_choice(const std::vector<RosTopic>& found, std::string_view what) {
    if (found.size() < 2) return;
    std::string others;
    for (std::size_t i = 1; i < found.size(); ++i) others += (i == 1 ? "" : ", ") + found[i].name;
    motion_.notes.push_back(fmt::format("{} of {}, not of {}: [data.map] takes others", what, found[0].name, others));
  }

  /// What turns a frame into base_link, noted where it is only taken for it.
  Eigen::Matrix3d rotation(const std::string& frame, const std::string& name) {
    if (const auto R = topics_.R_base_from(frame)) return *R;
    motion_.notes.push_back(
        frame.empty()
            ? fmt::format("{} names no one frame: taken to be base_link", name)
            : fmt::format("the axes of {}, frame {}, are taken for those of base_link: the recording holds no "
                          "transform between them (/tf_static)",
                          name, frame));
    return Eigen::Matrix3d::Identity();
  }

  /// A vector of a topic, turned. All three components must be there; they may stand still.
  std::optional<RosVector> vector(const RosTopic& topic, const std::string& field, const Eigen::Matrix3d& R) const {
    RosVector made{.time = nullptr, .value = {}, .source = topic.name + field, .note = {}};
    const Channel* first = nullptr;
    for (std::size_t i = 0; i < 3; ++i) {
      const Channel* const from = topics_.log().find(topic.name + field + std::string(kAxes[i]));
      if (from == nullptr || from->empty()) return std::nullopt;
      if (first == nullptr) first = from;
      made.value[i] = at_stamps_of(*from, *first);
    }
    made.time = first->time;
    for (std::size_t k = 0; k < first->size(); ++k) {
      const Eigen::Vector3d v = R * Eigen::Vector3d(made.value[0][k], made.value[1][k], made.value[2][k]);
      for (Eigen::Index i = 0; i < 3; ++i) made.value[static_cast<std::size_t>(i)][k] = v(i);
    }
    return made;
  }

  std::optional<Attitude> attitude(const RosTopic& topic, const std::string& field,
                                   const Eigen::Matrix3d& R_base_from_frame) const {
    std::array<std::vector<double>, 4> parts;
    const Channel* first = nullptr;
    bool any = false;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string name = field + std::array{".x", ".y", ".z", ".w"}[i];
      const Channel* const from = topics_.log().find(topic.name + name);
      if (from == nullptr || from->empty()) return std::nullopt;
      if (first == nullptr) first = from;
      parts[i] = at_stamps_of(*from, *first);
      any = any || changes(parts[i]);
    }
    if (!any) return std::nullopt;
    Attitude made{first->time, {}};
    const Eigen::Quaterniond q_frame_from_base(R_base_from_frame.transpose());
    for (std::size_t k = 0; k < first->size(); ++k) {
      const Eigen::Quaterniond q(parts[3][k], parts[0][k], parts[1][k], parts[2][k]);
      made.q.push_back(q.squaredNorm() > 1e-6 ? q.normalized() * q_frame_from_base
                                              : Eigen::Quaterniond(kNaN, kNaN, kNaN, kNaN));
    }
    return made;
  }

  static RosAngles angles(const Attitude& attitude, std::string source) {
    RosAngles made{.time = attitude.time, .roll = {}, .pitch = {}, .yaw = {}, .source = std::move(source), .note = {}};
    for (const Eigen::Quaterniond& q : attitude.q) {
      const numerics::EulerAngles<double> e = numerics::euler_from_quaternion(q);
      made.roll.push_back(e.phi);
      made.pitch.push_back(e.theta);
      made.yaw.push_back(e.psi);
    }
    return made;
  }

  void find_imu() {
    std::vector<RosTopic> found = topics_.alive({"sensor_msgs/Imu"}, ".angular_velocity.z");
    if (found.empty()) found = topics_.alive({"sensor_msgs/Imu"}, ".angular_velocity.x");
    if (found.empty()) return;
    note_choice(found, "motion");
    const RosTopic& topic = found.front();
    const Eigen::Matrix3d R = rotation(topic.frame, topic.name);
    std::optional<RosVector> force = vector(topic, ".linear_acceleration", R);
    const VerticalAcceleration up = vertical_acceleration(
        force ? std::span<const double>(force->value[2]) : std::span<const double>(), parse_unit("m/s^2"));
    if (up.holds != VerticalAcceleration::Holds::kGravity || !up.unit.empty() || up.is_reversed(1.0)) {
      if (force)
        motion_.notes.push_back(
            fmt::format("{} is left out: its upward acceleration has a median of {:.3g} m/s^2. Its axes are not those "
                        "of REP 103 (x "
                        "forward, y left, z up), or gravity was taken off; map it in [data.map]",
                        topic.name, up.median));
      return;
    }
    motion_.specific_force = std::move(force);
    motion_.rates = vector(topic, ".angular_velocity", R);
    if (const std::optional<Attitude> q = attitude(topic, ".orientation", R)) {
      motion_.attitude = angles(*q, topic.name + ".orientation");
      motion_.attitude->note = "of the filter behind the Imu";
    }
  }

  void find_magnetic_field() {
    const std::vector<RosTopic> found = topics_.alive({"sensor_msgs/MagneticField"}, ".magnetic_field.x");
    if (found.empty()) return;
    note_choice(found, "magnetic field");
    motion_.magnetic_field =
        vector(found.front(), ".magnetic_field", rotation(found.front().frame, found.front().name));
  }

  void find_odometry() {
    const std::vector<RosTopic> found = topics_.alive({"nav_msgs/Odometry"}, ".twist.twist.linear.x");
    if (found.empty()) return;
    note_choice(found, "odometry");
    const RosTopic& topic = found.front();
    const std::string note = "of an estimator, in its frame " + (topic.frame.empty() ? "(unnamed)" : topic.frame);
    const Eigen::Matrix3d R = rotation(topic.child_frame, topic.name);
    motion_.velocity_body = vector(topic, ".twist.twist.linear", R);
    if (motion_.velocity_body) motion_.velocity_body->note = "of an estimator";
    if (!motion_.rates && topics_.alive_channel(topic, ".twist.twist.angular.z") != nullptr) {
      motion_.rates = vector(topic, ".twist.twist.angular", R);
      motion_.rates->note = "of an estimator";
    }
    motion_.position = vector(topic, ".pose.pose.position", Eigen::Matrix3d::Identity());
    if (motion_.position) motion_.position->note = note;
    const std::optional<Attitude> q = attitude(topic, ".pose.pose.orientation", R);
    if (!q || !motion_.velocity_body) return;
    odometry_angles_ = angles(*q, topic.name + ".pose.pose.orientation");
    odometry_angles_->note = note;
    odometry_velocity_ = *motion_.velocity_body;
    odometry_velocity_->note = note;
    // Of one message, unless samples without numbers were taken out of one of both.
    if (odometry_velocity_->value[0].size() != q->q.size()) {
      odometry_velocity_.reset();
      return;
    }
    for (std::size_t k = 0; k < q->q.size(); ++k) {
      Eigen::Vector3d v;
      for (std::size_t i = 0; i < 3; ++i) v(static_cast<Eigen::Index>(i)) = odometry_velocity_->value[i][k];
      v = q->q[k] * v;
      for (std::size_t i = 0; i < 3; ++i) odometry_velocity_->value[i][k] = v(static_cast<Eigen::Index>(i));
    }
  }

  void find_twists() {
    std::vector<std::pair<RosTopic, std::string>> world, body;
    for (const auto& [type, field] : {std::pair("geometry_msgs/TwistStamped", ".twist.linear"),
                                      std::pair("geometry_msgs/TwistWithCovarianceStamped", ".twist.twist.linear")}) {
      for (const RosTopic& topic : topics_.alive({type}, std::string(field) + ".x")) {
        if (is_command(topic)) continue;
        const bool named_world = std::ranges::find(kWorldFrames, topic.frame) != kWorldFrames.end();
        const bool named_body = std::ranges::find(kBodyFrames, topic.frame) != kBodyFrames.end();
        if (is_receiver(topic) && !named_body) {
          world.emplace(world.begin(), topic, field);
        } else if (named_world) {
          world.emplace_back(topic, field);
        } else if (named_body) {
          body.emplace_back(topic, field);
        }
      }
    }
    if (!world.empty()) {
      const auto& [topic, field] = world.front();
      motion_.velocity_world = vector(topic, field, Eigen::Matrix3d::Identity());
      if (motion_.velocity_world) motion_.velocity_world->note = "east, north, up";
      motion_.receiver_velocity = motion_.velocity_world.has_value();
    }
    if (!motion_.velocity_world && odometry_velocity_) motion_.velocity_world = odometry_velocity_;
    // Angles and velocity of one estimator agree with each other, whatever its frame is turned against east.
    const bool of_odometry = world.empty() || !motion_.attitude;
    if (of_odometry && odometry_angles_) {
      motion_.attitude = odometry_angles_;
      motion_.odometry_attitude = true;
    }
    if (!motion_.velocity_body && !body.empty()) {
      motion_.velocity_body =
          vector(body.front().first, body.front().second, rotation(body.front().first.frame, body.front().first.name));
    }
  }

  static constexpr std::array<std::string_view, 6> kWorldFrames{"map",   "odom",      "enu",
                                                                "world", "local_enu", "local_origin"};
  static constexpr std::array<std::string_view, 4> kBodyFrames{"base_link", "base_footprint", "body", "chassis"};

  RosTopics topics_;
  RosMotion motion_;
  std::optional<RosAngles> odometry_angles_;
  std::optional<RosVector> odometry_velocity_;
};

}  // namespace

RosMotion ros_motion(const Recording& log) { return MotionFinder(log).find(); }

}  // namespace veridyn::recording
