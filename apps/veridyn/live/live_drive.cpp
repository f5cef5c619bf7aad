// What a live run with a car leaves for `veridyn track` and `veridyn identify`.
#include "apps/veridyn/live/live_drive.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "veridyn/core/error.hpp"

namespace veridyn::app {

using namespace veridyn::live;

LiveDrive::LiveDrive(const LiveStudy& study, const std::filesystem::path& folder) {
  if (!study.car) return;
  const std::filesystem::path path = folder / "drive_live.csv";
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0) throw InputError(path.string(), std::strerror(errno));
  write(DriveTable::header());
}

LiveDrive::~LiveDrive() {
  if (file_ < 0) return;
  write(table_.take_lines());
  ::close(file_);
}

void LiveDrive::write(const std::string& text) {
  if (!trouble_.empty()) return;
  // A reader that looks meanwhile sees whole lines: one call for all of them.
  if (::write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    trouble_ = fmt::format("drive_live.csv cannot be written: {}", std::strerror(errno));
}

void LiveDrive::add(const std::vector<Telemetry>& motions, double time) {
  if (file_ < 0) return;
  for (const Telemetry& t : motions) table_.add(t);
  constexpr double kApart = 0.25;  // [s]
  if (time - written_ < kApart) return;
  written_ = time;
  write(table_.take_lines());
}

namespace {

using Stage = PedalTrace::Stage;
constexpr std::array<std::pair<Stage, const char*>, PedalTrace::kStages> kStageNames = {{{Stage::kInput, "input"},
                                                                                         {Stage::kLine, "line"},
                                                                                         {Stage::kCar, "car"},
                                                                                         {Stage::kMotion, "motion"},
                                                                                         {Stage::kPlatform, "answer"}}};

}  // namespace

std::string delays_toml(const LiveReplay& run) {
  std::string text =
      "# Delays of this run [s]: half of all, and 99 %; one way over the line only bounds can be known.\n[delays]\n";
  const auto line = [&](std::string_view name, double half, double most) {
    text += fmt::format("{} = [{:.6f}, {:.6f}]\n", name, half, most);
  };
  const auto histogram = [&](std::string_view name, const LatencyHistogram& h) {
    if (h.count() > 0) line(name, h.quantile(0.5), h.quantile(0.99));
  };
  histogram("pedal_to_command", run.times.pedal_to_command);
  const LinkQuality& q = run.car->quality;
  if (q.round_trip_median && q.round_trip_p99)
    line("line_both_ways", seconds(*q.round_trip_median), seconds(*q.round_trip_p99));
  const auto bounds = [&](std::string_view name, const std::optional<DelayBounds>& b) {
    if (b) text += fmt::format("{}_bounds = [{:.6f}, {:.6f}]\n", name, seconds(b->lowest), seconds(b->highest));
  };
  bounds("command", q.command_delay);
  bounds("report", q.report_delay);
  histogram("report_to_order", run.times.receive_to_send);
  text += fmt::format("motion = {}  # chosen: live.delay\n", run.study.options.even.delay);
  const PedalTrace::Result& trace = run.car->pedal_to_platform;
  histogram("pedal_to_platform", trace.whole);
  for (const auto& [stage, name] : kStageNames) histogram(fmt::format("pedal_to_platform_{}", name), trace[stage]);
  if (run.answers.count > 0) text += fmt::format("platform_answer = {:.6f}\n", seconds(run.answers.round_trip));
  return text;
}

}  // namespace veridyn::app
