#pragma once

<<<<<<< HEAD
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace veridyn::muscle {

/// A CSV file of the reference results: cells as text, found by row and column name.
class ReferenceTable {
 public:
  static std::filesystem::path path(const std::string& name) {
    return std::filesystem::path(VERIDYN_SHARED_DIR) / "reference/opensim" / name;
  }
  static bool exists(const std::string& name) { return std::filesystem::exists(path(name)); }

  explicit ReferenceTable(const std::string& name) {
    std::ifstream file(path(name));
    std::string line;
    std::getline(file, line);
    const std::vector<std::string> header = split(line);
    for (std::size_t i = 0; i < header.size(); ++i) column_[header[i]] = i;
    while (std::getline(file, line))
      if (!line.empty()) rows_.push_back(split(line));
  }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] const std::string& text(std::size_t row, const std::string& column) const {
    const auto found = column_.find(column);
    if (found == column_.end()) throw std::runtime_error("no column " + column);
    return rows_.at(row).at(found->second);
  }
  [[nodiscard]] double number(std::size_t row, const std::string& column) const {
    return std::strtod(text(row, column).c_str(), nullptr);
  }
  [[nodiscard]] std::vector<double> numbers(const std::string& column) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < rows(); ++i) values.push_back(number(i, column));
    return values;
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  }
  std::map<std::string, std::size_t> column_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace veridyn::muscle

#define VERIDYN_SKIP_WITHOUT(name)                      \
  if (!::veridyn::muscle::ReferenceTable::exists(name)) \
  GTEST_SKIP() << "no " << ::veridyn::muscle::ReferenceTable::path(name)
=======
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
>>>>>>> wt-multibody
