#pragma once

#include <functional>
#include <optional>

#include "tests/live/weaving_drive.hpp"
#include "veridyn/live/rig/live_rig.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"

namespace veridyn::live::test {

/// A rig between a virtual vehicle and a virtual platform, on a time that is given.
class DrivenRig {
 public:
  explicit DrivenRig(const LiveStudy& study, const VirtualVehicleOptions& vehicle = {}, std::uint32_t session = 1)
      : rig(study, session),
        platform(study.cueing.platform),
        vehicle_(weaving_drive(60.0), vehicle),
        period_(nanoseconds(1.0 / study.options.rate)) {}

  /// Runs for so long. @param see called after each step
  void run(double duration, const std::function<void(const RigStep&)>& see = {}) {
    const Nanoseconds end = now + nanoseconds(duration);
    while (now < end) {
      now += period_;
      while (vehicle_.due() <= now) {
        const Nanoseconds due = vehicle_.due();
        const auto packet = vehicle_.next();
        if (packet && vehicle_sends) rig.take(LinkOf::kTelemetry, {*packet, kVehicle, due});
      }
      const RigStep& s = rig.step(now);
      platform.step(now);
      const auto answer = platform.take({{s.order.data(), s.order.size()}, kRig, now});
      if (answer && platform_answers) {
        const AnswerBytes bytes = encode(*answer);
        rig.take(LinkOf::kPlatform, {{bytes.data(), bytes.size()}, kPlatform, now + 100'000});
      }
      if (see) see(s);
    }
  }

  static constexpr Sender kVehicle{0x7f000001, 1}, kRig{0x7f000001, 2}, kPlatform{0x7f000001, 3};
  LiveRig rig;
  VirtualPlatform platform;
  bool vehicle_sends = true, platform_answers = true;
  Nanoseconds now = 0;

 private:
  VirtualVehicle vehicle_;
  Nanoseconds period_;
};

}  // namespace veridyn::live::test
