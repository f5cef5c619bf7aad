#include "veridyn/live/serial/pseudo_terminal.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/live/serial/serial_line.hpp"

namespace veridyn::live {
namespace {

class PseudoTerminalTest : public ::testing::Test {
 protected:
  veridyn::test::TemporaryFolder folder_;
  std::filesystem::path name_ = folder_.path() / "line";
};

TEST_F(PseudoTerminalTest, IsOpenedUnderItsNameWhichGoesWithIt) {
  {
    PseudoTerminal terminal(name_);
    SerialLine line({.device = name_});
    const std::vector<std::uint8_t> bytes = {0, 3, 4, 13, 10};
    EXPECT_EQ(terminal.write(bytes), bytes.size());
    std::vector<std::uint8_t> got(bytes.size());
    EXPECT_TRUE(line.wait(kSecond));
    EXPECT_EQ(line.read(got), bytes.size());
    EXPECT_EQ(got, bytes);
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(name_)));
}

TEST_F(PseudoTerminalTest, EchoesNothingBeforeAnybodyOpensIt) {
  PseudoTerminal terminal(name_);
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  terminal.write(bytes);
  std::vector<std::uint8_t> got(8);
  EXPECT_EQ(terminal.read_some(got), 0U);
}

TEST_F(PseudoTerminalTest, KnowsWhetherTheOtherEndIsOpen) {
  PseudoTerminal terminal(name_);
  std::vector<std::uint8_t> got(8);
  {
    SerialLine line({.device = name_});
    terminal.read_some(got);
    EXPECT_TRUE(terminal.is_open());
  }
  terminal.read_some(got);
  EXPECT_FALSE(terminal.is_open());
  const SerialLine again({.device = name_});
  terminal.read_some(got);
  EXPECT_TRUE(terminal.is_open());
}

TEST_F(PseudoTerminalTest, TakesTheNameOfOneThatWasKilledButOfNothingElse) {
  std::filesystem::create_symlink("/dev/pts/99999", name_);
  { const PseudoTerminal terminal(name_); }
  std::ofstream(name_) << "text";
  EXPECT_EQ(why([&] { PseudoTerminal terminal(name_); }),
            name_.string() + ": is there already, and no link to a pseudo-terminal");
}

}  // namespace
}  // namespace veridyn::live
