#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "tests/live/weaving_drive.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/recording/live_file.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"

namespace veridyn::live::test {

/// A virtual vehicle and a virtual platform instead of sockets, on a time that is given. Nothing is allocated.
class MemoryLinks final : public LiveLinks {
 public:
  explicit MemoryLinks(const LiveStudy& study, const VirtualVehicleOptions& options = {})
      : platform(study.cueing.platform), vehicle_(test::weaving_drive(100.0), options) {}

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override {
    if (answered_) {
      answered_ = false;
      return Incoming{LinkOf::kPlatform, {{answer_.data(), answer_.size()}, {1, 3}, clock.now()}};
    }
    while (vehicle_.due() < until) {
      const Nanoseconds due = vehicle_.due();
      const auto packet = vehicle_.next();
      if (!packet) continue;
      clock.sleep_until(due);
      return Incoming{LinkOf::kTelemetry, {*packet, {1, 1}, due}};
    }
    clock.sleep_until(until);
    now = clock.now();
    if (at_step) at_step();
    return std::nullopt;
  }

  bool send(std::string_view order) override {
    platform.step(now);
    const auto answer = platform.take({order, {1, 2}, now});
    if (answer) answer_ = encode(*answer);
    answered_ = answer.has_value();
    return true;
  }

  [[nodiscard]] std::uint64_t sent() const { return vehicle_.sent(); }

  VirtualPlatform platform;
  Nanoseconds now = 0;
  std::function<void()> at_step;

 private:
  VirtualVehicle vehicle_;
  AnswerBytes answer_{};
  bool answered_ = false;
};

/// A run that may be recorded, in a file that goes when the test ends.
class LiveLoopTest : public ::testing::Test {
 protected:
  static LiveHead head_of(const std::string& study) {
    return {.program = "test", .study = study, .study_name = "rig.toml", .started = 0, .started_utc = 0, .session = 5};
  }
  veridyn::test::TemporaryFolder temporary_;
  std::filesystem::path path_ = temporary_.path() / "loop.vlr";
};

}  // namespace veridyn::live::test
