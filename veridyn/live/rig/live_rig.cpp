#include "veridyn/live/rig/live_rig.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace veridyn::live {
namespace {

using cueing::AxisState;
using cueing::kPlatformAxes;
using cueing::PlatformAxis;

/// From 0 to 1 without a jump in rate and acceleration.
double smooth(double phase) { return phase * phase * phase * (10.0 + phase * (-15.0 + 6.0 * phase)); }

Bytes bytes_of(std::string_view bytes) { return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}; }

std::unique_ptr<cueing::Washout> algorithm_of(const LiveStudy& study) {
  return study.cueing.algorithms.front().design->make(study.cueing.platform);
}

}  // namespace

std::string_view name_of(Readiness readiness) {
  switch (readiness) {
    case Readiness::kReady:
      return "ready";
    case Readiness::kNoTelemetry:
      return "no telemetry";
    case Readiness::kFrozen:
      return "the telemetry is frozen: the same motion over and over";
    case Readiness::kTooSlow:
      return "telemetry comes at less than 20 Hz";
    case Readiness::kNoAnswer:
      return "the platform does not answer";
    case Readiness::kRefused:
      return "the platform refuses orders: another program commands it, or it is at fault";
    case Readiness::kSignsUnknown:
      return "the telemetry's signs are not checked yet: drive, brake and turn";
    case Readiness::kSignsWrong:
      return "a sign, axis or unit of the telemetry is wrong";
  }
  return "";
}

std::string described(Readiness readiness, const LiveRig::Answers& answers) {
  if (readiness != Readiness::kRefused || answers.verdict != PlatformVerdict::kCommandedByAnother ||
      answers.commander.port == 0)
    return std::string(name_of(readiness));
  return "the platform refuses orders: the program at " + to_string(answers.commander) + " commands it";
}

LiveRig::LiveRig(const LiveStudy& study, std::uint32_t session)
    : options_(study.options),
      intake_(study.layouts, study.options.intake),
      car_(study.car ? std::optional<CarLink>(std::in_place, *study.car, *study.driver,
                                              static_cast<std::uint16_t>(session & 0xffffU))
                     : std::nullopt),
      even_(study.options.even),
      spikes_(study.options.spikes),
      chain_(algorithm_of(study), study.cueing.platform),
      session_(session) {
  recording::MotionSample still;
  still.frame = Frame::kFlu;
  still.force = recording::force_at_rest(Frame::kFlu);
  step_.cueing = chain_.reset(still);
  last_sample_ = still;
  entered_[RigState::kParked] = 1;
}

std::optional<Telemetry> LiveRig::take(LinkOf link, const Datagram& datagram) {
  if (link == LinkOf::kPlatform) {
    const std::optional<PlatformAnswer> a = decode_answer(datagram.bytes);
    if (!a || a->session != session_) {
      ++answers_.unreadable;
      return std::nullopt;
    }
    ++answers_.count;
    answers_.verdict = a->verdict;
    answers_.outside_limits = a->outside_limits;
    answers_.round_trip = datagram.arrival - a->time;
    answers_.reached = a->reached;
    answers_.commander = a->commander;
    last_answer_ = datagram.arrival;
    return std::nullopt;
  }
  if (link == LinkOf::kCamera) {
    take_pose(datagram);
    return std::nullopt;
  }
  if (datagram.bytes == kEmergencyPacket) {
    request(OperatorRequest::kEmergency);
    return std::nullopt;
  }
  std::optional<Telemetry> t;
  if (!car_) {
    t = intake_.take(datagram);
  } else if (link == LinkOf::kDriver) {
    car_->take_driver(bytes_of(datagram.bytes));
  } else if (link == LinkOf::kCar) {
    // A link hands over one frame at most; of several the last one counts.
    for (Bytes bytes = bytes_of(datagram.bytes); !bytes.empty();) {
      if (t) accept(*t);
      if (const auto next = car_->take_line(bytes, datagram.arrival)) t = next;
    }
  }
  if (t) accept(*t);
  return t;
}

void LiveRig::take_pose(const Datagram& datagram) {
  const std::optional<CameraPose> pose = decode_pose(datagram.bytes);
  if (!pose) {
    ++camera_.unreadable;
    return;
  }
  // They come in order: a clock that went back is another one.
  if (camera_.poses > 0 && pose->stamp <= camera_.last.stamp) camera_.clock.reset();
  ++camera_.poses;
  camera_.last = *pose;
  camera_.clock.add(seconds(pose->stamp), datagram.arrival);
}

void LiveRig::accept(Telemetry& t) {
  t.sample.place = options_.sensor;
  if (last_packet_ && t.arrival > *last_packet_) {
    // Packets of the last half second or so; several that came together count as one moment.
    const double gap = seconds(t.arrival - *last_packet_), weight = std::min(gap / 0.5, 1.0);
    rate_ = rate_ > 0.0 ? rate_ + weight * (1.0 / gap - rate_) : 1.0 / gap;
  }
  last_packet_ = t.arrival;
  watch_frozen(t);
  restarted_ = restarted_ || t.restarted;
  even_.add(t);
}

void LiveRig::watch_frozen(const Telemetry& t) {
  constexpr double kStands = 0.5;  // [m/s]
  const auto& s = t.sample;
  const bool same = last_telemetry_ && std::abs(s.speed) > kStands && s.force == last_telemetry_->force &&
                    s.rate == last_telemetry_->rate && s.position == last_telemetry_->position &&
                    s.speed == last_telemetry_->speed;
  if (!same) same_since_ = t.arrival;
  last_telemetry_ = s;
}

void LiveRig::request(OperatorRequest request) {
  switch (request) {
    case OperatorRequest::kStart:
      wants_motion_ = true;
      break;
    case OperatorRequest::kPark:
      wants_motion_ = false;
      wants_park_ = true;
      break;
    case OperatorRequest::kEmergency:
      wants_motion_ = false;
      emergency_ = true;
      break;
    case OperatorRequest::kRelease:
      release_ = true;
      break;
    case OperatorRequest::kSignsRight:
      signs_right_ = signs_right_.value_or(true);
      break;
    case OperatorRequest::kSignsWrong:
      signs_right_ = false;
      break;
  }
}

std::unique_ptr<cueing::Washout> LiveRig::take_over(std::unique_ptr<cueing::Washout> washout) {
  return chain_.take_over(std::move(washout), *last_sample_, step_.share);
}

Readiness LiveRig::ready_at(Nanoseconds time) const {
  if (!last_packet_ || time - *last_packet_ > nanoseconds(options_.lost_after)) return Readiness::kNoTelemetry;
  if (time - same_since_ > nanoseconds(options_.frozen_after)) return Readiness::kFrozen;
  if (rate_ == 0.0) return Readiness::kNoTelemetry;  // the first packet
  if (rate_ < options_.slowest_packets) return Readiness::kTooSlow;
  if (options_.answers) {
    if (!last_answer_ || time - *last_answer_ > nanoseconds(options_.unanswered_after)) return Readiness::kNoAnswer;
    if (!platform_follows(time)) return Readiness::kRefused;
  }
  if (options_.signs != SignCheck::kOff && signs_right_ == false) return Readiness::kSignsWrong;
  if (options_.signs == SignCheck::kBefore && !signs_right_) return Readiness::kSignsUnknown;
  return Readiness::kReady;
}

void LiveRig::handle(RigEvent event, Nanoseconds time) {
  const RigState to = after(step_.state, event);
  if (to == step_.state) return;
  const RigState from = std::exchange(step_.state, to);
  state_since_ = time;
  ++entered_[to];
  // The algorithm begins again, from where the platform is, whenever motion is let through again, and behind an
  // emergency stop, to be led to park from there.
  if (to == RigState::kSoftStart && from == RigState::kParked) phase_ = 0.0;
  if (from == RigState::kStopped) phase_ = 0.0;
  if (to == RigState::kSoftStart || from == RigState::kStopped) chain_.restart(*last_sample_, smooth(phase_));
}

void LiveRig::drive(double dt) {
  RigStep& s = step_;
  if (s.state == RigState::kSoftStart) phase_ = std::min(phase_ + dt / options_.soft_start, 1.0);
  if (s.state == RigState::kFade || s.state == RigState::kParked) phase_ = std::max(phase_ - dt / options_.fade, 0.0);
  s.share = smooth(phase_);
  switch (s.state) {
    case RigState::kStopped:
      s.cueing = chain_.brake(dt);
      break;
    case RigState::kSoftStart:
    case RigState::kRunning:
      s.cueing = chain_.step(*last_sample_, dt, s.share);
      break;
    case RigState::kParked:
    case RigState::kHold:
    case RigState::kFade:
      s.cueing = chain_.hold(dt, s.share);
      break;
  }
}

void LiveRig::count_extrapolated() {
  if (!step_.motion || (step_.state != RigState::kSoftStart && step_.state != RigState::kRunning)) return;
  ++extrapolated_.of;
  if (!(step_.motion->extrapolated > 0.0)) return;
  ++extrapolated_.steps;
  extrapolated_.longest = std::max(extrapolated_.longest, step_.motion->extrapolated);
}

bool LiveRig::at_rest_in_neutral() const {
  constexpr double kClose = 1e-3, kSlow = 1e-3;  // [m or rad], [m/s or rad/s]
  if (phase_ > 0.0) return false;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a = axis(step_.cueing.ordered, static_cast<PlatformAxis>(i));
    if (!(std::abs(a.position) < kClose && std::abs(a.rate) < kSlow)) return false;
  }
  return true;
}

const RigStep& LiveRig::step(Nanoseconds time) {
  const double dt = begun_ ? seconds(time - last_time_) : 0.0;
  const bool gap = dt > cueing::AxisGuard::kLongestStep;
  gaps_ += gap ? 1 : 0;
  begun_ = true;
  last_time_ = time;
  step_.time = time;
  step_.motion = even_.at(time, clock());
  if (step_.motion) {
    if (restarted_) spikes_.reset();
    step_.motion->sample.force = spikes_.step(step_.motion->sample.force, dt);
    step_.motion->sample = recording::at_place(step_.motion->sample, options_.driver);
    last_sample_ = step_.motion->sample;
  }
  if ((restarted_ || gap) && (step_.state == RigState::kRunning || step_.state == RigState::kSoftStart)) {
    chain_.restart(*last_sample_, step_.share);
  }
  restarted_ = false;
  readiness_ = ready_at(time);
  const bool ready = readiness_ == Readiness::kReady;
  // What stops comes before what starts.
  if (std::exchange(emergency_, false)) {
    handle(RigEvent::kEmergency, time);
    release_ = false;
  }
  if (std::exchange(wants_park_, false) || readiness_ == Readiness::kSignsWrong) handle(RigEvent::kPark, time);
  if (std::exchange(release_, false)) handle(RigEvent::kRelease, time);
  if (!ready) handle(RigEvent::kLost, time);
  if (step_.state == RigState::kHold) {
    if (ready) {
      handle(RigEvent::kBack, time);
    } else if (time - state_since_ >= nanoseconds(options_.hold)) {
      handle(RigEvent::kHeldLong, time);
    }
  }
  if (step_.state == RigState::kFade && at_rest_in_neutral()) handle(RigEvent::kFaded, time);
  if (step_.state == RigState::kParked && wants_motion_ && ready) handle(RigEvent::kStart, time);
  if (step_.state == RigState::kSoftStart && phase_ >= 1.0) handle(RigEvent::kStarted, time);
  drive(dt);
  ++step_.sequence;
  PlatformOrder order;
  order.session = session_;
  order.sequence = step_.sequence;
  order.time = time;
  order.state = step_.state;
  order.motion = step_.cueing.ordered;
  step_.to_platform = order;
  step_.order = encode(order);
  count_extrapolated();
  command_car(time);
  return step_;
}

bool LiveRig::platform_follows(Nanoseconds time) const {
  if (!options_.answers) return true;
  return last_answer_ && time - *last_answer_ <= nanoseconds(options_.unanswered_after) &&
         answers_.verdict != PlatformVerdict::kCommandedByAnother && answers_.verdict != PlatformVerdict::kFault;
}

void LiveRig::command_car(Nanoseconds time) {
  // 100 times a second is what the line carries; a step that is slightly early is taken too.
  constexpr Nanoseconds kApart = kSecond / 100 - kMillisecond / 10;
  step_.command_size = 0;
  if (!car_ || (last_command_ && time - *last_command_ < kApart)) return;
  last_command_ = time;
  const bool halt = step_.state == RigState::kStopped || !platform_follows(time);
  step_.command_size = car_->command(time, halt, step_.command);
}

}  // namespace veridyn::live
