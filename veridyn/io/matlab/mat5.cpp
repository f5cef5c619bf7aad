#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "veridyn/core/bytes.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/matlab/mat_objects.hpp"
#include "veridyn/io/matlab/mat_value.hpp"

namespace veridyn::io {
namespace {

constexpr std::size_t kFileHeader = 128;

enum Stored : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
  kInt64 = 12,
  kUint64 = 13,
  kMatrix = 14,
  kCompressed = 15,
  kUtf8 = 16,
  kUtf16 = 17,
  kUtf32 = 18,
};

enum Class : std::uint32_t {
  kCellClass = 1,
  kStructClass = 2,
  kCharClass = 4,
  kDoubleClass = 6,
  kUint8Class = 9,
  kUint64Class = 15,
  kOpaqueClass = 17,
};

struct Element {
  std::uint32_t type = 0;
  std::string_view data;
};

std::size_t width_of(std::uint32_t type) {
  switch (type) {
    case kInt8:
    case kUint8:
    case kUtf8:
      return 1;
    case kInt16:
    case kUint16:
    case kUtf16:
      return 2;
    case kInt32:
    case kUint32:
    case kSingle:
    case kUtf32:
      return 4;
    case kDouble:
    case kInt64:
    case kUint64:
      return 8;
    default:
      return 0;
  }
}

double number_at(const char* from, std::uint32_t type, bool swap) {
  switch (type) {
    case kInt8:
      return static_cast<double>(load_number<std::int8_t>(from, swap));
    case kUint8:
    case kUtf8:
      return static_cast<double>(load_number<std::uint8_t>(from, swap));
    case kInt16:
      return static_cast<double>(load_number<std::int16_t>(from, swap));
    case kUint16:
    case kUtf16:
      return static_cast<double>(load_number<std::uint16_t>(from, swap));
    case kInt32:
      return static_cast<double>(load_number<std::int32_t>(from, swap));
    case kUint32:
    case kUtf32:
      return static_cast<double>(load_number<std::uint32_t>(from, swap));
    case kSingle:
      return static_cast<double>(load_number<float>(from, swap));
    case kInt64:
      return static_cast<double>(load_number<std::int64_t>(from, swap));
    case kUint64:
      return static_cast<double>(load_number<std::uint64_t>(from, swap));
    default:
      return load_number<double>(from, swap);
  }
}

/// View of elements one after the other; each is a tag and data padded to eight bytes.
class Elements {
 public:
  Elements(std::string_view bytes, bool swap) : rest_(bytes), swap_(swap) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

  std::optional<Element> next(bool padded = true) {
    if (rest_.size() < 8) return std::nullopt;
    const auto word = load_number<std::uint32_t>(rest_.data(), swap_);
    if ((word >> 16U) != 0) {  // up to four bytes lie inside of the tag
      const std::size_t size = word >> 16U;
      if (size > 4) return std::nullopt;
      const Element element{word & 0xffffU, rest_.substr(4, size)};
      rest_.remove_prefix(8);
      return element;
    }
    const std::size_t size = load_number<std::uint32_t>(rest_.data() + 4, swap_);
    if (size > rest_.size() - 8) return std::nullopt;
    const Element element{word, rest_.substr(8, size)};
    // The last element of a compressed variable may lack its padding.
    const std::size_t step = word != kCompressed && padded ? (size + 7) / 8 * 8 : size;
    rest_.remove_prefix(std::min(rest_.size(), 8 + step));
    return element;
  }

 private:
  std::string_view rest_;
  bool swap_;
};

/// What a compressed element expands to, which its own tag says ahead of all the rest.
std::optional<std::string> inflated(std::string_view packed, bool swap, const MatBudget& budget,
                                    const std::string& source) {
  constexpr std::size_t kTag = 8;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  // zlib counts in 32 bits, and so do the sizes of the format.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string result(kTag, '\0');
  std::size_t filled = 0;
  const auto fill = [&] {
    int state = Z_OK;
    while (state == Z_OK && filled < result.size()) {
      stream.next_out = reinterpret_cast<Bytef*>(result.data() + filled);
      stream.avail_out = static_cast<uInt>(result.size() - filled);
      const uInt free_bytes = stream.avail_out;
      state = inflate(&stream, Z_NO_FLUSH);
      filled += free_bytes - stream.avail_out;
    }
    return state == Z_OK || state == Z_STREAM_END;
  };
  bool good = fill() && filled == kTag;
  const std::size_t size = good ? load_number<std::uint32_t>(result.data() + 4, swap) : 0;
  try {
    require_mat_size(static_cast<double>(size), "", source);
    budget.require_room(static_cast<double>(size), "");
  } catch (const InputError&) {
    inflateEnd(&stream);
    throw;
  }
  if (good) {
    result.resize(kTag + size);
    good = fill() && filled == result.size();
  }
  inflateEnd(&stream);
  return good ? std::optional(std::move(result)) : std::nullopt;
}

class Parser {
 public:
  Parser(bool swap, std::string source) : swap_(swap), budget_(std::move(source)) {}

  [[nodiscard]] const MatBudget& budget() const { return budget_; }
  [[nodiscard]] std::string take_subsystem() { return std::move(subsystem_); }

  std::optional<MatValue> matrix(std::string_view bytes, int depth) {
    MatValue value;
    if (bytes.empty()) return value;  // an empty cell
    if (depth > kDeepestMatNesting) return std::nullopt;
    Elements elements(bytes, swap_);
    const auto flags = elements.next();
    if (!flags || flags->type != kUint32 || flags->data.size() < 8) return std::nullopt;
    const std::uint32_t kind = load_number<std::uint32_t>(flags->data.data(), swap_) & 0xffU;
    if (kind == kOpaqueClass) return object(std::move(value), elements, depth);
    const auto extents = elements.next();
    if (!extents || extents->type != kInt32 || extents->data.size() < 8) return std::nullopt;
    std::size_t count = 1;
    for (std::size_t i = 0; i + 4 <= extents->data.size(); i += 4) {
      const auto extent = load_number<std::int32_t>(extents->data.data() + i, swap_);
      if (extent < 0) return std::nullopt;
      value.extents.push_back(static_cast<std::size_t>(extent));
      count *= static_cast<std::size_t>(extent);
      if (count > kLargestCount) return std::nullopt;
    }
    const auto name = elements.next();
    if (!name || name->type != kInt8) return std::nullopt;
    value.name = internal::printable(name->data);
    if (depth == 0 && value.name.empty() && kind == kUint8Class) {
      keep_subsystem(elements, count);
      return value;
    }
    switch (kind) {
      case kCellClass:
        return cells(std::move(value), elements, count, depth);
      case kStructClass:
        return fields(std::move(value), elements, count, depth);
      case kCharClass:
        return text(std::move(value), elements);
      default:
        // Sparse matrices, objects and functions are known to be there, but not read.
        return kind >= kDoubleClass && kind <= kUint64Class ? numbers(std::move(value), elements, count) : value;
    }
  }

 private:
  std::optional<MatValue> numbers(MatValue value, Elements& elements, std::size_t count) {
    value.kind = MatValue::Kind::kNumbers;
    if (count == 0) return value;
    const auto data = elements.next();
    const std::size_t width = data ? width_of(data->type) : 0;
    if (width == 0 || data->data.size() / width < count) return std::nullopt;
    budget_.take(8.0 * static_cast<double>(count), value.name);
    value.numbers.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      value.numbers[i] = number_at(data->data.data() + i * width, data->type, swap_);
    }
    return value;
  }

  /// An object of a class of MATLAB's own: its name, that of its class, and a reference to what it holds, or, of the
  /// wrapper of all objects, the cells that hold it.
  std::optional<MatValue> object(MatValue value, Elements& elements, int depth) {
    // Name, system and class; the wrapper in the subsystem may lack the name.
    std::vector<std::string_view> words;
    std::optional<Element> content = elements.next();
    for (; content && content->type == kInt8 && words.size() < 3; content = elements.next())
      words.push_back(content->data);
    if (words.size() < 2) return value;
    if (words.size() == 3) value.name = internal::printable(words.front());
    value.class_name = internal::printable(words.back());
    if (words[words.size() - 2] != "MCOS" || !content || content->type != kMatrix) return value;
    auto held = matrix(content->data, depth + 1);
    if (!held) return value;
    value.numbers = std::move(held->numbers);
    value.items = std::move(held->items);
    value.extents = std::move(held->extents);
    return value;
  }

  std::optional<MatValue> text(MatValue value, Elements& elements) {
    value.kind = MatValue::Kind::kText;
    const auto data = elements.next();
    if (!data) return value;
    const std::size_t width = width_of(data->type);
    if (width == 0) return std::nullopt;
    const std::size_t count = data->data.size() / width;
    budget_.take(static_cast<double>(count), value.name);
    std::string characters;
    for (std::size_t i = 0; i + width <= data->data.size(); i += width) {
      const double code = number_at(data->data.data() + i, data->type, swap_);
      characters += code >= 0.0 && code < 127.0 ? static_cast<char>(code) : '?';
    }
    value.text = internal::printable(characters);
    return value;
  }

  std::optional<MatValue> cells(MatValue value, Elements& elements, std::size_t count, int depth) {
    value.kind = MatValue::Kind::kCell;
    if (count > elements.left() / 8) return std::nullopt;
    take_items(count, value);
    for (std::size_t i = 0; i < count; ++i) {
      const auto element = elements.next();
      if (!element || element->type != kMatrix) return std::nullopt;
      auto item = matrix(element->data, depth + 1);
      if (!item) return std::nullopt;
      value.items.push_back(std::move(*item));
    }
    return value;
  }

  std::optional<MatValue> fields(MatValue value, Elements& elements, std::size_t count, int depth) {
    value.kind = MatValue::Kind::kStruct;
    const auto length = elements.next();
    if (!length || length->type != kInt32 || length->data.size() < 4) return std::nullopt;
    const auto width = load_number<std::int32_t>(length->data.data(), swap_);
    const auto names = elements.next();
    if (!names || names->type != kInt8 || width <= 0 || width > 4096) return std::nullopt;
    const auto size = static_cast<std::size_t>(width);
    const std::size_t field_count = names->data.size() / size;
    if (field_count > 0 && count > elements.left() / 8 / field_count) return std::nullopt;
    if (field_count == 0) return value;
    take_items(count * field_count, value);
    for (std::size_t i = 0; i < count * field_count; ++i) {
      const auto element = elements.next();
      if (!element || element->type != kMatrix) return std::nullopt;
      auto item = matrix(element->data, depth + 1);
      if (!item) return std::nullopt;
      const std::string_view name = names->data.substr(i % field_count * size, size);
      item->name = internal::printable(name.substr(0, name.find('\0')));
      value.items.push_back(std::move(*item));
    }
    return value;
  }

  /// Room for cells or fields, each of which takes more than its eight bytes in the file.
  void take_items(std::size_t count, MatValue& value) {
    budget_.take(static_cast<double>(count * sizeof(MatValue)), value.name);
    value.items.reserve(count);
  }

  /// The bytes that hold the objects of the file, which stand in it as an array without a name.
  void keep_subsystem(Elements& elements, std::size_t count) {
    const auto data = elements.next();
    if (!data || data->type != kUint8 || data->data.size() != count) return;
    budget_.take(static_cast<double>(count), "");
    subsystem_ = data->data;
  }

  static constexpr std::size_t kLargestCount = std::size_t{1} << 31U;

  bool swap_;
  MatBudget budget_;
  std::string subsystem_;
};

/// The objects of a subsystem, which is laid out like a file: four bytes of version and byte order, four of nothing,
/// then a struct whose field MCOS is the wrapper of all objects.
std::optional<MatObjects> objects_in(Parser& parser, bool swap) {
  constexpr std::size_t kHeader = 8;
  const std::string bytes = parser.take_subsystem();
  if (bytes.size() < kHeader || (bytes[2] == 'M') != swap) return std::nullopt;
  const auto element = Elements(std::string_view(bytes).substr(kHeader), swap).next();
  if (!element || element->type != kMatrix) return std::nullopt;
  std::optional<MatValue> value = parser.matrix(element->data, 1);
  if (!value || value->items.size() != 1 || value->items[0].name != "MCOS") return std::nullopt;
  MatValue& wrapper = value->items[0];
  return wrapper.class_name == "FileWrapper__" ? MatObjects::read(std::move(wrapper.items), swap) : std::nullopt;
}

/// Tables and timetables as structs of their columns; other objects, and those that cannot be understood, as they are.
void take_objects(std::vector<MatValue> waiting, Parser& parser, bool swap, const std::function<void(MatValue&&)>& take,
                  LogDamage& damage) {
  if (waiting.empty()) return;
  const std::optional<MatObjects> objects = objects_in(parser, swap);
  for (MatValue& object : waiting) {
    std::vector<std::string> left_out;
    std::optional<MatValue> table = objects ? objects->table(object, left_out) : std::nullopt;
    if (!table) {
      object.numbers.clear();
      take(std::move(object));
      continue;
    }
    if (!left_out.empty())
      damage.notes.push_back(fmt::format("columns of {} '{}' that hold no numbers are left out: {}", object.class_name,
                                         object.name, fmt::join(left_out, ", ")));
    take(*std::move(table));
  }
}

}  // namespace

void MatBudget::require_room(double bytes, std::string_view variable) const {
  if (taken_ + bytes <= static_cast<double>(kLargestMatFile)) return;
  throw InputError(source_,
                   fmt::format("its variables take more than the {} MiB that they may together{}: save it in "
                               "parts",
                               kLargestMatFile >> 20U, variable.empty() ? "" : fmt::format(", with '{}'", variable)));
}

void MatBudget::take(double bytes, std::string_view variable) {
  require_mat_size(bytes, variable, source_);
  require_room(bytes, variable);
  taken_ += bytes;
}

void require_mat_size(double bytes, std::string_view name, const std::string& source) {
  if (bytes <= static_cast<double>(kLargestMatVariable)) return;
  const std::string variable = name.empty() ? "a variable" : fmt::format("variable '{}'", name);
  throw InputError(source, fmt::format("{} takes {:.0f} MiB, more than the {} MiB that one may: save it in parts",
                                       variable, bytes / 1048576.0, kLargestMatVariable >> 20U));
}

std::size_t MatValue::count() const {
  std::size_t product = extents.empty() ? 0 : 1;
  for (const std::size_t extent : extents) product *= extent;
  return product;
}

const MatValue* MatValue::find(std::string_view field) const {
  for (const MatValue& item : items) {
    if (item.name == field) return &item;
  }
  return nullptr;
}

void read_mat5(std::string_view bytes, const std::string& source, const std::function<void(MatValue&&)>& take,
               LogDamage& damage) {
  if (bytes.size() < kFileHeader) {
    damage.bytes_lost += bytes.size();
    damage.notes.emplace_back("the file ends inside its header");
    return;
  }
  // "MI" as written by a machine of the other byte order reads "IM".
  const bool swap = bytes[126] == 'M';
  Parser parser(swap, source);
  Elements elements(bytes.substr(kFileHeader), swap);
  std::vector<MatValue> waiting;  // for the objects that they refer to, at the end of the file
  while (!elements.empty()) {
    const std::size_t left = elements.left();
    const auto element = elements.next();
    if (!element) {
      damage.bytes_lost += left;
      ++damage.records_lost;
      damage.notes.emplace_back("the file ends in the middle of a variable");
      break;
    }
    std::optional<MatValue> value;
    if (element->type == kCompressed) {
      if (const auto plain = inflated(element->data, swap, parser.budget(), source)) {
        Elements inner(*plain, swap);
        const auto matrix = inner.next();
        if (matrix && matrix->type == kMatrix) value = parser.matrix(matrix->data, 0);
      }
    } else if (element->type == kMatrix) {
      value = parser.matrix(element->data, 0);
    }
    if (value) {
      if (!value->class_name.empty()) {
        waiting.push_back(std::move(*value));
      } else if (!value->name.empty()) {
        take(std::move(*value));
      }
    } else {
      damage.bytes_lost += element->data.size();
      ++damage.records_lost;
    }
  }
  take_objects(std::move(waiting), parser, swap, take, damage);
}

}  // namespace veridyn::io
