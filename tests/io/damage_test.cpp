// Laws that every reader keeps whatever the bytes are: it ends, it does not crash, what it returns is consistent.
#include <ostream>

#include "tests/io/support.hpp"
#include "tests/support/small_logs.hpp"
#include "veridyn/io/log_formats.hpp"

namespace veridyn::testing {

void PrintTo(const SmallLog& log, std::ostream* out) { *out << log.key; }

}  // namespace veridyn::testing

namespace veridyn::io {
namespace {

const LogFormat& format_with(std::string_view key) {
  for (const LogFormat& format : log_formats())
    if (format.key == key) return format;
  throw InputError(std::string(key), "is no format of logs");
}

class EveryReader : public ::testing::TestWithParam<testing::SmallLog> {
 protected:
  /// Whether the bytes were read; false when they were refused with a message.
  static bool read(std::string_view bytes, Log& log) {
    try {
      log = format_with(GetParam().key).read(bytes, "x", {});
      return true;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()), "");
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return false;
    }
  }
  static std::size_t rows(const Log& log) {
    std::size_t count = 0;
    for (const LogTopic& topic : log.topics) count += topic.size();
    return count;
  }
};

TEST_P(EveryReader, ReadsItsSampleWithoutALoss) {
  Log log;
  ASSERT_TRUE(read(GetParam().bytes, log));
  EXPECT_GT(rows(log), 2U);
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  EXPECT_EQ(log.damage.records_lost, 0U);
}

TEST_P(EveryReader, TakesALogThatIsCutAtAnyByte) {
  const std::string whole = GetParam().bytes;
  Log complete;
  ASSERT_TRUE(read(whole, complete));
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    SCOPED_TRACE(size);
    // An allocation of its own lets the address sanitizer see reads past the end.
    const std::string cut(whole.data(), size);
    Log log;
    if (!read(cut, log)) continue;
    testing::expect_consistent(log, size);
    EXPECT_LE(rows(log), rows(complete));
    most = std::max(most, rows(log));
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(most + 2, rows(complete));
}

TEST_P(EveryReader, TakesTenThousandLogsWithFlippedBits) {
  const std::string whole = GetParam().bytes;
  std::size_t damaged = 0;
  for (std::uint64_t seed = 1; seed <= 10000; ++seed) {
    SCOPED_TRACE(seed);
    const std::string bytes = testing::flip_bits(whole, seed);
    Log log;
    if (!read(bytes, log)) {
      ++damaged;
      continue;
    }
    testing::expect_consistent(log, bytes.size());
    damaged += log.damage.any() ? 1U : 0U;
    if (HasFatalFailure()) return;
  }
  // Flips inside of numbers cannot be seen; flips of structure must be.
  EXPECT_GT(damaged, GetParam().damage == testing::DamageLaw::kCounts ? 300U : 0U);
  RecordProperty("logs_with_a_counted_loss", static_cast<int>(damaged));
}

std::vector<testing::SmallLog> logs_with_a_law() {
  std::vector<testing::SmallLog> logs;
  for (testing::SmallLog& log : testing::small_logs())
    if (log.damage != testing::DamageLaw::kOwnTests) logs.push_back(std::move(log));
  return logs;
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryReader, ::testing::ValuesIn(logs_with_a_law()),
                         [](const auto& instance) { return std::string(instance.param.key); });

}  // namespace
}  // namespace veridyn::io
