#include "veridyn/live/rig/live_replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/live/link/crc32.hpp"
#include "veridyn/live/rig/recorded_rig.hpp"

namespace veridyn::live {
namespace {

constexpr double kLongestScored = 1200.0;  // [s]

/// Feeds the records of a file to a rig and keeps what the replay says of the run.
class Replayer {
 public:
  Replayer(LiveReplay& into, const LiveHead& head) : r_(into), rig_(into.study, head), start_(head.started) {
    if (into.study.car) into.car.emplace();
    apart_ = std::max(nanoseconds(1.0 / into.study.options.rate), kSecond / 100);
  }

  void take(const LiveRecord& record) {
    const RigState before = rig_.rig().state();
    const RecordedRig::Taken taken = rig_.take(record);
    if (taken.telemetry && r_.car) r_.car->drive.add(*taken.telemetry);
    if (taken.turned) r_.turns.push_back({seconds(record.time - start_), rig_.turned_to()});
    if (taken.step != nullptr) step(record, *taken.step, before);
    if (record.kind == LiveRecord::Kind::kCommand && r_.car) {
      ++r_.car->commands;
      r_.car->commands_different += taken.command_differs ? 1U : 0U;
    }
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
    fingerprint_ = crc32({chained.data(), chained.size()});
    last_time_ = record.time;
    r_.duration = seconds(record.time - start_);
    if (s.state != before || r_.changes.empty()) r_.changes.push_back({r_.duration, s.state, rig_.rig().readiness()});
    keep(s);
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
  std::uint32_t last_sequence_ = 0, fingerprint_ = 0;
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
