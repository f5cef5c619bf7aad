#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace veridyn::app {

/// A small ordered JSON value, for the summary of `--json` and the run record: null, flag, whole number, number (one
/// that is not finite becomes null), text, array, or object with its members in the order in which they were added.
class Summary {
 public:
  using Member = std::pair<std::string, Summary>;

  Summary() = default;
  template <std::same_as<bool> Flag>
  Summary(Flag value) : value_(value) {}    // NOLINT(google-explicit-constructor)
  Summary(double value) : value_(value) {}  // NOLINT(google-explicit-constructor)
  template <std::signed_integral Whole>
  Summary(Whole value) : value_(static_cast<std::int64_t>(value)) {}  // NOLINT(google-explicit-constructor)
  template <std::unsigned_integral Whole>
  requires(!std::same_as<Whole, bool>) Summary(Whole value)
      : value_(static_cast<std::uint64_t>(value)) {}               // NOLINT(google-explicit-constructor)
  Summary(const char* value) : value_(std::string(value)) {}       // NOLINT(google-explicit-constructor)
  Summary(std::string value) : value_(std::move(value)) {}         // NOLINT(google-explicit-constructor)
  Summary(std::string_view value) : value_(std::string(value)) {}  // NOLINT(google-explicit-constructor)
  Summary(const std::vector<std::string>& texts);                  // NOLINT(google-explicit-constructor)

  [[nodiscard]] static Summary array(std::vector<Summary> elements = {});
  [[nodiscard]] static Summary object(std::vector<Member> members = {});
  /// A value that is JSON already.
  [[nodiscard]] static Summary json(std::string text);

  /// The member of this name, added where there is none; a null becomes an object.
  Summary& operator[](std::string_view name);
  /// Adds an element; a null becomes an array.
  void push_back(Summary element);

  /// JSON, indented by two spaces.
  [[nodiscard]] std::string to_json() const;

 private:
  struct Json {
    std::string text;
  };
  using Array = std::vector<Summary>;
  using Object = std::vector<Member>;
  friend struct SummaryWriter;
  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Json, Array, Object> value_;
};

}  // namespace veridyn::app
