#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "veridyn/io/log/column.hpp"
#include "veridyn/io/log/log.hpp"
#include "veridyn/io/ros/message_cursor.hpp"
#include "veridyn/io/ros/message_layout.hpp"

namespace veridyn::io::internal {

/// Numbers of one type as they come; one that never changes takes no memory.
class NumberColumn {
 public:
  explicit NumberColumn(GatherType type);

  template <typename Number>
  void push(Number value) {
    auto& values = *std::get_if<std::vector<Number>>(&values_);
    if (size_ == 0) values.assign(1, value);
    if (!varies_ && !same(Number(values.front()), value)) {
      values.resize(size_, Number(values.front()));
      varies_ = true;
    }
    if (varies_) values.push_back(value);
    ++size_;
  }
  void shorten(std::size_t size);
  [[nodiscard]] bool varies() const { return varies_; }
  /// The one that never changes. At least one is there.
  [[nodiscard]] double first() const;
  /// All of them.
  [[nodiscard]] Column take();

 private:
  /// To the last bit, also of numbers that are none.
  template <typename Number>
  static bool same(Number a, Number b) {
    if constexpr (std::is_same_v<Number, double>) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    } else if constexpr (std::is_same_v<Number, float>) {
      return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
    } else {
      return a == b;
    }
  }

  Column::Storage values_;
  std::size_t size_ = 0;
  bool varies_ = false;
};

/// Moment [ns since 1970, or since any other beginning].
using Nanoseconds = std::int64_t;

/// The messages of one topic as rows of a table.
class MessageTable {
 public:
  MessageTable(RosLayout layout, RosEncoding encoding);

  /// Decodes one more message, recorded at `logged` as the `place`-th of its log. False, and nothing is added, where
  /// its size is not that of its definition (up to three bytes at its end may fill it up), or its encapsulation is
  /// neither CDR_BE nor CDR_LE.
  bool add(std::string_view payload, Nanoseconds logged, std::uint64_t place);

  /// The columns so far, as fields; empties the table. Covariances that never change make none, but a line in
  /// `constants`. @throws nothing
  [[nodiscard]] std::vector<LogField> take_fields(std::map<std::string, std::string>& constants);

  [[nodiscard]] std::size_t rows() const { return logged_.size(); }
  [[nodiscard]] const RosLayout& layout() const { return layout_; }
  /// Stamps of the messages themselves; `kNoStamp` of those without, or with zero.
  [[nodiscard]] const std::vector<Nanoseconds>& stamps() const { return stamps_; }
  [[nodiscard]] const std::vector<Nanoseconds>& logged() const { return logged_; }
  [[nodiscard]] const std::vector<std::uint64_t>& places() const { return places_; }
  /// `header.frame_id` and `child_frame_id`, the first that is not empty.
  [[nodiscard]] const std::string& frame() const { return texts_[RosStep::kFrame]; }
  [[nodiscard]] const std::string& child_frame() const { return texts_[RosStep::kChildFrame]; }
  /// Whether messages name several frames: no one frame holds for all.
  [[nodiscard]] bool several_frames() const { return several_frames_; }

  static constexpr Nanoseconds kNoStamp = INT64_MIN;

 private:
  /// The elements of a sequence of numbers, by index, or by the names that the message has for them.
  struct Sequence {
    std::map<std::string, std::size_t, std::less<>> places;
    std::vector<std::vector<double>> columns;
    bool too_long = false;
  };

  void run(const std::vector<RosStep>& steps, MessageCursor& cursor);
  void take_numbers(const RosStep& step, MessageCursor& cursor);
  void take_number(const RosNumber& number, const char* from, const MessageCursor& cursor);
  void take_text(const RosStep& step, MessageCursor& cursor);
  void take_names(const RosStep& step, MessageCursor& cursor);
  void take_sequence(const RosStep& step, MessageCursor& cursor);
  std::vector<double>* element(Sequence& sequence, std::size_t index, bool named);

  RosLayout layout_;
  RosEncoding encoding_;
  std::vector<NumberColumn> columns_;
  std::vector<Sequence> sequences_;
  std::vector<Nanoseconds> stamps_, logged_;
  std::vector<std::uint64_t> places_;
  std::string texts_[2];
  bool several_frames_ = false;
  // Of the message that is being read.
  std::int64_t seconds_ = 0, nanoseconds_ = 0;
  std::vector<std::string_view> names_;
};

}  // namespace veridyn::io::internal
