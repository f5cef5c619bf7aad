#include "veridyn/numerics/batches/heartbeat.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "tests/support/temporary_folder.hpp"

namespace veridyn::numerics {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20s;  // a machine may be busy with something else for seconds

/// Looks until the file is seen to change `times` times; false: patience ran out.
bool changes(HeartbeatWatch& watch, int times) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (times > 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(2ms);
    // Zero at the moment at which a new beat is read, and never else.
    if (watch.silence().count() == 0) --times;
  }
  return times == 0;
}

TEST(Heartbeat, IsSeenUntilItsEnd) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "beat";
  HeartbeatWatch watch(file);
  EXPECT_EQ(watch.who(), "");
  {
    const Heartbeat beat(file, 20ms);
    EXPECT_TRUE(changes(watch, 5));
    EXPECT_NE(watch.who().find("process " + std::to_string(::getpid())), std::string::npos) << watch.who();
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  const auto silent = watch.silence();
  std::this_thread::sleep_for(100ms);
  EXPECT_GE(watch.silence() - silent, 100ms);
}

TEST(Heartbeat, IsNeverSeenEmptyBetweenTwoBeats) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "beat";
  const Heartbeat beat(file, 0ms);
  HeartbeatWatch watch(file);
  ASSERT_TRUE(changes(watch, 1));
  for (int look = 0; look < 2000; ++look) {
    std::ifstream in(file);
    const std::string content{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    ASSERT_EQ(std::count(content.begin(), content.end(), '\n'), 2) << content;
  }
}

}  // namespace
}  // namespace veridyn::numerics
