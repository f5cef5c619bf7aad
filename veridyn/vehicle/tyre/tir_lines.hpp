#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace veridyn::vehicle::internal {

/// The lines `KEY = value` of a tyre file, by key (in capitals).
class TirLines {
 public:
  /// A line KEY = value.
  struct Entry {
    std::string value;
    bool quoted = false;
    std::size_t line = 0;
  };

  /// @throws InputError with file:line for anything that is no line of a tyre file, or a key that is there twice.
  TirLines(std::string_view text, std::string source);

  [[nodiscard]] const std::map<std::string, Entry, std::less<>>& entries() const { return entries_; }
  /// Null where the file does not have the key.
  [[nodiscard]] const Entry* find(std::string_view key) const;
  /// "file:line" of a key; the file where it does not have it.
  [[nodiscard]] std::string place(std::string_view key) const;
  /// Throws InputError at the key: "file:line: KEY what".
  [[noreturn]] void fail(std::string_view key, std::string_view what) const;

  /// A finite number; empty where the key is not there.
  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] double number_or(std::string_view key, double otherwise) const;
  [[nodiscard]] std::string text_or(std::string_view key, std::string_view otherwise) const;

 private:
  void read_line(std::string_view raw, std::size_t number);

  std::string source_;
  bool in_table_ = false;
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace veridyn::vehicle::internal
