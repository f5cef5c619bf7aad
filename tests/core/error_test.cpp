#include "veridyn/core/error.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace veridyn {
namespace {

TEST(InputError, SaysWhereAndWhatInOneLine) {
  const InputError error("study.toml:14: subject.mass", "= -2 kg must be > 0");
  EXPECT_STREQ(error.what(), "study.toml:14: subject.mass: = -2 kg must be > 0");
  EXPECT_EQ(error.place(), "study.toml:14: subject.mass");
}

TEST(InputError, WithoutAPlaceIsWhatItSays) {
  EXPECT_STREQ(InputError("", "there is no log").what(), "there is no log");
}

// The program prints `what()` of any of its errors: the place must be in it however it is caught.
TEST(InputError, IsARuntimeErrorThatKeepsItsPlace) {
  try {
    throw InputError("flight.bin: byte 1024", "is cut");
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "flight.bin: byte 1024: is cut");
  }
}

}  // namespace
}  // namespace veridyn
