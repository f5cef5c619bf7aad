#pragma once

#include <vector>

#include "veridyn/live/recording/live_file.hpp"

namespace veridyn::live::testing {

/// The head of a run.
inline LiveHead some_head() {
  return {.program = "veridyn 1.0",
          .study = "[live]\n",
          .study_name = "rig.toml",
          .started = 42,
          .started_utc = 1'700'000'000'000'000'000,
          .session = 7};
}

/// A record of each kind.
inline std::vector<LiveRecord> some_records() {
  LiveRecord datagram;
  datagram.kind = LiveRecord::Kind::kDatagram;
  datagram.time = 10;
  datagram.link = LinkOf::kPlatform;
  datagram.datagram = {.bytes = "bytes \0 of it", .sender = {0x7f000001, 99}, .arrival = 9};
  LiveRecord request;
  request.kind = LiveRecord::Kind::kRequest;
  request.time = 11;
  request.request = OperatorRequest::kEmergency;
  LiveRecord knob;
  knob.kind = LiveRecord::Kind::kKnob;
  knob.time = 12;
  knob.knob = 3;
  knob.count = 5;
  knob.value = 0.1;
  LiveRecord step;
  step.kind = LiveRecord::Kind::kStep;
  step.time = 13;
  step.sent = 14;
  step.order = "an order";
  return {datagram, request, knob, step};
}

}  // namespace veridyn::live::testing
