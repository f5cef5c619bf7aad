#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace veridyn::io {

/// Texts of a log column, one after the other in one piece of memory.
class TextColumn {
 public:
  void push_back(std::string_view text) {
    characters_.append(text);
    ends_.push_back(characters_.size());
  }
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] std::string_view operator[](std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    return std::string_view(characters_).substr(begin, ends_[i] - begin);
  }
  void resize(std::size_t count) {
    if (count < ends_.size()) ends_.resize(count);
  }
  /// The texts of rows [begin, end).
  [[nodiscard]] TextColumn part(std::size_t begin, std::size_t end) const {
    TextColumn texts;
    for (std::size_t i = begin; i < end; ++i) texts.push_back((*this)[i]);
    return texts;
  }

 private:
  std::string characters_;
  std::vector<std::size_t> ends_;
};

/// One column of a log in the type in which the log holds it: a two-byte counter takes two bytes a sample.
class Column {
 public:
  using Storage =
      std::variant<std::vector<double>, std::vector<float>, std::vector<std::int8_t>, std::vector<std::uint8_t>,
                   std::vector<std::int16_t>, std::vector<std::uint16_t>, std::vector<std::int32_t>,
                   std::vector<std::uint32_t>, std::vector<std::int64_t>, std::vector<std::uint64_t>, TextColumn>;

  Column() = default;
  template <typename Values>
  explicit Column(Values values) : storage_(std::move(values)) {}

  [[nodiscard]] bool is_text() const { return std::holds_alternative<TextColumn>(storage_); }
  [[nodiscard]] std::size_t size() const;
  /// The number as logged, without any scale; NaN for a text.
  [[nodiscard]] double number(std::size_t i) const;
  /// The text; empty for a number.
  [[nodiscard]] std::string_view text(std::size_t i) const {
    const auto* texts = std::get_if<TextColumn>(&storage_);
    return texts != nullptr ? (*texts)[i] : std::string_view();
  }
  /// scale * number + offset for every row. Empty for a text column.
  [[nodiscard]] std::vector<double> numbers(double scale = 1.0, double offset = 0.0) const;
  /// The numbers of these rows.
  [[nodiscard]] Column picked(const std::vector<std::uint64_t>& rows) const;
  /// Keeps rows [begin, end).
  void keep(std::size_t begin, std::size_t end);
  /// Keeps the first `count` rows.
  void shorten(std::size_t count);
  [[nodiscard]] const Storage& storage() const { return storage_; }
  [[nodiscard]] Storage& storage() { return storage_; }

 private:
  Storage storage_;
};

}  // namespace veridyn::io
