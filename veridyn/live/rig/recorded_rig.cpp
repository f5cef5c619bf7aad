#include "veridyn/live/rig/recorded_rig.hpp"

#include <cmath>
#include <string_view>

namespace veridyn::live {

LiveStudy recorded_study(const LiveHead& head) {
  const Study study = Study::parse(head.study, head.study_name);
  LiveStudy s = read_live_study(study);
  study.root().finish();
  return s;
}

RecordedRig::RecordedRig(const LiveStudy& study, const LiveHead& head)
    : platform_(study.cueing.platform),
      rig_(study, head.session),
      design_(study.cueing.algorithms.front().design->clone()),
      period_(nanoseconds(1.0 / study.options.rate)) {}

RecordedRig::Taken RecordedRig::take(const LiveRecord& record) {
  Taken taken;
  switch (record.kind) {
    case LiveRecord::Kind::kDatagram:
      taken.telemetry = rig_.take(record.link, record.datagram);
      if (taken.telemetry) arrivals_.push_back(taken.telemetry->arrival);
      break;
    case LiveRecord::Kind::kRequest:
      rig_.request(record.request);
      break;
    case LiveRecord::Kind::kKnob:
      turn(record, taken);
      break;
    case LiveRecord::Kind::kStep:
      step(record, taken);
      break;
    case LiveRecord::Kind::kCommand:
      command(record, taken);
      break;
  }
  return taken;
}

void RecordedRig::turn(const LiveRecord& record, Taken& taken) {
  if (record.knob == 0) values_.clear();
  values_.push_back(record.value);
  if (values_.size() < record.count) return;
  set_knob_values(*design_, values_);
  static_cast<void>(rig_.take_over(design_->make(platform_)));
  taken.turned = true;
}

void RecordedRig::step(const LiveRecord& record, Taken& taken) {
  step_ = rig_.step(record.time);
  command_left_ = step_.command_size;
  taken.step = &step_;
  // As the loop does: what came before it began waited for that.
  if (times_.steps == 0) begun_ = record.time - period_;
  for (const Nanoseconds arrival : arrivals_) {
    if (arrival >= begun_) times_.receive_to_send.add(record.sent - arrival);
  }
  arrivals_.clear();
  if (times_.steps > 0) {
    times_.jitter.add(std::abs(record.sent - last_sent_ - period_));
    const Nanoseconds steps = (record.time - last_time_) / period_;
    times_.left_out += steps > 1 ? static_cast<std::uint64_t>(steps - 1) : 0U;
  }
  times_.wake.add(record.sent - record.time);
  ++times_.steps;
  last_sent_ = record.sent;
  last_time_ = record.time;
}

/// The rig made it with the step before.
void RecordedRig::command(const LiveRecord& record, Taken& taken) {
  if (rig_.car() == nullptr) return;
  const std::string_view made(reinterpret_cast<const char*>(step_.command.data()), command_left_);
  taken.command_differs = made != record.order;
  command_left_ = 0;
  ++times_.commands;
  taken.pedal = rig_.car()->take_pedal();
  if (taken.pedal) times_.pedal_to_command.add(record.sent - *taken.pedal);
  constexpr Nanoseconds kApart = kSecond / 10;
  if (record.sent - car_at_ < kApart) return;
  car_at_ = record.sent;
  car_ = rig_.car()->status(record.time);
}

RigStatus RecordedRig::status() const {
  RigStatus s;
  s.step = step_;
  s.take(rig_);
  s.car = car_;
  s.times = times_;
  return s;
}

}  // namespace veridyn::live
