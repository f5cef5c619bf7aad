#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/matlab/mat_value.hpp"

namespace veridyn::io {

/// The objects of a level 5 file: what the cells of the `FileWrapper__` in its subsystem hold.
///
/// MathWorks does not describe it; this follows what others found (the projects matio by foreverallama,
/// MatFileHandler): the first cell holds names, classes, objects and which property of an object lies in which cell;
/// the properties begin at the third. Every number is checked against the others: classes by their names, columns by
/// the numbers of rows and of variables. What does not agree gives nothing.
class MatObjects {
 public:
  /// Nothing where the wrapper is of another version than 4 or less, or does not hold together.
  [[nodiscard]] static std::optional<MatObjects> read(std::vector<MatValue> cells, bool swap);

  /// A table or timetable as a struct of its columns of numbers, durations as seconds. Times of rows are the first
  /// field, `Time` in seconds (`MatValue::row_times`); of dates since midnight of the first, whose day is a text
  /// `date`. Columns have the table's units (`VariableUnits`), durations "s". Columns of other kinds are in `left_out`.
  /// Nothing of objects of other classes, and where anything is not as expected.
  [[nodiscard]] std::optional<MatValue> table(const MatValue& object, std::vector<std::string>& left_out) const;

 private:
  using Properties = std::map<std::string, const MatValue*, std::less<>>;
  struct Reference {
    std::uint32_t object = 0, of_class = 0;
  };

  [[nodiscard]] static std::optional<Reference> reference(const MatValue& value);
  [[nodiscard]] std::string class_name(std::uint32_t id) const;
  /// Of an object of this class.
  [[nodiscard]] std::optional<Properties> properties(const Reference& object, std::string_view of_class) const;
  [[nodiscard]] std::optional<Properties> block(std::size_t region, std::uint32_t id) const;
  /// The words of one of the regions 0 to 4 of the first cell.
  [[nodiscard]] const std::vector<std::uint32_t>& words(std::size_t region) const { return regions_[region]; }
  [[nodiscard]] std::optional<MatValue> made_of(const std::string& name, const MatValue& data, const MatValue& names,
                                                const MatValue* units, double rows, double variables,
                                                const MatValue* row_times, std::vector<std::string>& left_out) const;
  /// [s]
  [[nodiscard]] std::optional<std::vector<double>> duration(const MatValue& value) const;
  /// [s since 1970]
  [[nodiscard]] std::optional<std::vector<double>> date(const MatValue& value) const;
  [[nodiscard]] std::optional<std::vector<double>> times(const MatValue& value, std::size_t rows, bool& dates) const;

  std::vector<std::string> names_;
  std::vector<std::vector<std::uint32_t>> regions_;
  std::vector<MatValue> cells_;
};

}  // namespace veridyn::io
