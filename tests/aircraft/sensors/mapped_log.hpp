#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/study.hpp"

/// Logs of a few samples, and what a map makes of them.
namespace veridyn::aircraft::testing {

/// Samples 0.1 s apart.
inline Channel channel(std::string name, std::string_view unit, std::vector<double> value) {
  std::vector<double> time(value.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = 0.1 * static_cast<double>(i);
  return make_channel(std::move(name), unit, make_time_base(std::move(time)), std::move(value));
}

inline MappedRecording map(const Recording& log, const std::string& table = "", SurfaceThrows throws = {}) {
  static std::vector<Study> studies;  // keeps the document alive
  studies.push_back(Study::parse("[map]\n" + table, "study.toml"));
  return map_channels(log, studies.back().root().table("map"), throws);
}

inline Recording log_with(std::vector<Channel> channels) {
  Recording log;
  log.source = "flight.bin";
  for (Channel& c : channels) log.add(std::move(c));
  return log;
}

}  // namespace veridyn::aircraft::testing
