#include "veridyn/io/ros/message_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/io/ros/ros_log.hpp"

namespace veridyn::io::internal {
namespace {

/// Columns that a sequence of numbers may make, and the longest of their names.
constexpr std::size_t kMostElements = 64, kLongestName = 80;
constexpr std::size_t kLargestMessage = 1U << 30U;
/// CDR_BE and CDR_LE of the encapsulation header.
constexpr char kBigEndian = 0, kLittleEndian = 1;

/// Calls with a number of the type.
template <typename Call>
void with_type(GatherType type, Call&& call) {
  switch (type) {
    case GatherType::kInt8:
      return call(std::int8_t{});
    case GatherType::kUint8:
      return call(std::uint8_t{});
    case GatherType::kInt16:
      return call(std::int16_t{});
    case GatherType::kUint16:
      return call(std::uint16_t{});
    case GatherType::kInt32:
      return call(std::int32_t{});
    case GatherType::kUint32:
      return call(std::uint32_t{});
    case GatherType::kInt64:
      return call(std::int64_t{});
    case GatherType::kUint64:
      return call(std::uint64_t{});
    case GatherType::kFloat:
      return call(float{});
    case GatherType::kHalf:
    case GatherType::kDouble:
    case GatherType::kText:
      return call(double{});
  }
}

bool is_covariance(std::string_view name) { return name.find("covariance[") != std::string_view::npos; }

}  // namespace

NumberColumn::NumberColumn(GatherType type) {
  with_type(type, [this](auto number) { values_ = std::vector<decltype(number)>(); });
}

void NumberColumn::shorten(std::size_t size) {
  if (size_ <= size) return;
  size_ = size;
  if (varies_) std::visit([size](auto& values) { values.resize(size); }, values_);
  if (size == 0) varies_ = false;
}

double NumberColumn::first() const { return Column(values_).number(0); }

Column NumberColumn::take() {
  if (!varies_ && size_ > 0)
    std::visit(
        [this](auto& values) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(values)>, TextColumn>) {
            const auto value = values.front();
            values.assign(size_, value);
          }
        },
        values_);
  return std::visit([](auto&& values) { return Column(std::forward<decltype(values)>(values)); }, std::move(values_));
}

MessageTable::MessageTable(RosLayout layout, RosEncoding encoding) : layout_(std::move(layout)), encoding_(encoding) {
  for (const RosColumn& column : layout_.columns) columns_.emplace_back(column.type);
  sequences_.resize(layout_.sequences.size());
}

bool MessageTable::add(std::string_view payload, Nanoseconds logged, std::uint64_t place) {
  bool swapped = false;
  if (payload.size() > kLargestMessage) return false;
  if (encoding_ == RosEncoding::kCdr) {
    if (payload.size() < 4 || payload[0] != 0 || (payload[1] != kBigEndian && payload[1] != kLittleEndian))
      return false;
    swapped = payload[1] == kBigEndian;
    payload.remove_prefix(4);
  }
  MessageCursor cursor(payload, encoding_, swapped);
  seconds_ = nanoseconds_ = 0;
  names_.clear();
  run(layout_.steps, cursor);
  const std::size_t filling = encoding_ == RosEncoding::kCdr ? 3 : 0;
  if (cursor.failed() || cursor.left() > filling) {
    for (NumberColumn& column : columns_) column.shorten(rows());
    for (Sequence& sequence : sequences_)
      for (std::vector<double>& column : sequence.columns) column.resize(std::min(column.size(), rows()));
    return false;
  }
  logged_.push_back(logged);
  places_.push_back(place);
  // Seconds of 32 bits, or microseconds that were divided: no overflow.
  const Nanoseconds stamp = seconds_ * 1'000'000'000 + nanoseconds_;
  stamps_.push_back(stamp == 0 ? kNoStamp : stamp);
  return true;
}

void MessageTable::run(const std::vector<RosStep>& steps, MessageCursor& cursor) {
  for (const RosStep& step : steps) {
    if (cursor.failed()) return;
    switch (step.kind) {
      case RosStep::Kind::kNumbers:
        take_numbers(step, cursor);
        break;
      case RosStep::Kind::kText:
        take_text(step, cursor);
        break;
      case RosStep::Kind::kTexts:
        take_names(step, cursor);
        break;
      case RosStep::Kind::kSequence:
        take_sequence(step, cursor);
        break;
      case RosStep::Kind::kGroup: {
        const std::uint32_t count = step.count > 0 ? step.count : cursor.count();
        for (std::uint32_t i = 0; i < count && !step.steps.empty() && !cursor.failed(); ++i) run(step.steps, cursor);
        break;
      }
    }
  }
}

void MessageTable::take_numbers(const RosStep& step, MessageCursor& cursor) {
  const std::size_t start = cursor.at() % 8;
  const char* const from = cursor.skip(step.size[start]);
  if (from == nullptr) return;
  for (const RosNumber& number : step.numbers)
    if (number.target != RosNumber::kSkipped) take_number(number, from + number.offset[start], cursor);
}

void MessageTable::take_number(const RosNumber& number, const char* from, const MessageCursor& cursor) {
  if (number.target >= 0) {
    NumberColumn& column = columns_[static_cast<std::size_t>(number.target)];
    with_type(number.type, [&](auto value) { column.push(cursor.load<decltype(value)>(from)); });
    return;
  }
  switch (number.target) {
    case RosNumber::kStampSeconds:
      seconds_ = number.type == GatherType::kInt32 ? cursor.load<std::int32_t>(from) : cursor.load<std::uint32_t>(from);
      break;
    case RosNumber::kStampNanoseconds:
      nanoseconds_ = cursor.load<std::uint32_t>(from);
      break;
    case RosNumber::kStampMicroseconds: {
      // 2^53 us are 285 years.
      const std::uint64_t us = std::min<std::uint64_t>(cursor.load<std::uint64_t>(from), 1ULL << 53U);
      seconds_ = static_cast<std::int64_t>(us / 1'000'000);
      nanoseconds_ = static_cast<std::int64_t>(us % 1'000'000 * 1000);
      break;
    }
    default:
      break;
  }
}

void MessageTable::take_text(const RosStep& step, MessageCursor& cursor) {
  const std::string_view text = cursor.text();
  if (step.target < 0 || cursor.failed()) return;
  std::string& known = texts_[step.target];
  if (known == text || text.empty()) return;
  if (known.empty()) {
    known = text.substr(0, kLongestName);
  } else if (known != text.substr(0, kLongestName)) {
    several_frames_ = true;
  }
}

void MessageTable::take_names(const RosStep& step, MessageCursor& cursor) {
  const std::uint32_t count = step.count > 0 ? step.count : cursor.count();
  const bool names = step.target == 0;
  if (names) names_.clear();
  for (std::uint32_t i = 0; i < count && !cursor.failed(); ++i) {
    const std::string_view text = cursor.text();
    if (names && names_.size() <= kMostElements) names_.push_back(text.substr(0, kLongestName));
  }
}

void MessageTable::take_sequence(const RosStep& step, MessageCursor& cursor) {
  const RosNumber& number = step.numbers.front();
  const std::uint32_t count = cursor.count();
  const char* from = cursor.numbers(count, number.size);
  if (step.target < 0 || from == nullptr) return;
  Sequence& sequence = sequences_[static_cast<std::size_t>(step.target)];
  if (count > kMostElements) sequence.too_long = true;
  if (sequence.too_long) {
    sequence.columns.clear();
    return;
  }
  const bool named = names_.size() == count;
  for (std::uint32_t i = 0; i < count; ++i, from += number.size) {
    std::vector<double>* const column = element(sequence, i, named);
    if (column == nullptr) return;
    // A name that stands there twice: the first counts.
    if (column->size() > rows()) continue;
    column->resize(rows(), kNaN);
    with_type(number.type,
              [&](auto value) { column->push_back(static_cast<double>(cursor.load<decltype(value)>(from))); });
  }
}

/// The column of an element; null where there are too many of them.
std::vector<double>* MessageTable::element(Sequence& sequence, std::size_t index, bool named) {
  const std::string key = named && !names_[index].empty() ? std::string(names_[index]) : fmt::format("{}", index);
  const auto found = sequence.places.find(key);
  if (found != sequence.places.end()) return &sequence.columns[found->second];
  if (sequence.columns.size() >= kMostElements) {
    sequence.too_long = true;
    sequence.columns.clear();
    return nullptr;
  }
  sequence.places.emplace(key, sequence.columns.size());
  return &sequence.columns.emplace_back();
}

std::vector<LogField> MessageTable::take_fields(std::map<std::string, std::string>& constants) {
  std::vector<LogField> fields;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const RosColumn& from = layout_.columns[i];
    if (is_covariance(from.name) && !columns_[i].varies() && rows() > 0) {
      std::string& text = constants[from.name.substr(0, from.name.rfind('['))];
      text += fmt::format("{}{:.6g}", text.empty() ? "" : " ", columns_[i].first());
      continue;
    }
    fields.push_back({.name = from.name, .unit = from.unit, .values = columns_[i].take()});
  }
  for (std::size_t i = 0; i < sequences_.size(); ++i) {
    if (sequences_[i].too_long) continue;
    std::vector<std::string_view> keys(sequences_[i].columns.size());
    for (const auto& [key, place] : sequences_[i].places) keys[place] = key;
    for (std::size_t place = 0; place < keys.size(); ++place) {
      std::vector<double>& column = sequences_[i].columns[place];
      if (column.empty()) continue;
      column.resize(rows(), kNaN);
      const RosColumn& from = layout_.sequences[i];
      std::string name = fmt::format("{}[{}]", from.name == "data" ? "" : from.name, one_line(keys[place]));
      fields.push_back({.name = std::move(name), .unit = from.unit, .values = Column(std::move(column))});
    }
  }
  return fields;
}

}  // namespace veridyn::io::internal
