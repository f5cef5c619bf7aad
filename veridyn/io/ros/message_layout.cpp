#include "veridyn/io/ros/message_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "veridyn/io/ros/standard_messages.hpp"

namespace veridyn::io::internal {
namespace {

constexpr int kDeepest = 16;
constexpr std::size_t kMostSteps = 20'000, kMostColumns = 2'000;
constexpr std::size_t kLongestArray = 64, kMostParts = 16;

struct Primitive {
  std::string_view name;
  GatherType type;
  std::uint32_t size;
};

constexpr Primitive kNumberTypes[] = {
    {"bool", GatherType::kUint8, 1},    {"byte", GatherType::kUint8, 1},    {"char", GatherType::kUint8, 1},
    {"int8", GatherType::kInt8, 1},     {"uint8", GatherType::kUint8, 1},   {"int16", GatherType::kInt16, 2},
    {"uint16", GatherType::kUint16, 2}, {"int32", GatherType::kInt32, 4},   {"uint32", GatherType::kUint32, 4},
    {"int64", GatherType::kInt64, 8},   {"uint64", GatherType::kUint64, 8}, {"float32", GatherType::kFloat, 4},
    {"float64", GatherType::kDouble, 8}};

const Primitive* number_type(std::string_view name) {
  const auto* const found = std::ranges::find(kNumberTypes, name, &Primitive::name);
  return found == std::end(kNumberTypes) ? nullptr : found;
}

/// Where a field is: its name so far, its unit, and whether its numbers become columns.
struct Place {
  std::string name;
  std::string unit;
  bool kept = true;
  int depth = 0;
};

class LayoutBuilder {
 public:
  LayoutBuilder(const RosDefinitions& definitions, RosEncoding encoding)
      : definitions_(definitions), packed_(encoding == RosEncoding::kRos1) {}

  std::optional<RosLayout> build() {
    if (!add_message(definitions_.root, {}, layout_.steps)) return std::nullopt;
    // One number is the quantity itself.
    const bool simple =
        definitions_.root.starts_with("std_msgs/") || definitions_.root.starts_with("example_interfaces/");
    if (simple && layout_.columns.size() == 1 && layout_.sequences.empty() && layout_.columns.front().name == "data")
      layout_.columns.front().name.clear();
    lay_out(layout_.steps);
    return std::move(layout_);
  }

 private:
  using Steps = std::vector<RosStep>;

  const RosFields* find(std::string_view type) const {
    const auto found = definitions_.types.find(type);
    return found != definitions_.types.end() ? &found->second : find_standard_message(type);
  }

  bool add_message(const std::string& type, const Place& place, Steps& steps) {
    const RosFields* const fields = find(type);
    if (fields == nullptr || place.depth > kDeepest) return false;
    if (fields->empty()) {
      // IDL has no empty structures: ROS 2 puts a byte there.
      if (!packed_) add_number(*number_type("uint8"), 1, RosNumber::kSkipped, steps);
      return true;
    }
    for (const RosField& field : *fields) {
      if (++count_ > kMostSteps || layout_.columns.size() > kMostColumns) return false;
      if (!add_field(type, field, place, steps)) return false;
    }
    return true;
  }

  bool add_field(const std::string& type, const RosField& field, const Place& place, Steps& steps) {
    if (place.depth == 0 && add_stamp(type, field, steps)) return true;
    Place inner = place;
    inner.name += (place.name.empty() ? "" : ".") + field.name;
    ++inner.depth;
    if (const std::string_view unit = ros_unit(type, field.name); !unit.empty()) inner.unit = unit;
    if (field.type == "wstring") return false;
    if (field.type == "string") return add_text(field, place, steps);
    if (const Primitive* const number = number_type(field.type)) return add_numbers(*number, field, inner, steps);
    if (field.type == "std_msgs/Header") inner.kept = false;
    if (field.shape == RosField::Shape::kOne) return add_message(field.type, inner, steps);
    if (field.shape == RosField::Shape::kArray && field.count <= kMostParts && inner.kept) {
      for (std::size_t i = 0; i < field.count; ++i) {
        Place part = inner;
        part.name += fmt::format("[{}]", i);
        if (!add_message(field.type, part, steps)) return false;
      }
      return true;
    }
    RosStep group{.kind = RosStep::Kind::kGroup};
    group.count = field.shape == RosField::Shape::kArray
                      ? static_cast<std::uint32_t>(std::min<std::size_t>(field.count, 0xffff'ffffU))
                      : 0;
    inner.kept = false;
    if (!add_message(field.type, inner, group.steps)) return false;
    // Nothing is there of messages without fields in ROS 1, however many there are.
    if (!takes_bytes(group.steps)) group.steps.clear();
    steps.push_back(std::move(group));
    return true;
  }

  static bool takes_bytes(const Steps& steps) {
    return std::ranges::any_of(steps, [](const RosStep& step) {
      return step.kind != RosStep::Kind::kGroup || step.count == 0 || takes_bytes(step.steps);
    });
  }

  /// The stamp of a message is no channel.
  bool add_stamp(const std::string& type, const RosField& field, Steps& steps) {
    if (layout_.has_stamp || field.shape != RosField::Shape::kOne) return false;
    const bool header = field.name == "header" && field.type == "std_msgs/Header";
    if (header || (field.name == "stamp" && field.type == "builtin_interfaces/Time")) {
      // ROS 1 counts the headers.
      if (header && packed_) add_number(*number_type("uint32"), 1, RosNumber::kSkipped, steps);
      add_number(*number_type(packed_ ? "uint32" : "int32"), 1, RosNumber::kStampSeconds, steps);
      add_number(*number_type("uint32"), 1, RosNumber::kStampNanoseconds, steps);
      if (header) steps.push_back({.kind = RosStep::Kind::kText, .target = RosStep::kFrame});
      layout_.has_stamp = true;
      return true;
    }
    if (field.name == "timestamp" && field.type == "uint64" && type.starts_with("px4_msgs/")) {
      add_number(*number_type("uint64"), 1, RosNumber::kStampMicroseconds, steps);
      layout_.has_stamp = true;
      return true;
    }
    return false;
  }

  static bool add_text(const RosField& field, const Place& place, Steps& steps) {
    if (field.shape == RosField::Shape::kOne) {
      const bool child = place.depth == 0 && field.name == "child_frame_id";
      steps.push_back(
          {.kind = RosStep::Kind::kText, .target = child ? RosStep::kChildFrame : std::int32_t{RosNumber::kSkipped}});
      return true;
    }
    const bool names = place.depth == 0 && (field.name == "name" || field.name == "names" ||
                                            field.name == "joint_names" || field.name == "interface_names");
    steps.push_back({.kind = RosStep::Kind::kTexts,
                     .target = names ? 0 : std::int32_t{RosNumber::kSkipped},
                     .count = field.shape == RosField::Shape::kArray
                                  ? static_cast<std::uint32_t>(std::min<std::size_t>(field.count, 0xffff'ffffU))
                                  : 0});
    return true;
  }

  bool add_numbers(const Primitive& number, const RosField& field, const Place& place, Steps& steps) {
    const RosColumn column{place.name, place.unit.empty() ? "1" : place.unit, number.type};
    if (field.shape == RosField::Shape::kSequence) {
      RosStep step{.kind = RosStep::Kind::kSequence};
      step.numbers.push_back({.type = number.type, .size = number.size});
      if (place.kept) {
        step.target = static_cast<std::int32_t>(layout_.sequences.size());
        layout_.sequences.push_back(column);
      }
      steps.push_back(std::move(step));
      return true;
    }
    if (!place.kept || field.count > kLongestArray) {
      if (field.count > 0x0fff'ffffU) return false;
      add_number(number, static_cast<std::uint32_t>(field.count), RosNumber::kSkipped, steps);
      return true;
    }
    for (std::size_t i = 0; i < field.count; ++i) {
      add_number(number, 1, static_cast<std::int32_t>(layout_.columns.size()), steps);
      layout_.columns.push_back(column);
      if (field.shape == RosField::Shape::kArray) layout_.columns.back().name += fmt::format("[{}]", i);
    }
    return true;
  }

  static void add_number(const Primitive& number, std::uint32_t count, std::int32_t target, Steps& steps) {
    if (steps.empty() || steps.back().kind != RosStep::Kind::kNumbers) steps.emplace_back();
    steps.back().numbers.push_back({.type = number.type, .size = number.size, .count = count, .target = target});
  }

  /// Where the numbers of each step stand, whatever the place modulo 8 at which it begins.
  void lay_out(Steps& steps) const {
    for (RosStep& step : steps) {
      if (step.kind == RosStep::Kind::kGroup) lay_out(step.steps);
      if (step.kind != RosStep::Kind::kNumbers) continue;
      for (std::uint32_t start = 0; start < 8; ++start) {
        std::uint64_t at = start;
        for (RosNumber& number : step.numbers) {
          if (!packed_) at = (at + number.size - 1) / number.size * number.size;
          number.offset[start] = static_cast<std::uint32_t>(at - start);
          at += std::uint64_t{number.size} * number.count;
        }
        step.size[start] = static_cast<std::uint32_t>(std::min<std::uint64_t>(at - start, 0xffff'ffffU));
      }
    }
  }

  const RosDefinitions& definitions_;
  bool packed_;
  RosLayout layout_;
  std::size_t count_ = 0;
};

}  // namespace

std::optional<RosLayout> ros_layout(const RosDefinitions& definitions, RosEncoding encoding) {
  return LayoutBuilder(definitions, encoding).build();
}

}  // namespace veridyn::io::internal
