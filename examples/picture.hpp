#pragma once

#include <fstream>
#include <string>
#include <vector>

// The numbers of an example's picture: it leaves them as NN_name.csv in the folder where it runs, and `make pictures`
// draws them (tools/example_pictures.mjs). Nothing of this is needed to use the library.
namespace picture {

/// A column: "alpha[deg]" and its values.
struct Column {
  std::string name;
  std::vector<double> values;
};

/// Writes columns of equal length; `labels`, where there are any, name the rows.
inline void write(const std::string& file, const std::vector<Column>& columns,
                  const std::vector<std::string>& labels = {}) {
  std::ofstream out(file);
  if (!labels.empty()) out << "label,";
  for (std::size_t i = 0; i < columns.size(); ++i) out << (i > 0 ? "," : "") << columns[i].name;
  out << '\n';
  for (std::size_t k = 0; k < columns.at(0).values.size(); ++k) {
    if (!labels.empty()) out << labels.at(k) << ',';
    for (std::size_t i = 0; i < columns.size(); ++i) out << (i > 0 ? "," : "") << columns[i].values.at(k);
    out << '\n';
  }
}

}  // namespace picture
