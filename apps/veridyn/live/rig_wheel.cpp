// veridyn rig wheel DEVICE: what the numbers of a steering wheel and its pedals mean, found out by moving them.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <map>

#include "apps/veridyn/live/rig_car.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/run_record.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/live/driver/guided_calibration.hpp"
#include "veridyn/live/driver/wheel_device.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::live;

/// The axes that a recording moves: from the least to the largest of their numbers, at first where they began.
std::vector<WheelAxis> axes_of(const std::vector<WheelEvent>& events) {
  std::map<std::uint16_t, WheelAxis> axes;
  for (const WheelEvent& e : events) {
    if (e.type != kAxisEvent) continue;
    WheelAxis& axis =
        axes.try_emplace(e.code, WheelAxis{.code = e.code, .lowest = e.value, .highest = e.value, .value = e.value})
            .first->second;
    axis.lowest = std::min(axis.lowest, e.value);
    axis.highest = std::max(axis.highest, e.value);
  }
  std::vector<WheelAxis> all;
  for (const auto& [code, axis] : axes) all.push_back(axis);
  return all;
}

/// Confirms; says what comes next, or why not.
void confirm(const CommonOptions& options, GuidedCalibration& calibration) {
  if (const std::optional<std::string> wrong = calibration.confirm()) print_line(options, *wrong);
  if (calibration.step() != CalibrationStep::kDone) print_line(options, std::string(calibration.prompt()));
}

/// A recording in which a pause of a second says that a step is done.
WheelCalibration calibrated_by_events(const CommonOptions& options, const std::string& file, double lock) {
  const std::vector<WheelEvent> events = read_wheel_events(file);
  const std::vector<WheelAxis> axes = axes_of(events);
  check_wheel(file, "the recording", axes);
  GuidedCalibration calibration(axes, lock);
  print_line(options, std::string(calibration.prompt()));
  for (std::size_t i = 0; i < events.size() && calibration.step() != CalibrationStep::kDone; ++i) {
    if (i > 0 && events[i].time - events[i - 1].time >= kSecond) confirm(options, calibration);
    calibration.take(events[i]);
  }
  if (calibration.step() != CalibrationStep::kDone) confirm(options, calibration);
  return calibration.calibration();
}

/// By hand: Enter says that a step is done, b goes one back, q gives up.
WheelCalibration calibrated_by_hand(const CommonOptions& options, const std::string& device, double lock) {
  WheelDevice wheel(device);
  GuidedCalibration calibration(wheel.axes(), lock);
  print_line(options, fmt::format("{}: Enter when it is done, b and Enter for one step back, q and Enter to give up",
                                  wheel.name()));
  print_line(options, std::string(calibration.prompt()));
  std::string line;
  while (calibration.step() != CalibrationStep::kDone) {
    if (options.interruption.requested()) throw Interrupted();
    constexpr int kWait = 100;  // [ms]
    std::array<pollfd, 2> both = {{{wheel.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}}};
    ::poll(both.data(), both.size(), kWait);
    std::array<WheelEvent, 64> events;
    for (std::size_t n = wheel.read(events); n > 0; n = wheel.read(events)) {
      for (std::size_t i = 0; i < n; ++i) calibration.take(events[i]);
    }
    if (wheel.unplugged()) throw InputError(device, "was unplugged");
    if (both[1].revents == 0) continue;
    char key = 'q';
    if (::read(STDIN_FILENO, &key, 1) <= 0 || key == 'q') throw InputError(device, "is not calibrated: given up");
    if (key == 'b') {
      calibration.back();
      print_line(options, std::string(calibration.prompt()));
    } else if (key == '\n' && line != "b") {
      confirm(options, calibration);
    }
    line = key == '\n' ? "" : std::string(1, key);
  }
  return calibration.calibration();
}

int rig_wheel(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const std::string device = arguments.text("DEVICE"), events = arguments.text("--events");
  if (device.empty() == events.empty()) throw InputError("wheel", "takes a device, or --events and a recording of one");
  const double lock =
      Study::parse(fmt::format("lock = '{}'", arguments.text("--lock")), "--lock").root().positive("lock", "rad");
  OutputFolder folder(options.out);
  const WheelCalibration calibration =
      events.empty() ? calibrated_by_hand(options, device, lock) : calibrated_by_events(options, events, lock);
  folder.write("wheel.toml", calibration.to_toml());
  folder.publish();
  print_line(options, fmt::format("wrote {}", (folder.path() / "wheel.toml").string()));
  return kDone;
}

}  // namespace

Command rig_wheel_command() {
  return {.name = "wheel",
          .summary = "finds out which axis of a steering wheel and its pedals is what, for [live.driver]",
          .arguments = {{.name = "DEVICE", .help = "the wheel, /dev/input/by-id/...-event-joystick"},
                        {.name = "--lock",
                         .help = "angle of the steering wheel from its centre to either side",
                         .value = std::string("450 deg")},
                        {.name = "--events",
                         .help = "a recording of the device instead, in which a pause of a second ends each step",
                         .value = std::string(),
                         .type = "FILE"}},
          .default_out = "out/wheel",
          .example = "veridyn rig wheel /dev/input/by-id/usb-wheel-event-joystick --lock \"450 deg\"",
          .run = rig_wheel};
}

}  // namespace veridyn::app
