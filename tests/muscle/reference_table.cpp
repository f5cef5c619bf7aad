#include "tests/muscle/reference_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/folders.hpp"

namespace veridyn::muscle::test {

const std::string& ReferenceTable::text(std::size_t row, const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::out_of_range(name);
  return rows.at(row).at(static_cast<std::size_t>(found - names.begin()));
}

double ReferenceTable::number(std::size_t row, const std::string& name) const { return std::stod(text(row, name)); }

ReferenceTable read_reference(const std::string& path) {
  ReferenceTable table;
  std::ifstream file(fmt::format("{}/reference/{}", veridyn::test::shared_folder().string(), path));
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  if (std::getline(file, line)) table.names = split(line);
  while (std::getline(file, line)) table.rows.push_back(split(line));
  return table;
}

}  // namespace veridyn::muscle::test
