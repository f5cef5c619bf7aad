#include "apps/veridyn/results/open_loop_results.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/io/tables/csv.hpp"

namespace veridyn::app {
namespace {

using estimation::OpenLoop;
using estimation::OpenLoopState;

/// Measured and predicted states of a group, with the error of the prediction.
Recording states_recording(const OpenLoop& open_loop, const std::string& group, Frame frame) {
  Recording recording;
  recording.source = "open_loop.csv";
  recording.frame = frame;
  TimeBase time;
  for (const OpenLoopState& state : open_loop.states) {
    if (state.group != group) continue;
    if (!time) time = make_time_base(state.time);
    const std::string unit = estimation::si_unit(state);
    recording.add(make_channel(state.name, unit, time, state.measured));
    recording.add(make_channel(state.name + "_model", unit, time, state.predicted));
    recording.add(make_channel("sigma_" + state.name, unit, time, state.sigma));
  }
  return recording;
}

std::string scores_csv(const OpenLoop& open_loop) {
  std::string text =
      "recording,state,unit,rmse,normalised_rmse,theil,theil_bias,theil_variance,theil_covariance,inside_bands,"
      "horizon_s,held_windows,windows,samples\n";
  const auto add = [&text](const std::string& recording, const OpenLoopState& s) {
    text += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{}\n", recording, s.name, s.unit, s.fit.rmse,
                        s.normalised_rmse, s.fit.theil, s.shares.bias, s.shares.variance, s.shares.covariance, s.inside,
                        s.horizon_s, s.held, s.windows, s.fit.count);
  };
  for (const OpenLoopState& state : open_loop.states) add("all", state);
  for (const estimation::OpenLoopRecording& one : open_loop.by_recording)
    for (const OpenLoopState& state : one.states) add(one.recording, state);
  return text;
}

}  // namespace

void write_open_loop(OutputFolder& folder, const OpenLoop& open_loop, Frame frame) {
  if (!open_loop.available()) return;
  folder.write("open_loop_scores.csv", scores_csv(open_loop));
  for (const std::string& group : open_loop.groups())
    folder.write(group.empty() ? std::string("open_loop.csv") : fmt::format("open_loop_{}.csv", group),
                 io::to_csv(states_recording(open_loop, group, frame)));
}

std::vector<std::string> open_loop_lines(const OpenLoop& open_loop) {
  std::vector<std::string> lines;
  if (!open_loop.text.empty()) lines.push_back("  open loop    " + open_loop.text);
  for (const OpenLoopState& s : open_loop.states) {
    lines.push_back(
        fmt::format("  open loop    {}: RMSE {:.3g} {}, {:.2f} of what it varies, Theil {:.3f}, {:.0f} % "
                    "in the bands, {} {:.1f} s ({} of {} windows held)",
                    s.name, s.fit.rmse, s.unit, s.normalised_rmse, s.fit.theil, 100.0 * s.inside,
                    2 * s.held > s.windows ? "not left in" : "left after", s.horizon_s, s.held, s.windows));
  }
  return lines;
}

Summary open_loop_summary(const OpenLoop& open_loop) {
  Summary summary = Summary::object();
  for (const OpenLoopState& s : open_loop.states)
    summary[s.name] = Summary::object({{"rmse", s.fit.rmse},
                                       {"unit", s.unit},
                                       {"normalised_rmse", s.normalised_rmse},
                                       {"theil", s.fit.theil},
                                       {"inside_bands", s.inside},
                                       {"horizon_s", s.horizon_s}});
  return summary;
}

}  // namespace veridyn::app
