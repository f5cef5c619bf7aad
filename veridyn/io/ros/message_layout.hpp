#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/io/log/gather.hpp"
#include "veridyn/io/ros/message_definition.hpp"

namespace veridyn::io::internal {

/// How the bytes of messages are laid out.
enum class RosEncoding {
  kCdr,   ///< ROS 2: numbers stand at multiples of their size
  kRos1,  ///< little endian, without gaps
};

/// A number of every message, or a sequence of numbers.
struct RosColumn {
  std::string name;  ///< "linear_acceleration.x"; empty where the message is the quantity itself
  std::string unit = "1";
  GatherType type = GatherType::kDouble;
};

/// A number that stands at a place known from the start of its step.
struct RosNumber {
  enum Target : std::int32_t {
    kSkipped = -1,
    kStampSeconds = -2,
    kStampNanoseconds = -3,
    kStampMicroseconds = -4,
  };
  GatherType type = GatherType::kUint8;
  std::uint32_t size = 1;                 ///< bytes of one
  std::uint32_t count = 1;                ///< more than one only of those that are skipped
  std::int32_t target = kSkipped;         ///< column, or what it is else
  std::array<std::uint32_t, 8> offset{};  ///< from the step's start, by the start's place modulo 8
};

/// What is read in one go.
struct RosStep {
  enum class Kind {
    kNumbers,   ///< a fixed number of them, one after the other
    kText,      ///< `target`: which of the texts, or skipped
    kTexts,     ///< an array (`count`) or sequence (0) of texts; `target` 0: names of the sequences that follow
    kSequence,  ///< of numbers; `target`: which of the sequences
    kGroup,     ///< an array (`count`) or sequence (0) of messages, which are skipped
  };
  static constexpr std::int32_t kFrame = 0, kChildFrame = 1;

  Kind kind = Kind::kNumbers;
  std::int32_t target = RosNumber::kSkipped;
  std::uint32_t count = 0;
  std::vector<RosNumber> numbers{};     ///< of kNumbers; of kSequence the element
  std::array<std::uint32_t, 8> size{};  ///< of kNumbers in all, by its start's place modulo 8
  std::vector<RosStep> steps{};         ///< of kGroup
};

/// How a message becomes one row of a table.
struct RosLayout {
  std::vector<RosColumn> columns;
  std::vector<RosColumn> sequences;  ///< of numbers; their elements become columns as they come
  std::vector<RosStep> steps;
  bool has_stamp = false;  ///< in `header.stamp`, `stamp`, or of PX4's messages `timestamp`
};

/// Resolves a definition. Arrays of at most 64 numbers become a column for each, arrays of at most 16 messages are
/// taken apart. Nothing where a type is not defined, nor a standard one (`find_standard_message`), where messages hold
/// themselves, or texts of wide characters.
[[nodiscard]] std::optional<RosLayout> ros_layout(const RosDefinitions& definitions, RosEncoding encoding);

}  // namespace veridyn::io::internal
