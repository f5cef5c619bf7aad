#include "veridyn/live/rig/live_replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/live/link/crc32.hpp"

namespace veridyn::live {
namespace {

constexpr double kLongestScored = 1200.0;  // [s]

LiveStudy study_of(const LiveFile& file) {
  const Study study = Study::parse(file.head.study, file.head.study_name);
  LiveStudy s = read_live_study(study);
  study.root().finish();
  return s;
}

/// Feeds the records of a file to a rig and keeps what the replay says of the run.
class Replayer {
 public:
  Replayer(LiveReplay& into, Nanoseconds start, std::uint32_t session)
      : r_(into),
        rig_(into.study, session),
        design_(into.study.cueing.algorithms.front().design->clone()),
        start_(start) {
    if (into.study.car) into.car.emplace();
    apart_ = std::max(nanoseconds(1.0 / into.study.options.rate), kSecond / 100);
    period_ = nanoseconds(1.0 / into.study.options.rate);
  }

  void take(const LiveRecord& record) {
    switch (record.kind) {
      case LiveRecord::Kind::kDatagram:
        if (const auto t = rig_.take(record.link, record.datagram)) {
          arrivals_.push_back(t->arrival);
          if (r_.car) r_.car->drive.add(*t);
        }
        break;
      case LiveRecord::Kind::kRequest:
        rig_.request(record.request);
        break;
      case LiveRecord::Kind::kKnob:
        turn(record);
        break;
      case LiveRecord::Kind::kStep:
        step(record);
        break;
      case LiveRecord::Kind::kCommand:
        command(record);
        break;
    }
  }

  void end() {
    r_.packets = rig_.packets();
    r_.senders = rig_.intake().senders();
    r_.drives = rig_.intake().drives();
    r_.gaps = rig_.gaps();
    r_.extrapolated = rig_.extrapolated();
    r_.answers = rig_.answers();
    r_.drift = rig_.clock().drift();
    if (rig_.intake().layout() != nullptr) r_.layout = rig_.intake().layout()->sender;
    r_.derived = rig_.intake().derived();
    if (const CarLink* car = rig_.car()) {
      r_.layout = "the car's reports";
      r_.car->quality = car->quality(last_time_);
      r_.car->restarts = car->end().car_restarts();
    }
    r_.orders_fingerprint = fmt::format("{:08x}", fingerprint_);
  }

 private:
  void turn(const LiveRecord& record) {
    if (record.knob == 0) values_.clear();
    values_.push_back(record.value);
    if (values_.size() < record.count) return;
    set_knob_values(*design_, values_);
    static_cast<void>(rig_.take_over(design_->make(r_.study.cueing.platform)));
    r_.turns.push_back({seconds(record.time - start_), values_});
  }

  void step(const LiveRecord& record) {
    const RigState before = rig_.state();
    const RigStep& s = rig_.step(record.time);
    command_ = s.command;
    command_size_ = s.command_size;
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
    // As the loop does: what came before it began waited for that.
    if (r_.times.steps == 0) begun_ = record.time - period_;
    for (const Nanoseconds arrival : arrivals_) {
      if (arrival >= begun_) r_.times.receive_to_send.add(record.sent - arrival);
    }
    arrivals_.clear();
    if (r_.times.steps > 0) {
      r_.times.jitter.add(std::abs(record.sent - last_sent_ - period_));
      const Nanoseconds steps = (record.time - last_time_) / period_;
      r_.times.left_out += steps > 1 ? static_cast<std::uint64_t>(steps - 1) : 0U;
    }
    r_.times.wake.add(record.sent - record.time);
    ++r_.times.steps;
    last_sent_ = record.sent;
    last_time_ = record.time;
    r_.duration = seconds(record.time - start_);
    if (s.state != before || r_.changes.empty()) r_.changes.push_back({r_.duration, s.state, rig_.readiness()});
    keep(s);
  }

  /// The rig made it with the step before.
  void command(const LiveRecord& record) {
    if (!r_.car) return;
    ++r_.car->commands;
    const std::string_view made(reinterpret_cast<const char*>(command_.data()), command_size_);
    if (made != record.order) ++r_.car->commands_different;
    command_size_ = 0;
    if (const std::optional<Nanoseconds> pedal = rig_.car()->take_pedal())
      r_.times.pedal_to_command.add(record.sent - *pedal);
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
  LiveRig rig_;
  std::unique_ptr<cueing::WashoutDesign> design_;
  std::vector<double> values_;
  CarLink::CommandBytes command_ = {};
  std::size_t command_size_ = 0;
  std::vector<Nanoseconds> arrivals_;
  Nanoseconds start_, apart_ = 0, period_ = 0, last_kept_ = 0, last_sent_ = 0, last_time_ = 0, begun_ = 0;
  std::uint32_t last_sequence_ = 0, fingerprint_ = 0;
};

}  // namespace

LiveReplay replay(const LiveFile& file, const std::string& name, Progress& progress) {
  LiveReplay r;
  r.study = study_of(file);
  r.damaged = file.damaged;
  r.cut_bytes = file.cut_bytes;
  r.run.algorithm = r.study.cueing.algorithms.front().name;
  Replayer replayer(r, file.head.started, file.head.session);
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
