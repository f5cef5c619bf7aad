#include "veridyn/live/rig/pedal_trace.hpp"

#include <algorithm>

namespace veridyn::live {
namespace {

/// Whether a number that counts modulo its range is at or beyond another one.
bool reached(std::uint16_t number, std::uint16_t other) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(number - other)) >= 0;
}
bool reached(std::uint32_t number, std::uint32_t other) { return static_cast<std::int32_t>(number - other) >= 0; }

}  // namespace

void PedalTrace::command(Bytes frame, Nanoseconds sent, std::optional<Nanoseconds> moved) {
  FrameDecoder decoder;
  const std::optional<SerialFrame> decoded = decoder.next(frame);
  if (!decoded) return;
  const auto sequence = static_cast<std::uint16_t>(decoded->header.sequence);
  sent_[count_++ % sent_.size()] = {sequence, sent};
  if (followed_ && sent - followed_->sent > kSecond) {
    ++result_.given_up;
    followed_.reset();
  }
  if (!moved || followed_) return;
  Followed begun;
  begun.moved = *moved;
  begun.sent = sent;
  begun.sequence = sequence;
  followed_ = begun;
}

void PedalTrace::report(const ReceivedReport& report) {
  const std::optional<Echo>& echo = report.payload.echo;
  if (!followed_ || followed_->reported || !echo || !reached(echo->sequence, followed_->sequence)) return;
  for (const Sent& one : sent_) {
    if (count_ == 0 || one.sequence != echo->sequence || one.at > report.arrived) continue;
    followed_->reported = report.arrived;
    followed_->made = seconds(report.made);
    // The echoed command was on its way as long as ours; the age is rounded down.
    followed_->line = std::max<Nanoseconds>(report.arrived - one.at - echo->age, 0);
    return;
  }
}

void PedalTrace::order(std::uint32_t sequence, double stamp, Nanoseconds sent) {
  if (!followed_ || !followed_->reported || followed_->ordered || stamp < followed_->made) return;
  followed_->ordered = sent;
  followed_->order = sequence;
}

void PedalTrace::answer(std::uint32_t sequence, Nanoseconds arrived) {
  if (!followed_ || !followed_->ordered || !reached(sequence, followed_->order)) return;
  const Followed& f = *followed_;
  const auto add = [this](Stage stage, Nanoseconds time) { result_.stages[static_cast<std::size_t>(stage)].add(time); };
  add(Stage::kInput, f.sent - f.moved);
  add(Stage::kLine, f.line);
  add(Stage::kCar, *f.reported - f.sent - f.line);
  add(Stage::kMotion, *f.ordered - *f.reported);
  add(Stage::kPlatform, arrived - *f.ordered);
  result_.whole.add(arrived - f.moved);
  followed_.reset();
}

}  // namespace veridyn::live
