#pragma once

#include <cstdint>
#include <vector>

#include "veridyn/io/log/column.hpp"

namespace veridyn::io {

/// Little-endian types of the fields in binary logs.
enum class GatherType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kHalf,  ///< IEEE 754 binary16; becomes float
  kFloat,
  kDouble,
  kText,  ///< ends at the first NUL
};

/// A field that lies at the same place in every record.
struct GatherColumn {
  GatherType type = GatherType::kUint8;
  std::uint32_t offset = 0;  ///< bytes from the start of the record
  std::uint32_t size = 1;    ///< bytes; of texts only
};

/// Turns records into columns: `records` are the places of the records behind `data`, each of which must hold all
/// columns. Records are taken in blocks that stay in the cache while their columns are filled one after the other.
[[nodiscard]] std::vector<Column> gather(const char* data, const std::vector<std::uint64_t>& records,
                                         const std::vector<GatherColumn>& columns);

}  // namespace veridyn::io
