#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace veridyn::testing {

/// What a reader does with a damaged log, which `tests/io/damage_test.cpp` tries.
enum class DamageLaw {
  kCounts,    ///< reads what is left and counts what it loses
  kRefuses,   ///< may refuse all of it
  kOwnTests,  ///< not tried there: its container is whole or refused, or cuts cannot be told from the end
};

/// A valid log of a format.
struct SmallLog {
  std::string_view key;  ///< of its row in `io::log_formats`
  std::string bytes;
  DamageLaw damage = DamageLaw::kOwnTests;
  std::string_view name = "small";  ///< alone among those of its format
};

/// Small logs of each format of `io::log_formats`, at least one each, those named "small" first: tests of all formats
/// read them, and fuzzing starts from them. A new format adds its own here.
[[nodiscard]] std::vector<SmallLog> small_logs();

/// An array of NumPy: two rows of one column, 1.5 and -2, of 4 bytes each.
[[nodiscard]] std::string small_npy();

}  // namespace veridyn::testing
