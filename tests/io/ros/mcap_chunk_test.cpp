#include "veridyn/io/ros/mcap_chunk.hpp"

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

namespace veridyn::io::internal {
namespace {

std::string sample() {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i * 7919 % 10007) + ' ';
  return text;
}

std::string packed(std::string_view compression, const std::string& text) {
  std::string out(2 * text.size() + 1000, '\0');
  out.resize(compression == "lz4" ? LZ4F_compressFrame(out.data(), out.size(), text.data(), text.size(), nullptr)
                                  : ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 3));
  return out;
}

TEST(UnpackChunk, UnpacksWhatWasPackedAndTheBeginningOfWhatWasCut) {
  const std::string text = sample();
  for (const char* compression : {"lz4", "zstd"}) {
    SCOPED_TRACE(compression);
    const std::string all = packed(compression, text);
    std::string buffer;
    const UnpackedChunk whole = unpack_chunk(compression, all, text.size(), buffer);
    EXPECT_TRUE(whole.sound && whole.complete);
    EXPECT_EQ(whole.records, text);
    const UnpackedChunk cut = unpack_chunk(compression, all.substr(0, all.size() / 2), text.size(), buffer);
    EXPECT_TRUE(cut.sound);
    EXPECT_FALSE(cut.complete);
    EXPECT_EQ(cut.records, text.substr(0, cut.records.size()));
    EXPECT_FALSE(unpack_chunk(compression, all, text.size() - 1, buffer).sound) << "more than announced";
    const UnpackedChunk less = unpack_chunk(compression, all, text.size() + 1, buffer);
    EXPECT_FALSE(less.sound && less.complete) << "less than announced";
    EXPECT_FALSE(unpack_chunk(compression, "nonsense" + all, text.size(), buffer).sound);
  }
  std::string buffer;
  EXPECT_TRUE(unpack_chunk("", text, text.size(), buffer).complete);
}

TEST(UnpackChunk, RefusesWhatIsTooLargeBeforeItIsAllocated) {
  std::string buffer;
  EXPECT_FALSE(unpack_chunk("zstd", packed("zstd", "x"), 1ULL << 40U, buffer).sound);
  EXPECT_EQ(buffer.capacity(), std::string().capacity());
  EXPECT_FALSE(unpack_chunk("xz", "x", 1, buffer).sound);
}

TEST(UnpackZstdMessage, KnowsItsSizeBefore) {
  const std::string text = sample(), all = packed("zstd", text);
  std::string buffer;
  EXPECT_TRUE(is_zstd(all));
  ASSERT_TRUE(unpack_zstd_message(all, buffer));
  EXPECT_EQ(buffer, text);
  EXPECT_FALSE(unpack_zstd_message(all.substr(0, 50), buffer));
  EXPECT_FALSE(unpack_zstd_message("no", buffer));
}

}  // namespace
}  // namespace veridyn::io::internal
