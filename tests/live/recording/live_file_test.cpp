#include "veridyn/live/recording/live_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tests/live/recording/some_records.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;
using testing::some_head;
using testing::some_records;

std::string encoded(const std::vector<LiveRecord>& records) {
  std::string all;
  std::array<char, kLargestRecord> bytes{};
  for (const LiveRecord& r : records) all.append(bytes.data(), encode(r, bytes));
  return all;
}

TEST(LiveRecord, ComesOutAsItWentIn) {
  const std::vector<LiveRecord> records = some_records();
  std::size_t i = 0;
  EXPECT_TRUE(for_each_record(encoded(records), [&](const LiveRecord& r) {
    const LiveRecord& w = records[i++];
    EXPECT_EQ(r.kind, w.kind);
    EXPECT_EQ(r.time, w.time);
    EXPECT_EQ(r.link, w.link);
    EXPECT_EQ(r.datagram.bytes, w.datagram.bytes);
    EXPECT_EQ(r.datagram.sender, w.datagram.sender);
    EXPECT_EQ(r.datagram.arrival, w.datagram.arrival);
    EXPECT_EQ(r.request, w.request);
    EXPECT_EQ(r.knob, w.knob);
    EXPECT_EQ(r.count, w.count);
    EXPECT_EQ(r.value, w.value);
    EXPECT_EQ(r.sent, w.sent);
    EXPECT_EQ(r.order, w.order);
  }));
  EXPECT_EQ(i, records.size());
}

TEST(LiveRecord, OfALongDatagramIsCutAndStaysWhole) {
  const std::string jumbo(60000, 'x');
  LiveRecord r = some_records()[0];
  r.datagram.bytes = jumbo;
  std::array<char, kLargestRecord> bytes{};
  const std::size_t n = encode(r, bytes);
  EXPECT_LE(n, kLargestRecord);
  EXPECT_TRUE(for_each_record({bytes.data(), n},
                              [&](const LiveRecord& back) { EXPECT_GT(back.datagram.bytes.size(), 1900U); }));
}

TEST(LiveFile, CutAnywhereIsReadToItsLastWholeBlock) {
  const std::string content = encoded(some_records());
  std::string bytes = framed(encode(some_head()));
  const std::size_t head = bytes.size();
  for (int k = 0; k < 3; ++k) bytes += framed(content);
  const std::size_t block = (bytes.size() - head) / 3;
  for (std::size_t cut = head; cut <= bytes.size(); ++cut) {
    const LiveFile file = parse_live_file(std::string_view(bytes).substr(0, cut), "run.vlr");
    ASSERT_EQ(file.blocks.size(), (cut - head) / block) << cut;
    ASSERT_EQ(file.cut_bytes, (cut - head) % block) << cut;
    EXPECT_EQ(file.damaged, 0U);
  }
  const LiveFile whole = parse_live_file(bytes, "run.vlr");
  EXPECT_EQ(whole.head.program, "veridyn 1.0");
  EXPECT_EQ(whole.head.study, "[live]\n");
  EXPECT_EQ(whole.head.started_utc, 1'700'000'000'000'000'000);
  EXPECT_EQ(whole.head.session, 7U);
  EXPECT_THAT(why([&] { static_cast<void>(parse_live_file(std::string_view(bytes).substr(0, head - 1), "run.vlr")); }),
              HasSubstr("run.vlr: is no recording of a live run"));
}

TEST(LiveFile, LeavesOutADamagedBlockAndGoesOn) {
  const std::string content = encoded(some_records());
  const std::string head = framed(encode(some_head())), block = framed(content);
  for (std::size_t at = 0; at < block.size(); ++at) {
    std::string bytes = head + block + block + block;
    bytes[head.size() + block.size() + at] = static_cast<char>(bytes[head.size() + block.size() + at] ^ 0x40);
    const LiveFile file = parse_live_file(bytes, "run.vlr");
    EXPECT_EQ(file.blocks.size(), 2U) << at;
    EXPECT_EQ(file.damaged, 1U) << at;
  }
}

TEST(LiveFile, StandsWhateverBytesAreInIt) {
  numerics::RandomStream random(8, "bytes");
  const std::string good = framed(encode(some_head())) + framed(encoded(some_records()));
  for (int k = 0; k < 10000; ++k) {
    std::string bytes = good;
    for (int n = 0; n < 5; ++n) bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
    // Behind a CRC that is right, too.
    std::string content = encoded(some_records());
    content[random.index(content.size())] = static_cast<char>(random.index(256));
    static_cast<void>(for_each_record(content, [](const LiveRecord&) {}));
    try {
      static_cast<void>(parse_live_file(bytes, "run.vlr"));
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("has no head"));
    }
  }
}

}  // namespace
}  // namespace veridyn::live
