#include "veridyn/io/tables/npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied as they lie in the file");

constexpr std::string_view kNpyMagic = "\x93NUMPY";

struct ArrayHeader {
  std::string type;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
};

/// View of a header: a Python dictionary of exactly three keys, of which only this much Python is understood.
class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::string& source) : rest_(text), source_(source) {}

  ArrayHeader run() {
    ArrayHeader header;
    bool type = false, order = false, shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr" && !type) {
        type = true;
        if (next() == '[') fail("arrays of records are not supported");
        header.type = quoted();
      } else if (key == "fortran_order" && !order) {
        order = true;
        header.fortran_order = truth();
      } else if (key == "shape" && !shape) {
        shape = true;
        header.shape = extents();
      } else {
        fail(fmt::format("key '{}' is unknown or there twice", shown(key)));
      }
      if (take('}')) break;
      expect(',');
    }
    if (next() != '\0') fail("goes on after its end");
    if (!type || !order || !shape) fail("lacks descr, fortran_order or shape");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_, "NumPy header: " + what); }

  char next() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\n' || rest_.front() == '\t'))
      rest_.remove_prefix(1);
    return rest_.empty() ? '\0' : rest_.front();
  }
  bool take(char c) {
    if (c == '\0' || next() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("'{}' expected before '{}'", c, shown(rest_)));
  }
  std::string quoted() {
    const char quote = next();
    if (quote != '\'' && quote != '"') fail(fmt::format("a text expected before '{}'", shown(rest_)));
    const std::size_t end = rest_.find(quote, 1);
    if (end == std::string_view::npos) fail("a quote is missing");
    std::string text(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return text;
  }
  bool truth() {
    next();
    for (const std::string_view word : {"True", "False"}) {
      if (!rest_.starts_with(word)) continue;
      rest_.remove_prefix(word.size());
      return word == "True";
    }
    fail(fmt::format("True or False expected before '{}'", shown(rest_)));
  }
  std::vector<std::size_t> extents() {
    std::vector<std::size_t> result;
    expect('(');
    while (!take(')')) {
      std::size_t value = 0;
      std::size_t digits = 0;
      next();
      while (!rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9' && digits < 15) {
        value = 10 * value + static_cast<std::size_t>(rest_.front() - '0');
        rest_.remove_prefix(1);
        ++digits;
      }
      if (digits == 0) fail(fmt::format("an extent expected before '{}'", shown(rest_)));
      take('L');  // Python 2
      result.push_back(value);
      if (result.size() > 32) fail("has more than 32 dimensions");
      if (take(')')) break;
      expect(',');
    }
    return result;
  }

  std::string_view rest_;
  const std::string& source_;
};

template <typename Stored>
std::vector<Column> columns_of(std::string_view data, std::size_t rows, std::size_t columns, bool fortran_order) {
  std::vector<Column> result;
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<Stored> values(rows);
    for (std::size_t r = 0; r < rows; ++r) {
      const std::size_t at = fortran_order ? c * rows + r : r * columns + c;
      std::memcpy(&values[r], data.data() + at * sizeof(Stored), sizeof(Stored));
    }
    result.emplace_back(std::move(values));
  }
  return result;
}

using Reader = std::vector<Column> (*)(std::string_view, std::size_t, std::size_t, bool);
struct KnownType {
  std::string_view name;  ///< without the byte order
  std::size_t size;
  Reader read;
};
constexpr std::array<KnownType, 11> kTypes{{{"f8", 8, columns_of<double>},
                                            {"f4", 4, columns_of<float>},
                                            {"i1", 1, columns_of<std::int8_t>},
                                            {"u1", 1, columns_of<std::uint8_t>},
                                            {"b1", 1, columns_of<std::uint8_t>},
                                            {"i2", 2, columns_of<std::int16_t>},
                                            {"u2", 2, columns_of<std::uint16_t>},
                                            {"i4", 4, columns_of<std::int32_t>},
                                            {"u4", 4, columns_of<std::uint32_t>},
                                            {"i8", 8, columns_of<std::int64_t>},
                                            {"u8", 8, columns_of<std::uint64_t>}}};

}  // namespace

bool is_npy(std::string_view bytes) { return bytes.starts_with(kNpyMagic); }

NpyArray read_npy(std::string_view bytes, const std::string& source) {
  if (!is_npy(bytes)) throw InputError(source, "is no NumPy array file");
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])); };
  if (bytes.size() < 10) throw InputError(source, "is cut: the header has no length");
  const std::size_t version = byte(6);
  if (version < 1 || version > 3 || byte(7) != 0)
    throw InputError(source, fmt::format("NumPy format version {}.{} is not supported; 1 to 3 are", version, byte(7)));
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  const std::size_t start = 8 + length_bytes;
  if (bytes.size() < start) throw InputError(source, "is cut: the header has no length");
  std::size_t length = 0;
  for (std::size_t k = 0; k < length_bytes; ++k) length |= byte(8 + k) << (8 * k);
  if (length > bytes.size() - start)
    throw InputError(source,
                     fmt::format("is cut: {} of {} bytes of its header are there", bytes.size() - start, length));
  const ArrayHeader header = HeaderParser(bytes.substr(start, length), source).run();
  const std::string_view data = bytes.substr(start + length);

  const std::string_view type = header.type;
  const KnownType* known = nullptr;
  for (const KnownType& candidate : kTypes) {
    const char order = type.empty() ? '\0' : type.front();
    const bool ordered = order == '<' || (order == '|' && candidate.size == 1);
    if (ordered && type.substr(1) == candidate.name) known = &candidate;
  }
  if (known == nullptr)
    throw InputError(source, fmt::format("numbers of type '{}' are not supported; little-endian floats of 4 and 8 "
                                         "bytes, integers and bool are",
                                         shown(type)));
  if (header.shape.empty() || header.shape.size() > 2)
    throw InputError(source, fmt::format("has {} dimensions; 1 and 2 are supported", header.shape.size()));
  NpyArray array;
  array.type = header.type;
  array.shape = header.shape;
  const std::size_t rows = header.shape.front();
  const std::size_t columns = header.shape.size() == 2 ? header.shape[1] : 1;
  // Extents have at most 15 digits; their product is compared before it could overflow.
  const std::size_t available = data.size() / known->size;
  const bool fits = rows == 0 || columns == 0 || columns <= available / rows;
  if (!fits || rows * columns > available)
    throw InputError(source, fmt::format("is cut: {} numbers of {} x {} are there", available, rows, columns));
  if (data.size() != rows * columns * known->size)
    throw InputError(source, fmt::format("holds {} bytes more than its shape {} x {} needs",
                                         data.size() - rows * columns * known->size, rows, columns));
  if (rows == 0 && columns > 0) {
    array.columns.resize(std::min<std::size_t>(columns, 1));
    return array;
  }
  array.columns = known->read(data, rows, columns, header.fortran_order);
  return array;
}

}  // namespace veridyn::io
