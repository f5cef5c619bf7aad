// A platform behind a car as it drives: packets of telemetry in, orders out, and what happens when packets stop.
//
// Both ends are virtual and the time is given, so that the run is the same every time. LiveLoop runs the same LiveRig
// by the clock, between UDP sockets (UdpLinks): `veridyn cue --live`.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "picture.hpp"
#include "veridyn/live.hpp"

namespace {

constexpr const char* kStudy = R"(
[cue]
algorithms = ["optimal"]
[platform]
subject = "three_axis"
[live]
telemetry = "127.0.0.1:4123"
packet = "veridyn"
platform = "127.0.0.1:5123"
signs = "before"
[subject]
kind = "vehicle"
builtin = "reference"
[drive]
model = "four-wheel"
manoeuvre = "continuous sine"
speed = "70 km/h"
amplitude = "1.2 deg"
frequency = "0.25 Hz"
periods = 14
duration = 60
longitudinal = true
torque_time = [0, 3, 4, 8, 9, 13, 14, 18, 19, 23, 24, 28, 29, 60]
drive_torque = [300, 300, 900, 900, 0, 0, 900, 900, 0, 0, 900, 900, 300, 300]
brake_torque = [0, 0, 0, 0, 600, 600, 0, 0, 600, 600, 0, 0, 0, 0]
)";

// Beside the rig, which it lets go once the telemetry's signs, axes and units are seen to be right. A rig that runs by
// the clock leaves this to another thread.
class SignWatch {
 public:
  void add(const veridyn::live::Telemetry& telemetry) { new_.push_back(telemetry.sample); }
  // Looks once a second.
  void look(double time, veridyn::live::LiveRig& rig) {
    if (known_ || time < next_) return;
    next_ = time + 1.0;
    checker_.add(new_);
    new_.clear();
    known_ = checker_.check().kind == veridyn::live::SignVerdict::Kind::kRight;
    if (known_) rig.request(veridyn::live::OperatorRequest::kSignsRight);
  }

 private:
  veridyn::live::SignChecker checker_;
  std::vector<veridyn::recording::MotionSample> new_;
  double next_ = 1.0;
  bool known_ = false;
};

}  // namespace

int main() try {
  using namespace veridyn;
  const Study study = Study::parse(kStudy, "example 11");
  Progress silent;
  const live::LiveStudy rig_study = live::read_live_study(study);
  live::VirtualVehicle car(cueing::read_study(study, silent).vehicle, {.jitter = 0.008, .loss = 0.01});
  live::VirtualPlatform platform(rig_study.cueing.platform);
  live::LiveRig rig(rig_study, 1);
  rig.request(live::OperatorRequest::kStart);  // once packets come, and their signs are seen to be right

  const live::Sender car_address{0x7f000001, 1}, rig_address{0x7f000001, 2}, platform_address{0x7f000001, 3};
  constexpr double kLost = 35.0, kBack = 40.0, kEnd = 55.0;  // [s]; between the first two no packet arrives
  const live::Nanoseconds period = live::nanoseconds(1.0 / rig_study.options.rate);
  SignWatch signs;
  std::vector<double> time, force, ordered, reached, share;
  live::RigState state = rig.state();
  for (live::Nanoseconds now = period; now < live::nanoseconds(kEnd); now += period) {
    const double t = live::seconds(now);
    while (car.due() <= now) {
      const live::Nanoseconds sent = car.due();
      const auto packet = car.next();
      if (!packet || (t > kLost && t < kBack)) continue;
      const auto motion = rig.take(live::LinkOf::kTelemetry, {*packet, car_address, sent});
      if (motion) signs.add(*motion);
    }
    signs.look(t, rig);
    const live::RigStep& step = rig.step(now);
    platform.step(now);
    const auto answer = platform.take({{step.order.data(), step.order.size()}, rig_address, now});
    if (answer) {
      const live::AnswerBytes bytes = encode(*answer);
      rig.take(live::LinkOf::kPlatform, {{bytes.data(), bytes.size()}, platform_address, now});
    }
    if (step.state != state) std::printf("%6.2f s: %s\n", t, std::string(name_of(step.state)).c_str());
    state = step.state;
    time.push_back(t);
    force.push_back(step.motion ? recording::in_frame(step.motion->sample, Frame::kFlu).force.y() : 0.0);
    ordered.push_back(cueing::position(step.cueing.ordered, cueing::PlatformAxis::kRoll) / kDegree);
    reached.push_back(cueing::position(platform.reached(), cueing::PlatformAxis::kRoll) / kDegree);
    share.push_back(100.0 * step.share);
  }
  picture::write("11_follow_a_car_live.csv", {{"time[s]", time},
                                              {"force[m/s^2]", force},
                                              {"ordered[deg]", ordered},
                                              {"reached[deg]", reached},
                                              {"share[%]", share}});

  const live::VirtualPlatform::Counts& counts = platform.counts();
  std::printf("%llu packets sent, %llu lost on the way; %llu orders followed, %llu beyond the platform's limits\n",
              static_cast<unsigned long long>(car.sent()), static_cast<unsigned long long>(car.lost()),
              static_cast<unsigned long long>(counts.followed), static_cast<unsigned long long>(counts.outside));
  const bool parked_once = rig.entered()[live::RigState::kFade] == 1;
  return parked_once && rig.state() == live::RigState::kRunning && counts.outside == 0 && counts.jumps == 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
