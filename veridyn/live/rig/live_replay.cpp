#include "veridyn/live/rig/live_replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/crc32.hpp"
#include "veridyn/live/rig/recorded_rig.hpp"

namespace veridyn::live {
namespace {

constexpr double kLongestScored = 1200.0;  // [s]

/// Feeds the records of a file to a rig and keeps what the replay says of the run.
class Replayer {
 public:
  Replayer(LiveReplay& into, const LiveHead& head)
      : r_(into), rig_(into.study, head), start_(head.started), session_(head.session) {
    if (into.study.car) into.car.emplace();
    apart_ = std::max(nanoseconds(1.0 / into.study.options.rate), kSecond / 100);
  }

  void take(const LiveRecord& record) {
    const RigState before = rig_.rig().state();
    const RecordedRig::Taken taken = rig_.take(record);
    if (taken.telemetry && r_.car) {
      r_.car->drive.add(*taken.telemetry);
      if (r_.study.camera) felt(*taken.telemetry);
    }
    if (r_.car && record.kind == LiveRecord::Kind::kDatagram && record.link == LinkOf::kCamera) seen();
    if (taken.turned) r_.turns.push_back({seconds(record.time - start_), rig_.turned_to()});
    if (taken.step != nullptr) step(record, *taken.step, before);
    if (record.kind == LiveRecord::Kind::kCommand && r_.car) {
      ++r_.car->commands;
      r_.car->commands_different += taken.command_differs ? 1U : 0U;
    }
    if (r_.car) trace(record, taken);
  }

  void end() {
    const LiveRig& rig = rig_.rig();
    r_.times = rig_.times();
    r_.packets = rig.packets();
    r_.senders = rig.intake().senders();
    r_.drives = rig.intake().drives();
    r_.gaps = rig.gaps();
    r_.extrapolated = rig.extrapolated();
    r_.answers = rig.answers();
    r_.drift = rig.clock().drift();
    if (rig.intake().layout() != nullptr) r_.layout = rig.intake().layout()->sender;
    r_.derived = rig.intake().derived();
    if (const CarLink* car = rig.car()) {
      r_.layout = "the car's reports";
      r_.car->quality = car->quality(last_time_);
      r_.car->restarts = car->end().car_restarts();
      r_.car->pedal_to_platform = trace_.result();
      r_.car->camera = rig.camera();
    }
    r_.orders_fingerprint = fmt::format("{:08x}", fingerprint_);
  }

 private:
  void step(const LiveRecord& record, const RigStep& s, RigState before) {
    const std::string_view order(s.order.data(), s.order.size());
    if (order != record.order) {
      ++r_.different;
      // A recording that lacks steps counts on from the one that is there.
      const auto recorded = decode_order(record.order);
      if (recorded && recorded->sequence > last_sequence_ + 1) r_.missing += recorded->sequence - last_sequence_ - 1;
    }
    if (const auto recorded = decode_order(record.order)) {
      last_sequence_ = recorded->sequence;
      r_.outside += is_within(recorded->motion, r_.study.cueing.platform.limits) ? 0U : 1U;
    }
    std::array<char, 4 + kOrderBytes> chained{};
    std::memcpy(chained.data(), &fingerprint_, sizeof fingerprint_);
    std::copy(order.begin(), order.end(), chained.begin() + 4);
    fingerprint_ = io::crc32({chained.data(), chained.size()});
    last_time_ = record.time;
    r_.duration = seconds(record.time - start_);
    if (s.state != before || r_.changes.empty()) r_.changes.push_back({r_.duration, s.state, rig_.rig().readiness()});
    keep(s);
  }

  void felt(const Telemetry& t) {
    const double time = rig_.rig().clock().ours(t.sample.time);
    std::vector<CarReplay::Inertial>& all = r_.car->inertial;
    if (all.empty() || time > all.back().time) all.push_back({time, t.sample.rate, t.sample.force});
  }
  void seen() {
    const LiveRig::Camera& camera = rig_.rig().camera();
    if (camera.poses == poses_) return;
    poses_ = camera.poses;
    r_.car->seen.push_back({camera.clock.ours(seconds(camera.last.stamp)), camera.last.pose, camera.last.covariance,
                            r_.car->inertial.size()});
  }

  /// From pedal to platform.
  void trace(const LiveRecord& record, const RecordedRig::Taken& taken) {
    switch (record.kind) {
      case LiveRecord::Kind::kCommand:
        trace_.command({reinterpret_cast<const std::uint8_t*>(record.order.data()), record.order.size()}, record.sent,
                       taken.pedal);
        break;
      case LiveRecord::Kind::kDatagram:
        if (record.link == LinkOf::kCar && rig_.rig().car()->end().report())
          trace_.report(*rig_.rig().car()->end().report());
        if (record.link != LinkOf::kPlatform) break;
        if (const auto answer = decode_answer(record.datagram.bytes); answer && answer->session == session_)
          trace_.answer(answer->sequence, record.datagram.arrival);
        break;
      case LiveRecord::Kind::kStep:
        if (taken.step->motion) trace_.order(taken.step->sequence, taken.step->motion->sample.time, record.sent);
        break;
      default:
        break;
    }
  }

  /// For score and figures.
  void keep(const RigStep& s) {
    if (!s.motion || s.state == RigState::kParked || s.time - last_kept_ < apart_ - 1000) return;
    if (!r_.run.vehicle.empty() && r_.duration - r_.run.vehicle.front().time > kLongestScored) return;
    last_kept_ = s.time;
    recording::MotionSample v = recording::in_frame(s.motion->sample, Frame::kFrd);
    v.time = r_.duration;
    recording::MotionSample rider = rider_motion(s.cueing.reached, r_.study.cueing.platform.rider);
    rider.time = v.time;
    r_.run.vehicle.push_back(v);
    r_.run.rider.push_back(rider);
    r_.run.steps.push_back(s.cueing);
    r_.states.push_back(s.state);
    r_.shares.push_back(s.share);
  }

  LiveReplay& r_;
  RecordedRig rig_;
  Nanoseconds start_, apart_ = 0, last_kept_ = 0, last_time_ = 0;
  std::uint32_t last_sequence_ = 0, fingerprint_ = 0, session_;
  PedalTrace trace_;
  std::uint64_t poses_ = 0;
};

}  // namespace

LiveReplay replay(const LiveFile& file, const std::string& name, Progress& progress) {
  LiveReplay r;
  r.study = recorded_study(file.head);
  r.damaged = file.damaged;
  r.cut_bytes = file.cut_bytes;
  r.run.algorithm = r.study.cueing.algorithms.front().name;
  Replayer replayer(r, file.head);
  progress.stage(fmt::format("replaying {}", name));
  for (std::size_t i = 0; i < file.blocks.size(); ++i) {
    if (!for_each_record(file.blocks[i], [&](const LiveRecord& record) { replayer.take(record); })) ++r.damaged;
    if (!progress.update(static_cast<double>(i) / static_cast<double>(file.blocks.size()))) break;
  }
  replayer.end();
  r.study.cueing.drive = r.layout;
  if (r.times.steps == 0) throw InputError(name, "holds no steps of a rig");
  return r;
}

}  // namespace veridyn::live
