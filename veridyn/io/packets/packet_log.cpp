#include "veridyn/io/packets/packet_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/io/packets/packet_derivatives.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::io {
namespace {

constexpr std::size_t kFewestPackets = 10;

/// Packets with their numbers, one row each.
struct DecodedPackets {
  std::vector<std::vector<double>> values;
  std::vector<PacketMotion> motions;

  void push_back(const std::vector<double>& numbers, const PacketMotion& motion) {
    values.push_back(numbers);
    motions.push_back(motion);
  }
};

/// Puts derived accelerations and rates where packets do not say them.
/// @return what was derived, in words
std::vector<std::string> derive(std::vector<PacketMotion>& motions) {
  std::set<std::string> derived;
  const std::vector<PacketMotion> said = motions;
  constexpr std::array<const char*, 3> kAccelerations = {"accel_x", "accel_y", "accel_z"};
  for (std::size_t k = 0; k < said.size(); ++k) {
    const DerivedMotion d = with_derivatives(said, k);
    motions[k] = d.motion;
    for (std::size_t i = 0; i < kAccelerations.size(); ++i) {
      if (d.acceleration[i]) derived.insert(kAccelerations[i]);
    }
    if (d.rate) derived.insert("the angular rates");
  }
  return {derived.begin(), derived.end()};
}

/// Share of packets, looked at here and there, that are such ones and are followed by another.
double share_that_fits(const PacketLayout& layout, std::string_view bytes) {
  constexpr std::size_t kLooks = 50;
  const std::size_t count = bytes.size() / layout.size;
  if (count < kFewestPackets || bytes.size() % layout.size != 0) return 0.0;
  const PacketDecoder decoder(layout);
  std::vector<double> one(layout.fields.size()), next(one.size());
  double good = 0.0;
  for (std::size_t k = 0; k < kLooks; ++k) {
    const std::size_t at = (k * (count - 1) / kLooks) * layout.size;
    if (!decoder.decode(bytes.substr(at, layout.size), one) ||
        !decoder.decode(bytes.substr(at + layout.size, layout.size), next))
      return 0.0;
    if (decoder.is_plausible(one) && decoder.is_plausible(next) && follows(decoder.motion(one), decoder.motion(next)))
      good += 1.0;
  }
  return good / static_cast<double>(kLooks);
}

/// How packets went that are not in the drive.
struct LeftOut {
  std::size_t repeated = 0, implausible = 0, of_other_runs = 0, runs = 0;

  [[nodiscard]] std::size_t sum() const { return repeated + implausible + of_other_runs; }
};

/// The longest run of packets whose time goes on.
DecodedPackets longest_run(const PacketDecoder& decoder, std::string_view bytes, LeftOut& left_out) {
  constexpr double kBeginsAnew = 1.0;  // time that goes back by more than this is another run [s]
  const std::size_t size = decoder.layout().size;
  DecodedPackets best, run;
  std::size_t all = 0;
  const auto end_run = [&] {
    left_out.runs += run.motions.empty() ? 0U : 1U;
    if (run.motions.size() > best.motions.size()) std::swap(best, run);
    run = {};
  };
  std::vector<double> values(decoder.layout().fields.size());
  for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
    if (!decoder.decode(bytes.substr(at, size), values) || !decoder.is_plausible(values)) {
      ++left_out.implausible;
      continue;
    }
    const PacketMotion motion = decoder.motion(values);
    if (!run.motions.empty() && motion.time < run.motions.back().time - kBeginsAnew) end_run();
    if (!run.motions.empty() && motion.time <= run.motions.back().time) {
      ++left_out.repeated;
      continue;
    }
    run.push_back(values, motion);
    ++all;
  }
  end_run();
  left_out.of_other_runs = all - best.motions.size();
  return best;
}

}  // namespace

const PacketLayout* packets_in(std::string_view bytes) {
  const PacketLayout* best = nullptr;
  double most = 0.5;
  for (const PacketLayout& layout : known_packets()) {
    if (!layout.has("time")) continue;
    const double share = share_that_fits(layout, bytes);
    if (share <= most) continue;
    most = share;
    best = &layout;
  }
  return best;
}

Log packet_log(const PacketLayout& layout, std::string_view bytes, const std::string& source) {
  const PacketDecoder decoder(layout);
  if (!layout.has("time"))
    throw InputError(source, fmt::format("packets of {} hold no time: a file of them is no recording", layout.sender));
  LeftOut left_out;
  DecodedPackets packets = longest_run(decoder, bytes, left_out);
  std::vector<PacketMotion>& motions = packets.motions;
  if (motions.size() < kFewestPackets)
    throw InputError(source, fmt::format("holds {} usable packets of a drive; a recording has {} at least",
                                         motions.size(), kFewestPackets));
  Log log;
  log.source = source;
  log.format = layout.sender;
  log.frame = Frame::kFlu;
  log.damage.bytes_lost = bytes.size() % layout.size;
  if (left_out.sum() > 0) {
    std::vector<std::string> kinds;
    const auto say = [&](std::size_t count, const char* what) {
      if (count > 0) kinds.push_back(fmt::format("{} {}", count, what));
    };
    say(left_out.repeated, "with a stamp that repeats or goes back");
    say(left_out.implausible, "without a drive");
    say(left_out.of_other_runs, "of other runs, between which time started again");
    log.damage.notes.push_back(fmt::format("{} packets were left out: {}", left_out.sum(), fmt::join(kinds, ", ")));
  }
  if (!layout.seen)
    log.damage.notes.push_back(fmt::format(
        "the signs in {} are as described, not seen on a recording: look at what `veridyn inspect` says of them",
        layout.sender));
  if (const std::vector<std::string> derived = derive(motions); !derived.empty())
    log.damage.notes.push_back(fmt::format("{} {} derived from velocity and attitude over 0.1 s",
                                           fmt::join(derived, " and "), derived.size() == 1 ? "is" : "are"));
  LogTopic topic;
  std::vector<double> stamps;
  for (const PacketMotion& m : motions) stamps.push_back(m.time);
  topic.time = make_time_base(std::move(stamps));
  std::set<std::string, std::less<>> done = {"time"};
  const auto add = [&](std::string name, std::string unit, const std::function<double(std::size_t)>& value) {
    std::vector<double> values(motions.size());
    bool known = false;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      values[k] = value(k);
      known = known || std::isfinite(values[k]);
    }
    done.insert(name);
    if (!known) return;
    LogField field;
    field.name = std::move(name);
    field.unit = std::move(unit);
    field.values = Column(std::move(values));
    topic.fields.push_back(std::move(field));
  };
  constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    add(fmt::format("accel_{}", kAxes[i]), "m/s^2", [&, i](std::size_t k) { return motions[k].acceleration(i); });
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    add(fmt::format("gyro_{}", kAxes[i]), "rad/s", [&, i](std::size_t k) { return motions[k].rate(i); });
  const auto euler = [&](std::size_t k) { return numerics::euler_from_quaternion(motions[k].attitude); };
  add("roll", "rad", [&](std::size_t k) { return euler(k).phi; });
  add("pitch", "rad", [&](std::size_t k) { return euler(k).theta; });
  add("yaw", "rad", [&](std::size_t k) { return euler(k).psi; });
  add("speed", "m/s", [&](std::size_t k) { return motions[k].speed; });
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const PacketField& f = layout.fields[i];
    const bool of_the_world =
        f.name.starts_with("world_accel_") || f.name.starts_with("forward_") || f.name.starts_with("right_");
    if (of_the_world || done.contains(f.name)) continue;
    add(f.name, f.unit, [&, i](std::size_t k) { return packets.values[k][i]; });
  }
  log.topics.push_back(std::move(topic));
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
