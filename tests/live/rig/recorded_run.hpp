#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/live/rig/links_in_memory.hpp"
#include "tests/live/time/set_clock.hpp"
#include "veridyn/live/recording/live_recorder.hpp"
#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::live::test {

/// The study of `record_run`.
inline const std::string kRecordedStudy =
    "[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'three_axis'\n"
    "[live]\ntelemetry = '127.0.0.1:47123'\nplatform = '127.0.0.1:47124'\nsigns = 'off'\n";

/// Records a run of `kRecordedStudy`, started at 0, that nobody disturbs.
/// @param at_end what its page would show, before the recorder ends
inline void record_run(const std::filesystem::path& path, const LiveHead& head, Nanoseconds end,
                       const std::function<void(const RigStatus&)>& at_end = {}) {
  const LiveStudy study = read_live_study(Study::parse(kRecordedStudy, "rig.toml"));
  MemoryLinks links(study);
  SetClock clock;
  LiveControl control;
  LiveRecorder recorder(path, head);
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  loop.run(links, clock, control, &recorder, end);
  if (at_end) at_end(control.status());
}

}  // namespace veridyn::live::test
