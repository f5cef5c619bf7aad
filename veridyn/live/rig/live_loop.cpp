#include "veridyn/live/rig/live_loop.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <cmath>

#include "veridyn/live/time/fixed_rate.hpp"

namespace veridyn::live {

std::vector<double> knob_values(cueing::WashoutDesign& design) {
  std::vector<double> all;
  for (const cueing::Knob& knob : design.knobs()) all.insert(all.end(), knob.values.begin(), knob.values.end());
  return all;
}

void set_knob_values(cueing::WashoutDesign& design, const std::vector<double>& values) {
  std::size_t at = 0;
  for (const cueing::Knob& knob : design.knobs()) {
    for (double& v : knob.values) {
      if (at < values.size()) v = values[at];
      ++at;
    }
  }
}

struct LiveControl::Queues {
  boost::lockfree::spsc_queue<OperatorRequest, boost::lockfree::capacity<64>> requests;
  boost::lockfree::spsc_queue<Telemetry, boost::lockfree::capacity<8000>> motions;
  std::atomic<KnobSetting*> setting{nullptr};
  boost::lockfree::spsc_queue<KnobSetting*, boost::lockfree::capacity<64>> done;

  ~Queues() {
    delete setting.load();
    done.consume_all([](KnobSetting* s) { delete s; });
  }
  Queues() = default;
  Queues(const Queues&) = delete;
  Queues& operator=(const Queues&) = delete;
};

void RigStatus::take(const LiveRig& rig) {
  readiness = rig.readiness();
  answers = rig.answers();
  packets = rig.packets();
  drives = rig.intake().drives();
  gaps = rig.gaps();
  extrapolated = rig.extrapolated();
  drift = rig.clock().drift();
}

LiveControl::LiveControl() : queues_(std::make_unique<Queues>()) {}
LiveControl::~LiveControl() = default;

void LiveControl::request(OperatorRequest request) { queues_->requests.push(request); }

void LiveControl::turn(std::unique_ptr<KnobSetting> setting) {
  delete queues_->setting.exchange(setting.release(), std::memory_order_acq_rel);
}

void LiveControl::tidy() {
  queues_->done.consume_all([](KnobSetting* s) { delete s; });
}

const RigStatus& LiveControl::status() {
  status_.update();
  return status_.value();
}

void LiveControl::take_motions(std::vector<Telemetry>& motions) {
  queues_->motions.consume_all([&](const Telemetry& t) { motions.push_back(t); });
}

LiveLoop::LiveLoop(const LiveStudy& study, std::uint32_t session)
    : rig_(study, session),
      format_(study.format, study.cueing.platform),
      period_(nanoseconds(1.0 / study.options.rate)) {}

void LiveLoop::take(const Incoming& incoming, Nanoseconds now, LiveControl& control, LiveRecorder* recorder) {
  if (recorder != nullptr) {
    LiveRecord r;
    r.kind = LiveRecord::Kind::kDatagram;
    r.time = now;
    r.link = incoming.link;
    r.datagram = incoming.datagram;
    recorder->record(r);
  }
  if (const std::optional<Telemetry> t = rig_.take(incoming.link, incoming.datagram)) {
    control.queues_->motions.push(*t);
    if (t->arrival >= begun_ && arrived_ < kArrivals) arrivals_[arrived_++] = t->arrival;
  }
}

void LiveLoop::take_requests(LiveControl& control, Nanoseconds now, LiveRecorder* recorder) {
  const auto request = [&](OperatorRequest w) {
    rig_.request(w);
    if (recorder == nullptr) return;
    LiveRecord r;
    r.kind = LiveRecord::Kind::kRequest;
    r.time = now;
    r.request = w;
    recorder->record(r);
  };
  OperatorRequest w{};
  while (control.queues_->requests.pop(w)) request(w);
  if (control.emergency_.exchange(false)) request(OperatorRequest::kEmergency);
  // What was done with goes back to be freed elsewhere; without room for it nothing new is taken.
  if (control.queues_->done.write_available() == 0) return;
  KnobSetting* setting = control.queues_->setting.exchange(nullptr, std::memory_order_acq_rel);
  if (setting == nullptr) return;
  if (recorder != nullptr) {
    LiveRecord r;
    r.kind = LiveRecord::Kind::kKnob;
    r.time = now;
    r.count = static_cast<std::uint16_t>(setting->values.size());
    for (std::size_t i = 0; i < setting->values.size(); ++i) {
      r.knob = static_cast<std::uint16_t>(i);
      r.value = setting->values[i];
      recorder->record(r);
    }
  }
  setting->washout = rig_.take_over(std::move(setting->washout));
  control.queues_->done.push(setting);
}

void LiveLoop::command(LiveLinks& links, Clock& clock, const RigStep& step, LiveRecorder* recorder) {
  if (step.command_size == 0) return;
  const std::string_view bytes(reinterpret_cast<const char*>(step.command.data()), step.command_size);
  if (!links.send_command(bytes)) ++times_.commands_not_sent;
  ++times_.commands;
  const Nanoseconds sent = clock.now();
  if (const std::optional<Nanoseconds> pedal = rig_.car()->take_pedal()) times_.pedal_to_command.add(sent - *pedal);
  if (recorder != nullptr) {
    LiveRecord r;
    r.kind = LiveRecord::Kind::kCommand;
    r.time = step.time;
    r.sent = sent;
    r.order = bytes;
    recorder->record(r);
  }
  constexpr Nanoseconds kApart = kSecond / 10;
  if (sent - car_at_ < kApart) return;
  car_at_ = sent;
  car_ = rig_.car()->status(step.time);
}

void LiveLoop::run(LiveLinks& links, Clock& clock, LiveControl& control, LiveRecorder* recorder,
                   std::optional<Nanoseconds> end) {
  begun_ = clock.now();
  FixedRate rate(begun_ + period_, period_);
  while (!control.ended() && (!end || rate.next() <= *end)) {
    while (const std::optional<Incoming> incoming = links.next(clock, rate.next()))
      take(*incoming, clock.now(), control, recorder);
    const Nanoseconds woke = clock.now();
    take_requests(control, woke, recorder);
    const RigStep& step = rig_.step(rate.next());
    const std::string_view order(step.order.data(), step.order.size());
    if (!links.send(format_.own() ? order : format_.encode(step.to_platform))) ++times_.not_sent;
    const Nanoseconds sent = clock.now();
    for (std::size_t i = 0; i < arrived_; ++i) {
      times_.receive_to_send.add(sent - arrivals_[i]);
      times_.wait.add(woke - arrivals_[i]);
    }
    arrived_ = 0;
    times_.work.add(sent - woke);
    times_.wake.add(woke - rate.next());
    if (times_.steps > 0) times_.jitter.add(std::abs(sent - last_sent_ - period_));
    ++times_.steps;
    last_sent_ = sent;
    if (recorder != nullptr) {
      LiveRecord r;
      r.kind = LiveRecord::Kind::kStep;
      r.time = step.time;
      r.sent = sent;
      r.order = order;
      recorder->record(r);
    }
    command(links, clock, step, recorder);
    rate.advance(clock.now());
    times_.left_out = rate.left_out();
    RigStatus& status = control.status_.to_write();
    status.step = step;
    status.take(rig_);
    status.car = car_;
    status.times = times_;
    control.status_.publish();
  }
}

}  // namespace veridyn::live
