#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Cells and structs within each other that a MAT file may have before it is taken for damaged.
inline constexpr int kDeepestMatNesting = 16;

/// Bytes that a variable may take, in its file after decompression and in memory as doubles: a small file that expands
/// to gigabytes is refused before it does.
inline constexpr std::size_t kLargestMatVariable = std::size_t{384} << 20U;

/// Bytes that all variables of a file may take together, likewise.
inline constexpr std::size_t kLargestMatFile = std::size_t{512} << 20U;

/// Refuses a variable of so many bytes where that is more. @throws InputError
void require_mat_size(double bytes, std::string_view name, const std::string& source);

/// What the variables of a file take in memory, counted before it is taken.
class MatBudget {
 public:
  explicit MatBudget(std::string source) : source_(std::move(source)) {}
  /// Refuses bytes that are needed for a while where there is no room for them. @throws InputError
  void require_room(double bytes, std::string_view variable) const;
  /// Counts bytes that stay. @throws InputError where there is no room, or `variable` is larger than one may be
  void take(double bytes, std::string_view variable);

 private:
  std::string source_;
  double taken_ = 0.0;
};

/// A variable of a MAT file, or a part of one.
struct MatValue {
  enum class Kind { kNumbers, kText, kCell, kStruct, kOther };
  std::string name;        ///< of the variable or struct field; empty in cells
  std::string class_name;  ///< of an object: "timetable", "table"; its `numbers` are a reference (`MatObjects`)
  std::string unit;        ///< of a column of a table, as the table has it; empty: none
  bool row_times = false;  ///< the stamps of a timetable [s]
  Kind kind = Kind::kOther;
  std::vector<std::size_t> extents;  ///< column-major
  std::vector<double> numbers;
  std::string text;
  std::vector<MatValue> items;  ///< cells, or fields (of all elements, one element after the other)

  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] const MatValue* find(std::string_view field) const;
};

/// Takes the variables of a level 5 file (MATLAB 5 to 7.2, `-v6`, `-v7`) one after the other.
///
/// Format: MathWorks, "MAT-File Format", chapter 1. Every length is checked against what is left of the file before it
/// is trusted. A variable that does not hold together is counted in the damage and left out.
/// @throws InputError where a variable is larger than `kLargestMatVariable`, or all together than `kLargestMatFile`
void read_mat5(std::string_view bytes, const std::string& source, const std::function<void(MatValue&&)>& take,
               LogDamage& damage);

/// As `read_mat5`, for files of MATLAB 7.3, which are HDF5, through the libraries matio and HDF5: what they do with a
/// file that was damaged on purpose is up to them.
/// @throws InputError when matio cannot open the file, and as `read_mat5`
void read_mat73(const std::string& path, const std::function<void(MatValue&&)>& take, LogDamage& damage);

}  // namespace veridyn::io
