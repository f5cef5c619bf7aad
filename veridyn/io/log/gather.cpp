#include "veridyn/io/log/gather.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace veridyn::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the logs are little endian and are copied as they are");

constexpr std::size_t kBlock = 512;

template <typename T>
Column make(std::size_t count) {
  return Column(std::vector<T>(count));
}

Column make(GatherType type, std::size_t count) {
  switch (type) {
    case GatherType::kInt8:
      return make<std::int8_t>(count);
    case GatherType::kUint8:
      return make<std::uint8_t>(count);
    case GatherType::kInt16:
      return make<std::int16_t>(count);
    case GatherType::kUint16:
      return make<std::uint16_t>(count);
    case GatherType::kInt32:
      return make<std::int32_t>(count);
    case GatherType::kUint32:
      return make<std::uint32_t>(count);
    case GatherType::kInt64:
      return make<std::int64_t>(count);
    case GatherType::kUint64:
      return make<std::uint64_t>(count);
    case GatherType::kHalf:
    case GatherType::kFloat:
      return make<float>(count);
    case GatherType::kDouble:
      return make<double>(count);
    case GatherType::kText:
      break;
  }
  return Column(TextColumn());
}

float from_half(std::uint16_t bits) {
  const float sign = (bits & 0x8000U) != 0 ? -1.0F : 1.0F;
  const int exponent = (bits >> 10U) & 0x1f;
  const int fraction = bits & 0x3ff;
  if (exponent == 31) return fraction != 0 ? std::nanf("") : sign * INFINITY;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
  return sign * std::ldexp(static_cast<float>(fraction + 1024), exponent - 25);
}

template <typename T>
void fill(std::vector<T>& values, const char* data, const std::uint64_t* records, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) std::memcpy(&values[i], data + records[i], sizeof(T));
}

}  // namespace

std::vector<Column> gather(const char* data, const std::vector<std::uint64_t>& records,
                           const std::vector<GatherColumn>& columns) {
  std::vector<Column> result;
  result.reserve(columns.size());
  for (const GatherColumn& column : columns) result.push_back(make(column.type, records.size()));
  for (std::size_t begin = 0; begin < records.size(); begin += kBlock) {
    const std::size_t end = std::min(records.size(), begin + kBlock);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const char* const from = data + columns[k].offset;
      if (columns[k].type == GatherType::kText) {
        auto& texts = std::get<TextColumn>(result[k].storage());
        for (std::size_t i = begin; i < end; ++i) {
          const std::string_view field(from + records[i], columns[k].size);
          texts.push_back(field.substr(0, field.find('\0')));
        }
      } else if (columns[k].type == GatherType::kHalf) {
        auto& values = std::get<std::vector<float>>(result[k].storage());
        for (std::size_t i = begin; i < end; ++i) {
          std::uint16_t bits = 0;
          std::memcpy(&bits, from + records[i], sizeof bits);
          values[i] = from_half(bits);
        }
      } else {
        std::visit(
            [&](auto& values) {
              if constexpr (!std::is_same_v<std::decay_t<decltype(values)>, TextColumn>) {
                fill(values, from, records.data(), begin, end);
              }
            },
            result[k].storage());
      }
    }
  }
  return result;
}

}  // namespace veridyn::io
