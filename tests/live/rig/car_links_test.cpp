#include <gtest/gtest.h>

#ifdef VERIDYN_HAS_SOCKETS
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/live/rig/car_links_in_memory.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/rig/car_links.hpp"
#include "veridyn/live/serial/pseudo_terminal.hpp"

namespace veridyn::live {
namespace {

constexpr std::uint32_t kLoopbackOfCar = 0x7f000001;

/// A car's end of the line, a driver's table of 50 ms, a platform and a port for emergency stops.
class CarLinksTest : public ::testing::Test {
 protected:
  CarLinksTest() : car(std::make_unique<PseudoTerminal>(folder_ / "line")) {
    write_file(folder_ / "drive.csv", "time[s],steering[deg],throttle,brake,reverse\n0,0,0,0,0\n0.05,90,0.5,0,0\n");
    study = test::car_study();
    study.car->line = folder_ / "line";
    study.driver->file = folder_ / "drive.csv";
    study.platform = platform.bound_to();
    study.telemetry = UdpSocket({kLoopbackOfCar, 0}, "test").bound_to();
  }
  ~CarLinksTest() override { car.reset(); }

  /// What comes in of one link, as text, until `count` have or a second has passed.
  std::vector<std::string> incoming(CarLinks& links, LinkOf link, std::size_t count) {
    std::vector<std::string> all;
    const Nanoseconds until = clock.now() + kSecond;
    while (all.size() < count) {
      const auto in = links.next(clock, until);
      if (!in) break;
      if (in->link == link) all.emplace_back(in->datagram.bytes);
    }
    return all;
  }
  void say(std::string_view bytes) { car->write({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}); }

 private:
  veridyn::test::TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();

 protected:
  std::unique_ptr<PseudoTerminal> car;
  UdpSocket platform{{kLoopbackOfCar, 0}, "test"};
  LiveStudy study;
  RealClock clock;
};

TEST_F(CarLinksTest, HandOverWholeFramesOfTheLine) {
  CarLinks links(study);
  say({"one\0two\0th", 10});
  EXPECT_EQ(incoming(links, LinkOf::kCar, 3), (std::vector<std::string>{{"one\0", 4}, {"two\0", 4}, "th"}))
      << "and what there is of the next one";
  say({"ree\0", 4});
  EXPECT_EQ(incoming(links, LinkOf::kCar, 1), (std::vector<std::string>{{"ree\0", 4}}));
}

TEST_F(CarLinksTest, CarryCommandsOrdersAnswersAndStops) {
  CarLinks links(study);
  ASSERT_TRUE(links.send_command("drive"));
  const std::vector<std::uint8_t> command = car->read(5);
  EXPECT_EQ(std::string(command.begin(), command.end()), "drive");
  ASSERT_TRUE(links.send("order"));
  ASSERT_TRUE(platform.wait(clock.now() + kSecond));
  const auto order = platform.receive();
  ASSERT_TRUE(order);
  EXPECT_EQ(order->bytes, "order");
  ASSERT_TRUE(platform.send_to(order->sender, "answer"));
  EXPECT_EQ(incoming(links, LinkOf::kPlatform, 1), std::vector<std::string>{"answer"});
  UdpSocket button = UdpSocket::connected(study.telemetry, "test");
  ASSERT_TRUE(button.send("VSTOP1"));
  EXPECT_EQ(incoming(links, LinkOf::kTelemetry, 1), std::vector<std::string>{"VSTOP1"});
}

TEST_F(CarLinksTest, PlayTheDriverInItsTimeAndSayOnceThatItIsGone) {
  CarLinks links(study);
  const Nanoseconds begin = clock.now();
  std::vector<std::string> driver = incoming(links, LinkOf::kDriver, 100);
  ASSERT_GE(driver.size(), 3U);
  EXPECT_TRUE(driver.back().empty()) << "gone";
  driver.pop_back();
  for (const std::string& records : driver) EXPECT_FALSE(records.empty());
  EXPECT_GE(clock.now() - begin, kSecond) << "after it nothing comes, and the deadline ends the waiting";
}

// A line that hung up is tried twice a second.
TEST_F(CarLinksTest, OpenALineAgainThatHungUp) {
  CarLinks links(study);
  const std::filesystem::path line = study.car->line;
  car.reset();
  static_cast<void>(links.next(clock, clock.now() + 100 * kMillisecond));
  while (links.next(clock, clock.now() + 5 * kMillisecond)) {
  }
  EXPECT_FALSE(links.send_command("lost"));
  car = std::make_unique<PseudoTerminal>(line);
  const Nanoseconds until = clock.now() + 2 * kSecond;
  while (!links.send_command("again") && clock.now() < until)
    static_cast<void>(links.next(clock, clock.now() + 10 * kMillisecond));
  const std::vector<std::uint8_t> got = car->read(5);
  EXPECT_EQ(std::string(got.begin(), got.end()), "again");
}

}  // namespace
}  // namespace veridyn::live
#endif
