#include "veridyn/io/ros/message_definition.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace veridyn::io::internal {
namespace {

constexpr std::size_t kMostFields = 10'000;
constexpr std::string_view kBlanks = " \t\r";

bool is_primitive(std::string_view type) {
  constexpr std::array<std::string_view, 15> kPrimitives{"bool",   "byte",    "char",    "int8",   "uint8",
                                                         "int16",  "uint16",  "int32",   "uint32", "int64",
                                                         "uint64", "float32", "float64", "string", "wstring"};
  return std::ranges::find(kPrimitives, type) != kPrimitives.end();
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string_view trimmed_left(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
}

std::string full_type(std::string_view type, std::string_view package) {
  if (is_primitive(type)) return std::string(type);
  if (type == "time") return "builtin_interfaces/Time";
  if (type == "duration") return "builtin_interfaces/Duration";
  if (type == "Header") return "std_msgs/Header";
  if (type.find('/') != std::string_view::npos || package.empty()) return plain_ros_type(type);
  return std::string(package) + '/' + std::string(type);
}

/// "float64[9]", "string<=20[<=5]", "geometry_msgs/msg/Point[]"; false where it is none.
bool parse_type(std::string_view text, std::string_view package, RosField& field) {
  const std::size_t bracket = text.find('[');
  std::string_view base = text.substr(0, bracket);
  base = base.substr(0, base.find("<="));
  if (base.empty() || !std::ranges::all_of(base, [](char c) { return is_name_character(c) || c == '/'; })) return false;
  field.type = full_type(base, package);
  if (bracket == std::string_view::npos) return true;
  if (text.back() != ']') return false;
  const std::string_view count = text.substr(bracket + 1, text.size() - bracket - 2);
  if (count.empty() || count.starts_with("<=")) {
    field.shape = RosField::Shape::kSequence;
    return true;
  }
  field.shape = RosField::Shape::kArray;
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), field.count);
  return error == std::errc() && end == count.data() + count.size() && field.count > 0;
}

enum class LineKind { kNothing, kField, kMalformed };

LineKind parse_line(std::string_view line, std::string_view package, RosField& field) {
  line = trimmed_left(line);
  if (line.empty() || line.front() == '#') return LineKind::kNothing;
  const std::size_t type_end = std::min(line.find_first_of(kBlanks), line.size());
  if (!parse_type(line.substr(0, type_end), package, field)) return LineKind::kMalformed;
  const std::string_view rest = trimmed_left(line.substr(type_end));
  std::size_t end = 0;
  while (end < rest.size() && is_name_character(rest[end])) ++end;
  if (end == 0) return LineKind::kMalformed;
  if (trimmed_left(rest.substr(end)).starts_with('=')) return LineKind::kNothing;  // a constant
  field.name = rest.substr(0, end);
  return LineKind::kField;
}

bool is_separator(std::string_view line) {
  const std::size_t end = line.find_last_not_of(kBlanks);
  return end != std::string_view::npos && end >= 9 &&
         line.substr(0, end + 1).find_first_not_of('=') == std::string_view::npos;
}

std::string_view package_of(std::string_view type) {
  const std::size_t slash = type.find('/');
  return slash == std::string_view::npos ? std::string_view() : type.substr(0, slash);
}

}  // namespace

std::string plain_ros_type(std::string_view type) {
  std::string plain(type);
  if (const std::size_t middle = plain.find("/msg/"); middle != std::string::npos) plain.erase(middle, 4);
  return plain;
}

std::optional<RosDefinitions> parse_ros_definitions(std::string_view type, std::string_view text) {
  RosDefinitions definitions;
  definitions.root = plain_ros_type(type);
  std::string current = definitions.root;
  RosFields* fields = &definitions.types[current];
  std::size_t count = 0;
  bool new_type = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (is_separator(line)) {
      new_type = true;
      continue;
    }
    if (new_type) {
      line = trimmed_left(line);
      if (line.empty()) continue;
      if (!line.starts_with("MSG: ")) return std::nullopt;
      line = trimmed_left(line.substr(5));
      current = plain_ros_type(line.substr(0, line.find_first_of(kBlanks)));
      fields = &definitions.types[current];
      fields->clear();
      new_type = false;
      continue;
    }
    RosField field;
    const LineKind kind = parse_line(line, package_of(current), field);
    if (kind == LineKind::kMalformed || ++count > kMostFields) return std::nullopt;
    if (kind == LineKind::kField) fields->push_back(std::move(field));
  }
  return definitions;
}

}  // namespace veridyn::io::internal
