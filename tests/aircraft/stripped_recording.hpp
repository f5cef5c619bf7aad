#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "veridyn/recording/channel_map.hpp"

namespace veridyn::aircraft::testing {

/// The recording without some of its channels.
inline Recording without(const Recording& whole, const std::vector<std::string>& names) {
  Recording rest = recording::without_channels(whole);
  for (const Channel& channel : whole.channels())
    if (std::ranges::find(names, channel.name) == names.end()) rest.add(channel);
  return rest;
}

}  // namespace veridyn::aircraft::testing
