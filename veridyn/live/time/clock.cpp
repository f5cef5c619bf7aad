#include "veridyn/live/time/clock.hpp"

#include <cerrno>
#include <cmath>
#include <ctime>

namespace veridyn::live {

Nanoseconds nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

Nanoseconds RealClock::now() {
  std::timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<Nanoseconds>(time.tv_sec) * kSecond + time.tv_nsec;
}

void RealClock::sleep_until(Nanoseconds time) {
  std::timespec until{};
  until.tv_sec = time / kSecond;
  until.tv_nsec = time % kSecond;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace veridyn::live
