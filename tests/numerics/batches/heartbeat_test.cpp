#include "veridyn/numerics/batches/heartbeat.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace veridyn::numerics {
namespace {

using namespace std::chrono_literals;

TEST(Heartbeat, IsSeenUntilItsEnd) {
  const auto file = std::filesystem::temp_directory_path() / ("veridyn_beat_" + std::to_string(::getpid()));
  HeartbeatWatch watch(file);
  EXPECT_EQ(watch.who(), "");
  {
    const Heartbeat beat(file, 20ms);
    std::this_thread::sleep_for(400ms);
    // Twenty beats: one was seen lately, however busy the machine.
    EXPECT_LT(watch.silence().count(), 0.2);
    std::this_thread::sleep_for(200ms);
    EXPECT_LT(watch.silence().count(), 0.2);
    EXPECT_NE(watch.who().find("process " + std::to_string(::getpid())), std::string::npos) << watch.who();
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  std::this_thread::sleep_for(100ms);
  EXPECT_GT(watch.silence().count(), 0.09);
}

}  // namespace
}  // namespace veridyn::numerics
