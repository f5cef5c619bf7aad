#include "veridyn/io/ros/mcap_chunk.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>

namespace veridyn::io::internal {
namespace {

constexpr std::uint64_t kLargestUnpacked = 64ULL << 20U;

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { (void)LZ4F_freeDecompressionContext(context); }
};

struct FreeZstd {
  void operator()(ZSTD_DCtx* context) const { (void)ZSTD_freeDCtx(context); }
};

UnpackedChunk unpack_lz4(std::string_view packed, std::string& buffer) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) return {};
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(made);
  std::size_t from = 0, to = 0;
  bool ended = false;
  while (!ended) {
    std::size_t wrote = buffer.size() - to, read = packed.size() - from;
    const std::size_t hint =
        LZ4F_decompress(context.get(), buffer.data() + to, &wrote, packed.data() + from, &read, nullptr);
    if (LZ4F_isError(hint) != 0) return {};
    from += read;
    to += wrote;
    ended = hint == 0;
    if (wrote == 0 && read == 0) break;
  }
  // More than was announced is no chunk.
  if (!ended && from == packed.size() && to < buffer.size())
    return {std::string_view(buffer).substr(0, to), false, true};
  return {std::string_view(buffer).substr(0, to), true, ended && to == buffer.size()};
}

UnpackedChunk unpack_zstd(std::string_view packed, std::string& buffer) {
  const std::unique_ptr<ZSTD_DCtx, FreeZstd> context(ZSTD_createDCtx());
  if (!context) return {};
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  ZSTD_outBuffer out{buffer.data(), buffer.size(), 0};
  std::size_t left = 1;
  while (left != 0) {
    const std::size_t from = in.pos, to = out.pos;
    left = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(left) != 0U) return {};
    if (in.pos == from && out.pos == to) break;
  }
  if (left != 0 && in.pos == in.size && out.pos < out.size)
    return {std::string_view(buffer).substr(0, out.pos), false, true};
  return {std::string_view(buffer).substr(0, out.pos), true, left == 0 && out.pos == out.size};
}

}  // namespace

bool can_unpack(std::string_view compression) {
  return compression.empty() || compression == "lz4" || compression == "zstd";
}

UnpackedChunk unpack_chunk(std::string_view compression, std::string_view packed, std::uint64_t size,
                           std::string& buffer) {
  if (compression.empty()) return {packed, packed.size() == size, packed.size() <= size};
  if (!can_unpack(compression) || size > kLargestChunk) return {};
  buffer.resize(size);
  return compression == "lz4" ? unpack_lz4(packed, buffer) : unpack_zstd(packed, buffer);
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xb5\x2f\xfd"); }

bool unpack_zstd_message(std::string_view packed, std::string& buffer) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > kLargestUnpacked) return false;
  buffer.resize(size);
  const std::size_t wrote = ZSTD_decompress(buffer.data(), buffer.size(), packed.data(), packed.size());
  return ZSTD_isError(wrote) == 0U && wrote == buffer.size();
}

}  // namespace veridyn::io::internal
