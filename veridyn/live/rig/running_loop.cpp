#include "veridyn/live/rig/running_loop.hpp"

#include <chrono>

namespace veridyn::live {

RunningLoop::RunningLoop(LiveControl& control, double longest, std::function<void()> body)
    : control_(&control), longest_(longest), thread_(std::move(body)) {}

RunningLoop::~RunningLoop() {
  if (!thread_.joinable()) return;
  park();
  end();
}

void RunningLoop::end() {
  control_->end();
  thread_.join();
}

void RunningLoop::park() {
  constexpr std::chrono::milliseconds kPause(20);
  control_->request(OperatorRequest::kPark);
  RealClock clock;
  const Nanoseconds give_up = clock.now() + nanoseconds(longest_);
  // The request takes effect with the next step: the state before that says nothing.
  const std::uint64_t steps = control_->status().times.steps;
  while (clock.now() < give_up) {
    std::this_thread::sleep_for(kPause);
    const RigStatus& status = control_->status();
    if (status.times.steps > steps + 1 &&
        (status.step.state == RigState::kParked || status.step.state == RigState::kStopped))
      return;
  }
}

}  // namespace veridyn::live
