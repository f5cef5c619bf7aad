// Laws that every reader keeps whatever the bytes are: it ends, it does not crash, what it returns is consistent.
#include <functional>

#include "tests/io/support.hpp"
#include "tests/support/ros_writer.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/dataflash/dataflash_text.hpp"
#include "veridyn/io/matlab/mat.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/io/ulog/ulog.hpp"

namespace veridyn::io {
namespace {

struct Reader {
  const char* name;
  std::string (*sample)();
  std::function<Log(std::string_view)> read;
  bool counts_what_it_loses;  ///< CSV refuses instead
};

void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

class EveryReader : public ::testing::TestWithParam<Reader> {
 protected:
  /// Whether the bytes were read; false when they were refused with a message.
  static bool read(std::string_view bytes, Log& log) {
    try {
      log = GetParam().read(bytes);
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
  ASSERT_TRUE(read(GetParam().sample(), log));
  EXPECT_GT(rows(log), 2U);
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  EXPECT_EQ(log.damage.records_lost, 0U);
}

TEST_P(EveryReader, TakesALogThatIsCutAtAnyByte) {
  const std::string whole = GetParam().sample();
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
  const std::string whole = GetParam().sample();
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
  EXPECT_GT(damaged, GetParam().counts_what_it_loses ? 300U : 0U);
  RecordProperty("logs_with_a_counted_loss", static_cast<int>(damaged));
}

INSTANTIATE_TEST_SUITE_P(
    Formats, EveryReader,
    ::testing::Values(Reader{"DataFlash", testing::small_dataflash,
                             [](std::string_view b) { return read_dataflash(b, "x"); }, true},
                      Reader{"DataFlashText", testing::small_dataflash_text,
                             [](std::string_view b) { return read_dataflash_text(b, "x"); }, true},
                      Reader{"ULog", testing::small_ulog, [](std::string_view b) { return read_ulog(b, "x"); }, true},
                      Reader{"Mcap", testing::tiny_mcap, [](std::string_view b) { return read_mcap(b, "x"); }, true},
                      Reader{"Mat", testing::small_mat, [](std::string_view b) { return read_mat(b, "x"); }, true},
                      Reader{"Csv", testing::small_csv, [](std::string_view b) { return read_csv(b, "x"); }, true}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace veridyn::io
