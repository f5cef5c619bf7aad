#include "veridyn/numerics/batches/block_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "veridyn/core/files.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::string_view kBlockFormat = "veridyn block 1\n";
constexpr std::string_view kBlockCheck = "check ";
constexpr std::size_t kHexDigits = 16;

std::string check_line(std::string_view text) {
  Fingerprint sum;
  sum.add(text);
  return fmt::format("{}{:016x}\n", kBlockCheck, sum.value());
}

/// What says of which items a block is.
std::string block_head(const Block& b) {
  return fmt::format("{}batch {}, fingerprint {:016x}\nitems {} to {}\n", kBlockFormat, b.batch, b.fingerprint, b.first,
                     b.first + b.values.size() - 1);
}

/// Takes the next line off `text`, without its end.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::optional<double> value_of_bits(std::string_view digits) {
  std::uint64_t bits = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
  if (digits.size() != kHexDigits || error != std::errc() || stop != digits.data() + digits.size()) return std::nullopt;
  return std::bit_cast<double>(bits);
}

}  // namespace

void write_block(const std::filesystem::path& path, const Block& block) {
  std::string text = block_head(block) + fmt::format("seconds {:.6g}\n", block.seconds);
  for (const double v : block.values) text += fmt::format("{:016x}\n", std::bit_cast<std::uint64_t>(v));
  text += check_line(text);
  write_file(path, text);
}

BlockState read_block(const std::filesystem::path& path, Block& block) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return BlockState::kAbsent;
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::size_t check_size = kBlockCheck.size() + kHexDigits + 1;
  if (content.size() < check_size) return BlockState::kDamaged;
  std::string_view text = std::string_view(content).substr(0, content.size() - check_size);
  if (check_line(text) != std::string_view(content).substr(text.size())) return BlockState::kDamaged;
  const std::string head = block_head(block);
  if (!text.starts_with(head)) return BlockState::kOtherBatch;
  text.remove_prefix(head.size());
  const std::string_view seconds = take_line(text);
  constexpr std::string_view kSeconds = "seconds ";
  Block found = block;
  const char* end = seconds.data() + seconds.size();
  if (!seconds.starts_with(kSeconds) ||
      std::from_chars(seconds.data() + kSeconds.size(), end, found.seconds).ptr != end)
    return BlockState::kDamaged;
  for (double& v : found.values) {
    const std::optional<double> value = value_of_bits(take_line(text));
    if (!value) return BlockState::kDamaged;
    v = *value;
  }
  if (!text.empty()) return BlockState::kDamaged;
  block = std::move(found);
  return BlockState::kRead;
}

}  // namespace veridyn::numerics
