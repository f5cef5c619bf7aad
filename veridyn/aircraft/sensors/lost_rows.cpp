#include "veridyn/aircraft/sensors/lost_rows.hpp"

#include <map>
#include <span>
#include <utility>
#include <vector>

namespace veridyn::aircraft {

void lose_rows(Recording& recording, double share, numerics::RandomStream random) {
  std::map<double, bool> lost;
  for (const Channel& channel : recording.channels())
    for (const double stamp : channel.times()) lost[stamp] = false;
  for (auto& [stamp, gone] : lost) gone = random.uniform() < share;
  std::map<TimeBase, TimeBase> kept;  // of the bases that there were, which channels share
  std::vector<Channel> shortened;
  for (const Channel& channel : recording.channels()) {
    const std::span<const double> times = channel.times();
    std::vector<double> stamps, values;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (lost.at(times[i])) continue;
      stamps.push_back(times[i]);
      values.push_back(channel.value[i]);
    }
    TimeBase& base = kept[channel.time];
    if (!base) base = make_time_base(std::move(stamps));
    shortened.push_back(channel);
    shortened.back().time = base;
    shortened.back().value = std::move(values);
  }
  for (Channel& channel : shortened) recording.set(std::move(channel));
}

}  // namespace veridyn::aircraft
