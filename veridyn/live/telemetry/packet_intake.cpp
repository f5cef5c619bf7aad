#include "veridyn/live/telemetry/packet_intake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/packet_derivatives.hpp"

namespace veridyn::live {
namespace {

using recording::Origin;

constexpr io::DerivativeWindow kDerivatives = {.before = 0.06, .after = 0.0};

/// Whether a motion can be had from packets of this layout.
void check_motion(const io::PacketLayout& layout) {
  const auto has_all = [&](std::initializer_list<std::string_view> names) {
    return std::all_of(names.begin(), names.end(), [&](std::string_view n) { return layout.has(n); });
  };
  const bool attitude = has_all({"roll", "pitch", "yaw"}) ||
                        has_all({"forward_x", "forward_y", "forward_z", "right_x", "right_y", "right_z"});
  const bool velocity = has_all({"velocity_x", "velocity_y", "velocity_z"}) ||
                        has_all({"world_velocity_x", "world_velocity_y", "world_velocity_z"});
  const bool body = has_all({"accel_x", "accel_y", "accel_z"}),
             world = attitude && has_all({"world_accel_x", "world_accel_y", "world_accel_z"});
  const std::string place = "packet " + layout.name;
  if (!body && !world && !(attitude && velocity))
    throw InputError(place, "holds no acceleration, and not attitude and velocity to derive one from");
  if (!attitude && !has_all({"gyro_x", "gyro_y", "gyro_z"}))
    throw InputError(place, "holds no angular rates, and no attitude to derive them from");
  if ((body || world) && !layout.gravity_in)
    throw InputError(place, "`gravity` is missing: \"in\" or \"out\" says whether accelerations contain gravity");
  if (layout.gravity_in == false && !attitude)
    throw InputError(place, "holds accelerations without gravity and no attitude: what is felt is not known");
}

}  // namespace

std::string_view name_of(PacketStatus fate) {
  switch (fate) {
    case PacketStatus::kAccepted:
      return "accepted";
    case PacketStatus::kWrongSize:
      return "of a wrong size or start";
    case PacketStatus::kImplausible:
      return "without a drive (not finite, beyond reason or of a menu)";
    case PacketStatus::kRepeated:
      return "repeated";
    case PacketStatus::kOutOfOrder:
      return "out of order";
    case PacketStatus::kStale:
      return "stale";
    case PacketStatus::kTeleporting:
      return "teleporting";
    case PacketStatus::kOtherSender:
      return "of another sender";
    case PacketStatus::kUnrecognised:
      return "before the kind of packet was known";
  }
  return "";
}

PacketIntake::PacketIntake(const std::vector<io::PacketLayout>& layouts, const IntakeOptions& options)
    : options_(options) {
  for (const io::PacketLayout& layout : layouts) {
    check_motion(layout);
    candidates_.emplace_back(layout);
  }
  if (candidates_.empty()) throw InputError("packet", "there is no layout to look for");
  if (candidates_.size() == 1) chosen_ = 0;
}

std::optional<Telemetry> PacketIntake::take(const Datagram& packet) {
  io::PacketMotion motion;
  const PacketStatus fate = judge(packet, motion);
  last_status_ = fate;
  count(packet.sender, fate);
  if (fate != PacketStatus::kAccepted) return std::nullopt;
  last_arrival_ = packet.arrival;
  Telemetry t{.sample = sample_of_last(), .arrival = packet.arrival, .restarted = restarted_};
  restarted_ = false;
  return t;
}

PacketStatus PacketIntake::judge(const Datagram& packet, io::PacketMotion& motion) {
  if (sender_ && packet.sender != *sender_) {
    if (packet.arrival - last_arrival_ < nanoseconds(options_.silent_after)) return PacketStatus::kOtherSender;
    sender_.reset();  // it has gone silent; whoever sends a drive next is listened to
  }
  if (!chosen_) return recognise(packet);
  Candidate& c = candidates_[*chosen_];
  if (!c.decoder.decode(packet.bytes, c.values)) return PacketStatus::kWrongSize;
  if (!c.decoder.is_plausible(c.values)) return PacketStatus::kImplausible;
  motion = c.decoder.motion(c.values);
  if (!c.decoder.layout().has("time")) motion.time = seconds(packet.arrival);
  const bool was_silent = !sender_;
  if (was_silent) {
    begin(motion, packet.arrival);
    sender_ = packet.sender;
    return PacketStatus::kAccepted;
  }
  return follow(motion, packet.arrival);
}

PacketStatus PacketIntake::recognise(const Datagram& packet) {
  constexpr std::size_t kPacketsToDecide = 10;
  bool of_a_size = false;
  for (Candidate& c : candidates_) {
    if (!c.decoder.decode(packet.bytes, c.values)) continue;
    of_a_size = true;
    ++c.seen;
    if (!c.decoder.is_plausible(c.values)) {
      c.last.reset();
      continue;
    }
    io::PacketMotion motion = c.decoder.motion(c.values);
    if (!c.decoder.layout().has("time")) motion.time = seconds(packet.arrival);
    if (c.last && io::follows(*c.last, motion)) ++c.good;
    c.last = motion;
  }
  if (!of_a_size) return PacketStatus::kWrongSize;
  std::size_t best = 0;
  for (std::size_t i = 1; i < candidates_.size(); ++i) {
    if (candidates_[i].good > candidates_[best].good) best = i;
  }
  if (candidates_[best].good >= kPacketsToDecide) {
    bool alone = true;
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      alone = alone && (i == best || 2 * candidates_[i].good < candidates_[best].good);
    if (alone) chosen_ = best;
  }
  return PacketStatus::kUnrecognised;
}

PacketStatus PacketIntake::follow(const io::PacketMotion& motion, Nanoseconds arrival) {
  const io::PacketMotion& last = history_[kept_ - 1];
  PacketStatus fate = PacketStatus::kAccepted;
  if (motion.time == last.time) {
    fate = PacketStatus::kRepeated;
  } else if (motion.time < last.time) {
    fate = PacketStatus::kOutOfOrder;
  } else if (clock_.lateness(motion.time, arrival) > options_.stale_after) {
    fate = PacketStatus::kStale;
  } else if (!io::follows(last, motion)) {
    fate = PacketStatus::kTeleporting;
  }
  if (fate == PacketStatus::kAccepted) {
    strays_ = 0;
    clock_.add(motion.time, arrival);
    keep(motion);
    return fate;
  }
  if (fate == PacketStatus::kRepeated) return fate;
  // What does not fit to the drive, but to itself, is another drive.
  strays_ = stray_ && strays_ > 0 && io::follows(*stray_, motion) ? strays_ + 1 : 1;
  stray_ = motion;
  if (strays_ < options_.begins_again) return fate;
  begin(motion, arrival);
  return PacketStatus::kAccepted;
}

void PacketIntake::begin(const io::PacketMotion& motion, Nanoseconds arrival) {
  clock_.reset();
  clock_.add(motion.time, arrival);
  kept_ = 0;
  keep(motion);
  strays_ = 0;
  stray_.reset();
  restarted_ = true;
  ++drives_;
}

void PacketIntake::keep(const io::PacketMotion& motion) {
  if (kept_ == kHistory) {
    std::move(history_.begin() + kHistory / 2, history_.end(), history_.begin());
    kept_ = kHistory - kHistory / 2;
  }
  history_[kept_++] = motion;
  // Rates are needed of every packet before angular accelerations are.
  const io::DerivedMotion d = io::with_derivatives({history_.data(), kept_}, kept_ - 1, kDerivatives);
  derives_rate_ = d.rate;
  derives_acceleration_ = d.acceleration.any();
}

recording::MotionSample PacketIntake::sample_of_last() {
  const std::span<const io::PacketMotion> all(history_.data(), kept_);
  const io::PacketMotion m = io::with_derivatives(all, kept_ - 1, kDerivatives).motion;
  recording::MotionSample s;
  s.time = m.time;
  s.frame = Frame::kFlu;
  if (m.attitude.coeffs().allFinite()) {
    s.attitude = m.attitude.normalized();
    s.attitude_from = Origin::kMeasured;
  }
  s.force = m.acceleration;
  const io::PacketLayout& layout = candidates_[*chosen_].decoder.layout();
  // Derived accelerations are against the world; those of a layout with gravity are all measured.
  if (!layout.gravity_in.value_or(false)) s.force += s.attitude.conjugate() * Eigen::Vector3d(0.0, 0.0, kGravity);
  s.force_from = derives_acceleration_ ? Origin::kDerived : Origin::kMeasured;
  s.rate = m.rate;
  s.rate_from = derives_rate_ ? Origin::kDerived : Origin::kMeasured;
  if (!derives_rate_) {
    s.angular_acceleration = io::angular_acceleration(all, kept_ - 1, kDerivatives);
    s.angular_acceleration_from = Origin::kDerived;
  }
  if (m.position.allFinite()) {
    s.position = m.position.head<2>();
    s.position_from = Origin::kMeasured;
  }
  if (std::isfinite(m.speed)) {
    s.speed = m.speed;
    s.speed_from = Origin::kMeasured;
  }
  return s;
}

void PacketIntake::count(const Sender& sender, PacketStatus fate) {
  for (std::size_t i = 0; i < known_senders_; ++i) {
    if (senders_[i].sender == sender) {
      ++senders_[i].counts[fate];
      return;
    }
  }
  if (known_senders_ == kSenders) return;
  senders_[known_senders_] = {sender, {}};
  ++senders_[known_senders_++].counts[fate];
}

PerPacketStatus<std::uint64_t> PacketIntake::counts() const {
  PerPacketStatus<std::uint64_t> all = {};
  for (const FromSender& s : senders_) {
    for (std::size_t i = 0; i < kPacketStatuses; ++i) all[i] += s.counts[i];
  }
  return all;
}

std::vector<PacketIntake::FromSender> PacketIntake::senders() const {
  return {senders_.begin(), senders_.begin() + static_cast<std::ptrdiff_t>(known_senders_)};
}

std::string_view PacketIntake::derived() const {
  if (derives_acceleration_ && derives_rate_)
    return "accelerations and angular rates are derived from the last 60 ms, and 30 ms late";
  if (derives_acceleration_) return "accelerations are derived from the last 60 ms, and 30 ms late";
  if (derives_rate_) return "angular rates are derived from the last 60 ms, and 30 ms late";
  return {};
}

}  // namespace veridyn::live
