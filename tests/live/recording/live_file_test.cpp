#include "veridyn/live/recording/live_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/recording/live_recorder.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

LiveHead some_head() {
  return {.program = "veridyn 1.0",
          .study = "[live]\n",
          .study_name = "rig.toml",
          .started = 42,
          .started_utc = 1'700'000'000'000'000'000,
          .session = 7};
}

std::vector<LiveRecord> some_records() {
  LiveRecord datagram;
  datagram.kind = LiveRecord::Kind::kDatagram;
  datagram.time = 10;
  datagram.link = LinkOf::kPlatform;
  datagram.datagram = {.bytes = "bytes \0 of it", .sender = {0x7f000001, 99}, .arrival = 9};
  LiveRecord request;
  request.kind = LiveRecord::Kind::kRequest;
  request.time = 11;
  request.request = OperatorRequest::kEmergency;
  LiveRecord knob;
  knob.kind = LiveRecord::Kind::kKnob;
  knob.time = 12;
  knob.knob = 3;
  knob.count = 5;
  knob.value = 0.1;
  LiveRecord step;
  step.kind = LiveRecord::Kind::kStep;
  step.time = 13;
  step.sent = 14;
  step.order = "an order";
  return {datagram, request, knob, step};
}

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

class LiveRecorderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("veridyn_recorder_{}.vlr", ::testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_;
};

TEST_F(LiveRecorderTest, WritesEveryRecordInOrder) {
  constexpr int kCount = 20000;
  {
    LiveRecorder recorder(path_, some_head());
    LiveRecord r = some_records()[3];
    for (int k = 0; k < kCount; ++k) {
      r.time = k;
      recorder.record(r);
    }
    EXPECT_EQ(recorder.lost(), 0U);
    EXPECT_EQ(recorder.trouble(), "");
  }
  int k = 0;
  const LiveFile file = read_live_file(path_);
  for (const std::string_view block : file.blocks)
    EXPECT_TRUE(for_each_record(block, [&](const LiveRecord& r) { EXPECT_EQ(r.time, k++); }));
  EXPECT_EQ(k, kCount);
  EXPECT_EQ(file.cut_bytes, 0U);
  EXPECT_GT(file.blocks.size(), 5U);
}

TEST_F(LiveRecorderTest, CountsWhatTheDiskDoesNotTakeAndSaysSo) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  // A disk that is full from the first byte on is refused at once.
  EXPECT_THAT(why([] { LiveRecorder("/dev/full", some_head()); }), HasSubstr("No space left on device"));
  EXPECT_THAT(why([] { LiveRecorder("/nowhere/run.vlr", some_head()); }), HasSubstr("/nowhere/run.vlr"));
}

}  // namespace
}  // namespace veridyn::live
