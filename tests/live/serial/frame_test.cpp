#include "veridyn/live/serial/frame.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/sanitized.hpp"
#include "veridyn/live/virtual/noisy_line.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

FrameBytes random_payload(numerics::RandomStream& random, std::size_t longest = kLongestPayload) {
  FrameBytes payload(random.index(longest + 1));
  // Many zeros and many of the largest values: what stuffing is about.
  for (std::uint8_t& byte : payload) {
    const std::uint64_t sort = random.index(4);
    byte = static_cast<std::uint8_t>(sort == 0 ? 0 : sort == 1 ? 255 : random.index(256));
  }
  return payload;
}

FrameHeader random_header(numerics::RandomStream& random) {
  return {.kind = static_cast<std::uint8_t>(random.index(256)),
          .run = static_cast<std::uint16_t>(random.index(65536)),
          .sequence = static_cast<std::uint32_t>(random.index(std::uint64_t{1} << 32U))};
}

FrameBytes encoded(const FrameHeader& header, Bytes payload) {
  FrameBytes bytes(frame_size(payload.size()));
  EXPECT_EQ(encode_frame(header, payload, bytes), bytes.size());
  return bytes;
}

/// The specification once more, written another way: CRC bit by bit, stuffing block by block.
FrameBytes by_the_book(const FrameBytes& content) {
  FrameBytes bytes = content;
  std::uint32_t crc = 0xFFFF'FFFFU;
  for (const std::uint8_t byte : content) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB8'8320U : 0U);
  }
  crc ^= 0xFFFF'FFFFU;
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
  bytes.push_back(0);
  FrameBytes stuffed, block;
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      block.push_back(byte);
      continue;
    }
    stuffed.push_back(static_cast<std::uint8_t>(block.size() + 1));
    stuffed.insert(stuffed.end(), block.begin(), block.end());
    block.clear();
  }
  stuffed.push_back(0);
  return stuffed;
}

struct OwnFrame {
  FrameHeader header;
  FrameBytes payload;
  bool operator==(const OwnFrame&) const = default;
};

std::vector<OwnFrame> decoded(FrameDecoder& decoder, Bytes bytes) {
  std::vector<OwnFrame> frames;
  while (const std::optional<SerialFrame> frame = decoder.next(bytes))
    frames.push_back({frame->header, {frame->payload.begin(), frame->payload.end()}});
  EXPECT_TRUE(bytes.empty());
  return frames;
}

TEST(Frame, IsAsSpecifiedToTheByte) {
  // By hand: content 01 02 03 04 05 00 00 00 02 aa 00; its CRC-32 from Python's binascii.crc32: 0x166f2384.
  const FrameBytes payload = {0xaa, 0x00};
  const FrameHeader header = {.kind = 2, .run = 0x0403, .sequence = 5};
  EXPECT_THAT(encoded(header, payload), ::testing::ElementsAre(0x06, 0x01, 0x02, 0x03, 0x04, 0x05, 0x01, 0x01, 0x03,
                                                               0x02, 0xaa, 0x05, 0x84, 0x23, 0x6f, 0x16, 0x00));
}

TEST(Frame, AgreesWithTheSpecificationWrittenAnotherWay) {
  numerics::RandomStream random(6, "frames");
  for (int round = 0; round < 2000; ++round) {
    const FrameHeader header = random_header(random);
    const FrameBytes payload = random_payload(random);
    FrameBytes content = {1, header.kind, static_cast<std::uint8_t>(header.run),
                          static_cast<std::uint8_t>(header.run >> 8U)};
    for (unsigned shift = 0; shift < 32; shift += 8)
      content.push_back(static_cast<std::uint8_t>(header.sequence >> shift));
    content.push_back(static_cast<std::uint8_t>(payload.size()));
    content.insert(content.end(), payload.begin(), payload.end());
    ASSERT_EQ(encoded(header, payload), by_the_book(content)) << round;
  }
}

TEST(FrameDecoder, RefusesWhatAnotherSenderMayMeanByAGoodCrc) {
  FrameDecoder decoder;
  EXPECT_EQ(decoded(decoder, by_the_book({1, 2, 3, 4, 5, 0, 0, 0, 2, 0xaa, 0})).size(), 1U);
  EXPECT_TRUE(decoded(decoder, by_the_book({2, 2, 3, 4, 5, 0, 0, 0, 2, 0xaa, 0})).empty());
  EXPECT_EQ(decoder.counts().other_version, 1U);
  EXPECT_TRUE(decoded(decoder, by_the_book({1, 2, 3, 4, 5, 0, 0, 0, 3, 0xaa, 0})).empty());  // three, and there are two
  EXPECT_TRUE(decoded(decoder, by_the_book({1, 2, 3, 4, 5, 0, 0, 0, 1, 0xaa, 0})).empty());
  EXPECT_TRUE(decoded(decoder, by_the_book({1, 2, 3, 4, 5, 0, 0, 0})).empty());  // a header without a length
  EXPECT_EQ(decoder.counts().malformed, 3U);
  EXPECT_EQ(decoder.counts().bad_crc, 0U);
}

TEST(Frame, RoundTripsAnyPayloadInChunksOfAnySize) {
  numerics::RandomStream random(1, "frames");
  FrameDecoder whole, chunked;
  std::size_t frames = 0;
  for (int round = 0; round < 500; ++round) {
    std::vector<OwnFrame> sent;
    FrameBytes line;
    for (int k = 0; k < 4; ++k) {
      sent.push_back({random_header(random), random_payload(random)});
      const FrameBytes bytes = encoded(sent.back().header, sent.back().payload);
      EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 0), 1);
      EXPECT_EQ(bytes.back(), 0);
      line.insert(line.end(), bytes.begin(), bytes.end());
      for (std::uint64_t idle = random.index(3); idle > 0; --idle) line.push_back(0);
    }
    EXPECT_EQ(decoded(whole, line), sent) << round;
    std::vector<OwnFrame> received;
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t size = std::min<std::size_t>(line.size() - at, random.index(round % 2 == 0 ? 3 : 200));
      for (OwnFrame& frame : decoded(chunked, Bytes(line).subspan(at, size))) received.push_back(std::move(frame));
      at += size;
    }
    EXPECT_EQ(received, sent) << round;
    frames += sent.size();
  }
  for (const FrameDecoder* decoder : {&whole, &chunked}) {
    EXPECT_EQ(decoder->counts().good, frames);
    EXPECT_EQ(decoder->counts().damaged(), 0U);
  }
  EXPECT_EQ(whole.counts().bytes, chunked.counts().bytes);
}

TEST(Frame, IsNotWrittenWhereItDoesNotFit) {
  FrameBytes out(kLongestFrame, 7);
  EXPECT_EQ(encode_frame({}, FrameBytes(kLongestPayload + 1), out), 0U);
  EXPECT_EQ(encode_frame({}, FrameBytes(20), std::span(out).first(frame_size(20) - 1)), 0U);
  EXPECT_THAT(out, ::testing::Each(7));
  EXPECT_EQ(encode_frame({}, FrameBytes(kLongestPayload), out), kLongestFrame);
}

TEST(FrameDecoder, CountsWhatIsWrongWithAFrameAndTakesTheNext) {
  const FrameBytes payload = {1, 2, 3, 0, 5};
  const FrameBytes good = encoded({.kind = 1, .run = 2, .sequence = 3}, payload);
  FrameDecoder decoder;
  const auto after = [&](FrameBytes damaged) {
    damaged.insert(damaged.end(), good.begin(), good.end());
    return decoded(decoder, damaged).size();
  };
  FrameBytes flipped = good;
  flipped[10] ^= 0x40U;
  EXPECT_EQ(after(flipped), 1U);
  EXPECT_EQ(decoder.counts().bad_crc, 1U);

  FrameBytes beyond = good;
  beyond[0] = 200;  // leads beyond the end
  EXPECT_EQ(after(beyond), 1U);
  EXPECT_EQ(after({3, 1, 2, 0}), 1U);  // too short for a header
  EXPECT_EQ(decoder.counts().malformed, 2U);

  FrameBytes noise(kLongestFrame, 1);
  noise.push_back(0);
  EXPECT_EQ(after(noise), 1U);
  EXPECT_EQ(after(FrameBytes(kLongestFrame * 10, 9)), 0U);  // swallows the frame after it: no zero between
  EXPECT_EQ(decoder.counts().too_long, 2U);

  // A flipped zero joins two frames: both are lost, the third is not.
  FrameBytes joined = good;
  joined.back() = 0x80;
  joined.insert(joined.end(), good.begin(), good.end());
  EXPECT_EQ(after(joined), 1U);
  EXPECT_EQ(decoder.counts().damaged(), 6U);
  EXPECT_EQ(decoder.counts().good, 5U);
  EXPECT_EQ(decoder.counts().other_version, 0U);
}

TEST(FrameDecoder, StartsInTheMiddleOfAStream) {
  FrameBytes line;
  for (std::uint32_t k = 0; k < 20; ++k) {
    const FrameBytes bytes = encoded({.kind = 1, .run = 7, .sequence = k}, FrameBytes(k, static_cast<std::uint8_t>(k)));
    line.insert(line.end(), bytes.begin(), bytes.end());
  }
  for (std::size_t start = 1; start < line.size(); ++start) {
    FrameDecoder decoder;
    const std::vector<OwnFrame> frames = decoded(decoder, Bytes(line).subspan(start));
    const auto complete =
        static_cast<std::size_t>(std::count(line.begin() + start, line.end(), 0) - (line[start - 1] != 0 ? 1 : 0));
    EXPECT_EQ(frames.size(), complete) << start;
  }
}

TEST(FrameDecoder, StandsAnyBytes) {
  numerics::RandomStream random(2, "noise");
  FrameDecoder decoder;
  std::uint64_t bytes = 0;
  for (int round = 0; round < 10'000; ++round) {
    FrameBytes noise(random.index(400));
    const std::uint64_t zeros = 1 + random.index(200);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random.index(zeros) == 0 ? 0 : random.index(256));
    bytes += noise.size();
    EXPECT_TRUE(decoded(decoder, noise).empty());
  }
  EXPECT_EQ(decoder.counts().bytes, bytes);
  EXPECT_EQ(decoder.counts().good + decoder.counts().other_version, 0U);
  EXPECT_GT(decoder.counts().malformed, 1000U);
  EXPECT_GT(decoder.counts().too_long, 1000U);
  EXPECT_GT(decoder.counts().bad_crc, 10U);
}

struct DamageCount {
  std::uint64_t damaged = 0;  ///< sent frames with a flipped byte
  std::uint64_t wrong = 0;    ///< received frames that nobody sent
  std::uint64_t received = 0;
};

/// Sends frames of a command's and a report's length over a line that flips 1 % of the bytes.
DamageCount send_damaged(std::uint64_t frames, bool single_bits, FrameDecoder& decoder) {
  FlippedBytes line(0.01, 3, single_bits);
  numerics::RandomStream random(4, "payloads");
  DamageCount count;
  std::array<std::uint8_t, kLongestFrame> buffer;
  std::array<std::array<std::uint8_t, 40>, 4> payloads;  // the last four sent, by sequence
  std::array<std::size_t, 4> sizes = {};
  for (std::uint32_t k = 0; k < frames; ++k) {
    std::array<std::uint8_t, 40>& payload = payloads[k % 4];
    for (std::size_t at = 0; at < payload.size(); at += 8) {
      const std::uint64_t word = random.index(~std::uint64_t{0});
      for (std::size_t byte = 0; byte < 8; ++byte) payload[at + byte] = static_cast<std::uint8_t>(word >> (8 * byte));
    }
    payload[k % 12] = 0;  // stuffing has something to do
    sizes[k % 4] = k % 2 == 0 ? 12 : 40;
    const Bytes sent = Bytes(payload).first(sizes[k % 4]);
    const std::size_t size = encode_frame({.kind = 1, .run = 77, .sequence = k}, sent, buffer);
    if (line.damage(std::span(buffer).first(size)) > 0) ++count.damaged;
    Bytes bytes = Bytes(buffer).first(size);
    while (const std::optional<SerialFrame> frame = decoder.next(bytes)) {
      ++count.received;
      const FrameHeader& header = frame->header;
      const bool right =
          header.kind == 1 && header.run == 77 && k - header.sequence < 4 &&
          frame->payload.size() == sizes[header.sequence % 4] &&
          std::equal(frame->payload.begin(), frame->payload.end(), payloads[header.sequence % 4].begin());
      if (!right) ++count.wrong;
    }
  }
  return count;
}

void expect_no_wrong_frame(std::uint64_t frames, bool single_bits) {
  FrameDecoder decoder;
  const DamageCount count = send_damaged(frames, single_bits, decoder);
  const FrameCounts& seen = decoder.counts();
  EXPECT_EQ(count.wrong, 0U);
  EXPECT_EQ(count.received, seen.good);
  const auto share = [&](std::uint64_t part) { return static_cast<double>(part) / static_cast<double>(frames); };
  // Half of the frames have 27 bytes, half 55: 1 - 0.99^27 and 1 - 0.99^55 of them have a flipped one.
  const double expected = 1.0 - 0.5 * (std::pow(0.99, 27) + std::pow(0.99, 55));
  EXPECT_NEAR(share(count.damaged), expected, 4.0 * std::sqrt(0.25 / static_cast<double>(frames)));
  // Those whose neighbour's zero before them was flipped are lost as well: 1 % of the whole ones.
  EXPECT_NEAR(share(count.received), (1.0 - expected) * 0.99, 4.0 * std::sqrt(0.25 / static_cast<double>(frames)));
  fmt::print("{} frames, {} bytes: {} damaged, {} received, {} wrong; bad CRC {}, malformed {}, too long {}\n", frames,
             seen.bytes, count.damaged, count.received, count.wrong, seen.bad_crc, seen.malformed, seen.too_long);
}

TEST(FrameDecoder, LetsNoDamagedFrameThrough) {
  expect_no_wrong_frame(100'000, false);
  expect_no_wrong_frame(100'000, true);
}

/// 1e7 damaged ones: one in three of those sent.
TEST(FrameSoak, LetsNoneOfTenMillionDamagedFramesThroughWithBytesFlipped) {
  expect_no_wrong_frame(veridyn::test::kSanitized ? 3'100'000 : 31'000'000, false);
}
TEST(FrameSoak, LetsNoneOfTenMillionDamagedFramesThroughWithSingleBitsFlipped) {
  expect_no_wrong_frame(veridyn::test::kSanitized ? 3'100'000 : 31'000'000, true);
}

}  // namespace
}  // namespace veridyn::live
