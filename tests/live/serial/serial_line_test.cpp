#include "veridyn/live/serial/serial_line.hpp"

#include <asm/termbits.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "tests/live/serial/without_rights.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/live/serial/pseudo_terminal.hpp"

namespace veridyn::live {
namespace {

/// What a line is set to [bit/s]; -1 where it is none.
int baud_of(int descriptor) {
  struct termios2 settings = {};
  return ioctl(descriptor, TCGETS2, &settings) == 0 ? static_cast<int>(settings.c_ospeed) : -1;
}

TEST(SerialLine, PassesEveryByteAsItIs) {
  PseudoTerminal terminal;
  SerialLine line({.device = terminal.device()});
  std::vector<std::uint8_t> all(256);
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::uint8_t>(k);
  // Out: nothing is added to a line feed. In: no control character does anything, no carriage return is changed.
  EXPECT_EQ(line.write(all), all.size());
  EXPECT_EQ(terminal.read(all.size()), all);
  terminal.write(all);
  std::vector<std::uint8_t> received;
  while (received.size() < all.size() && line.wait(kSecond)) {
    std::array<std::uint8_t, 100> chunk;
    const std::size_t count = line.read(chunk);
    received.insert(received.end(), chunk.begin(), chunk.begin() + count);
  }
  EXPECT_EQ(received, all);
  EXPECT_FALSE(line.hung_up());
}

TEST(SerialLine, DoesNotWaitWhereNothingComes) {
  PseudoTerminal terminal;
  SerialLine line({.device = terminal.device()});
  std::array<std::uint8_t, 10> chunk;
  EXPECT_EQ(line.read(chunk), 0U);
  EXPECT_FALSE(line.wait(kMillisecond));
  EXPECT_FALSE(line.wait(-1));
  EXPECT_FALSE(line.hung_up());
}

TEST(SerialLine, SetsRatesThatAreNoConstants) {
  PseudoTerminal terminal;
  for (const int baud : {9600, 115200, 250000, 1234567}) {
    SerialLine line({.device = terminal.device(), .baud = baud});
    EXPECT_EQ(baud_of(line.descriptor()), baud);
  }
}

TEST(SerialLine, NoticesThatTheOtherEndIsGone) {
  auto terminal = std::make_unique<PseudoTerminal>();
  SerialLine line({.device = terminal->device()});
  SerialLine moved = std::move(line);
  EXPECT_FALSE(moved.hung_up());
  terminal.reset();
  std::array<std::uint8_t, 10> chunk;
  EXPECT_EQ(moved.read(chunk), 0U);
  EXPECT_TRUE(moved.hung_up());
  EXPECT_EQ(moved.write(chunk), 0U);
}

TEST(SerialLine, IsRefusedInOneLine) {
  const auto refusal = [](const std::filesystem::path& device, int baud = 250'000) {
    return why([&] { SerialLine line({.device = device, .baud = baud}); });
  };
  EXPECT_EQ(refusal("/dev/ttyUSB_none"), "/dev/ttyUSB_none: there is no such device; is it plugged in?");
  const veridyn::test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  EXPECT_EQ(refusal(folder), folder.string() + ": a folder, not a device");
  const std::filesystem::path file = folder / "serial_line_test.txt";
  std::ofstream(file) << "text";
  EXPECT_EQ(refusal(file), file.string() + ": not a serial line");
  EXPECT_EQ(refusal("/dev/null"), "/dev/null: not a serial line");

  PseudoTerminal terminal;
  const std::string device = terminal.device();
  EXPECT_EQ(refusal(device, 0), device + ": baud is 0; must be > 0");
  EXPECT_EQ(refusal(device, -9600), device + ": baud is -9600; must be > 0");
  {
    SerialLine line({.device = device});
    EXPECT_EQ(refusal(device), device + ": in use by another program");
  }
  EXPECT_EQ(refusal(device), "nothing was refused");
  // What a test cannot bring about: a device that is busy, a clock that cannot be divided.
  EXPECT_EQ(internal::open_refusal(EBUSY, "dialout"), "in use by another program");
  EXPECT_EQ(internal::baud_refusal(250'000, 230'400),
            "the line cannot do 250000 baud; the nearest it offers is 230400");
  EXPECT_EQ(internal::baud_refusal(250'000, 9'600), "the line cannot do 250000 baud; the nearest it offers is 9600");
  EXPECT_FALSE(internal::baud_refusal(250'000, 250'000));
  EXPECT_FALSE(internal::baud_refusal(115'200, 115'384));
}

TEST(SerialLine, IsRefusedWithoutTheRightToOpenIt) {
  const testing::WithoutRights file;
  EXPECT_EQ(why([&] { SerialLine line({.device = file.path()}); }),
            file.path() + ": no right to open it; members of the group 'dialout' have it");
}

}  // namespace
}  // namespace veridyn::live
