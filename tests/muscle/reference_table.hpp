#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace veridyn::muscle::test {

/// A comma-separated table with names in its first row and cells of text.
struct ReferenceTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  [[nodiscard]] const std::string& text(std::size_t row, const std::string& name) const;
  [[nodiscard]] double number(std::size_t row, const std::string& name) const;
};

/// Results of other programs: a table in the folder `reference` of others' data. Without rows when it is not there.
[[nodiscard]] ReferenceTable read_reference(const std::string& path);

}  // namespace veridyn::muscle::test
