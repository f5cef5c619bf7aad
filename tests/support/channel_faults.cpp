#include "tests/support/channel_faults.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"

namespace veridyn::test {
namespace {

RecordingFault each(ChannelNames names, std::function<void(Channel&)> change) {
  return [names = std::move(names), change = std::move(change)](Recording& recording) {
    change_each(recording, names, change);
  };
}

void restamp(Channel& c, const std::function<double(double)>& stamp) {
  std::vector<double> times(c.times().begin(), c.times().end());
  for (double& t : times) t = stamp(t);
  c.time = make_time_base(std::move(times));
}

}  // namespace

void change_each(Recording& recording, const ChannelNames& names, const std::function<void(Channel&)>& change) {
  for (const std::string& name : names) {
    Channel channel = recording.at(name);
    change(channel);
    recording.set(std::move(channel));
  }
}

RecordingFault scaled(ChannelNames names, double factor, double offset) {
  return each(std::move(names), [=](Channel& c) {
    for (double& v : c.value) v = factor * v + offset;
  });
}

RecordingFault swapped(std::string first, std::string second) {
  return [first = std::move(first), second = std::move(second)](Recording& recording) {
    Channel a = recording.at(first), b = recording.at(second);
    std::swap(a.value, b.value);
    recording.set(std::move(a));
    recording.set(std::move(b));
  };
}

RecordingFault restamped(ChannelNames names, std::function<double(double)> stamp) {
  return each(std::move(names), [stamp = std::move(stamp)](Channel& c) { restamp(c, stamp); });
}

RecordingFault delayed(ChannelNames names, double delay_s) {
  return restamped(std::move(names), [=](double t) { return t + delay_s; });
}

RecordingFault held(ChannelNames names, double period_s) {
  return each(std::move(names), [=](Channel& c) {
    double until = -kInfinity, value = 0.0;
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (c.times()[i] >= until) {
        value = c.value[i];
        until = c.times()[i] + period_s - 1e-6;
      }
      c.value[i] = value;
    }
  });
}

RecordingFault frozen(ChannelNames names, double share) {
  return each(std::move(names), [=](Channel& c) {
    const auto n = static_cast<double>(c.size());
    const auto first = static_cast<std::ptrdiff_t>(0.4 * n), last = static_cast<std::ptrdiff_t>((0.4 + share) * n);
    std::fill(c.value.begin() + first, c.value.begin() + last, c.value[first]);
  });
}

RecordingFault clipped(ChannelNames names, double low, double high) {
  return each(std::move(names), [=](Channel& c) {
    for (double& v : c.value) v = std::clamp(v, low, high);
  });
}

RecordingFault quantised(ChannelNames names, double step) {
  return each(std::move(names), [=](Channel& c) {
    for (double& v : c.value) v = step * std::round(v / step);
  });
}

RecordingFault with_spikes(ChannelNames names, double size, std::size_t every) {
  return each(std::move(names), [=](Channel& c) {
    for (std::size_t i = every / 2; i < c.size(); i += every) c.value[i] += size;
  });
}

RecordingFault smoothed(ChannelNames names, double time_constant_s) {
  return each(std::move(names), [=](Channel& c) {
    double state = c.value.front();
    for (std::size_t i = 1; i < c.size(); ++i) {
      const double share = 1.0 - std::exp(-(c.times()[i] - c.times()[i - 1]) / time_constant_s);
      state += share * (c.value[i] - state);
      c.value[i] = state;
    }
  });
}

RecordingFault with_gaps(double every_s, double length_s) {
  return [=](Recording& recording) {
    change_each(recording, recording.names(), [=](Channel& c) {
      std::vector<double> times, values;
      for (std::size_t i = 0; i < c.size(); ++i) {
        if (std::fmod(c.times()[i], every_s) < length_s && c.times()[i] > every_s) continue;
        times.push_back(c.times()[i]);
        values.push_back(c.value[i]);
      }
      c.time = make_time_base(std::move(times));
      c.value = std::move(values);
    });
  };
}

RecordingFault with_clock(std::function<double(double)> stamp) {
  return [stamp = std::move(stamp)](Recording& recording) {
    change_each(recording, recording.names(), [&](Channel& c) { restamp(c, stamp); });
  };
}

}  // namespace veridyn::test
