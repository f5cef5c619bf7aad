#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "tests/support/folders.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::testing {

/// A file of recordings by others; the test is skipped when they are not there.
inline std::filesystem::path shared_flight(const char* name) {
  return test::shared_folder() / "data" / "flight" / name;
}

#define VERIDYN_NEEDS_SHARED(path)                                                                         \
  if (!std::filesystem::exists(path)) {                                                                    \
    GTEST_SKIP() << "needs the shared recordings, which are not part of the project: " << (path).string(); \
  }                                                                                                        \
  static_assert(true)

/// The message of the InputError that `call` throws; a failure when it throws none.
template <typename Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

/// A folder of the test's own, with files.
class TemporaryFolder : public test::TemporaryFolder {
 public:
  [[nodiscard]] std::filesystem::path write(const char* name, std::string_view content) const {
    write_file(path() / name, content);
    return path() / name;
  }
};

/// What must hold of whatever a reader makes of damaged bytes: columns as long as their time base, time that does not
/// go backwards, no more lost than there was.
inline void expect_consistent(const io::Log& log, std::size_t bytes) {
  EXPECT_LE(log.damage.bytes_lost, bytes);
  for (const io::LogTopic& topic : log.topics) {
    if (!topic.time) continue;
    for (std::size_t i = 1; i < topic.size(); ++i) ASSERT_LE((*topic.time)[i - 1], (*topic.time)[i]);
    for (const io::LogField& field : topic.fields) ASSERT_EQ(field.values.size(), topic.size()) << field.name;
  }
  (void)to_recording(log);
}

/// A linear congruential generator (Knuth, MMIX), so that the cases are the same everywhere.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t roll(std::uint64_t below) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state_ >> 33U) % below;
  }

 private:
  std::uint64_t state_;
};

/// The bytes with one to eight bits flipped; which ones depends on the seed only.
inline std::string flip_bits(std::string bytes, std::uint64_t seed) {
  Dice dice(seed);
  const std::uint64_t flips = 1 + dice.roll(8);
  for (std::uint64_t i = 0; i < flips; ++i) {
    const std::size_t at = dice.roll(bytes.size());
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << dice.roll(8)));
  }
  return bytes;
}

}  // namespace veridyn::testing
