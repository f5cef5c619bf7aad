#include "veridyn/recording/ros_topics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "veridyn/recording/channel_map.hpp"

namespace veridyn::recording {
namespace {

constexpr std::string_view kTypeOf = "type of ";

std::string text_of(const Recording& log, const std::string& key) {
  const auto found = log.information.find(key);
  return found == log.information.end() ? std::string() : found->second;
}

std::string_view without_slash(std::string_view frame) { return frame.starts_with('/') ? frame.substr(1) : frame; }

struct Parent {
  std::string frame;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // parent from child
};

/// The parents of frames, by "transform PARENT to CHILD".
std::map<std::string, Parent, std::less<>> parents_of(const Recording& log) {
  constexpr std::string_view kTransform = "transform ", kTo = " to ";
  std::map<std::string, Parent, std::less<>> parents;
  for (auto at = log.information.lower_bound(std::string(kTransform));
       at != log.information.end() && at->first.starts_with(kTransform); ++at) {
    const std::string_view frames = std::string_view(at->first).substr(kTransform.size());
    const std::size_t to = frames.find(kTo);
    if (to == std::string_view::npos) continue;
    std::istringstream numbers(at->second);
    double x = 0.0, y = 0.0, z = 0.0;
    Eigen::Quaterniond q;
    if (!(numbers >> x >> y >> z >> q.x() >> q.y() >> q.z() >> q.w()) || !(q.squaredNorm() > 1e-6)) continue;
    parents[std::string(without_slash(frames.substr(to + kTo.size())))] = {
        std::string(without_slash(frames.substr(0, to))), q.normalized().toRotationMatrix()};
  }
  return parents;
}

/// The frame at the top, and what turns components of `frame` into its own.
Parent root_of(std::string_view frame, const std::map<std::string, Parent, std::less<>>& parents) {
  constexpr int kDeepest = 32;
  Parent top{std::string(frame)};
  for (int i = 0; i < kDeepest; ++i) {
    const auto above = parents.find(top.frame);
    if (above == parents.end()) break;
    top = {above->second.frame, above->second.R * top.R};
  }
  return top;
}

}  // namespace

RosTopics::RosTopics(const Recording& log) : log_(log) {
  for (auto at = log.information.lower_bound(std::string(kTypeOf));
       at != log.information.end() && at->first.starts_with(kTypeOf); ++at) {
    RosTopic topic;
    topic.name = at->first.substr(kTypeOf.size());
    topic.type = at->second;
    if (const std::size_t middle = topic.type.find("/msg/"); middle != std::string::npos) topic.type.erase(middle, 4);
    topic.frame = without_slash(text_of(log, "frame of " + topic.name));
    topic.child_frame = without_slash(text_of(log, "child frame of " + topic.name));
    topics_.push_back(std::move(topic));
  }
}

std::vector<RosTopic> RosTopics::alive(std::initializer_list<std::string_view> types, std::string_view channel) const {
  std::vector<std::pair<std::size_t, RosTopic>> found;
  for (const RosTopic& topic : topics_) {
    if (std::ranges::find(types, topic.type) == types.end()) continue;
    const Channel* const values = alive_channel(topic, channel);
    if (values != nullptr) found.emplace_back(values->size(), topic);
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<RosTopic> result;
  for (auto& [size, topic] : found) result.push_back(std::move(topic));
  return result;
}

const Channel* RosTopics::alive_channel(const RosTopic& topic, std::string_view channel) const {
  const Channel* const values = log_.find(topic.name + std::string(channel));
  return values != nullptr && changes(values->value) ? values : nullptr;
}

std::optional<Eigen::Matrix3d> RosTopics::R_base_from(std::string_view frame) const {
  const auto parents = parents_of(log_);
  for (const char* base : {"base_link", "base_footprint"}) {
    if (frame == base) return Eigen::Matrix3d::Identity();
    const Parent of_base = root_of(base, parents), of_frame = root_of(frame, parents);
    if (of_base.frame == of_frame.frame) return of_base.R.transpose() * of_frame.R;
  }
  return std::nullopt;
}

std::vector<double> at_stamps_of(const Channel& channel, const Channel& other) {
  const bool same = channel.time == other.time || std::ranges::equal(channel.times(), other.times());
  return same ? channel.value : interpolated(channel, other.times());
}

bool changes(std::span<const double> values) {
  const auto first = std::ranges::find_if(values, [](double v) { return std::isfinite(v); });
  return first != values.end() &&
         std::any_of(first, values.end(), [&](double v) { return std::isfinite(v) && v != *first; });
}

bool is_ros(const Recording& log) { return !RosTopics(log).empty(); }

}  // namespace veridyn::recording
