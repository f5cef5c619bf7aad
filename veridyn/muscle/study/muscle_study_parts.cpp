#include "veridyn/muscle/study/muscle_study_parts.hpp"

#include <fmt/format.h>

namespace veridyn::muscle::internal {

std::vector<double> read_reserves(const StudyTable& motion, double otherwise, const Model& model) {
  std::vector<double> reserves(model.coordinates.size(), otherwise);
  const StudyTable table = motion.table_or_empty("reserves");
  for (const std::string& key : table.keys()) {
    const std::size_t c = coordinate_of(table, key, key, model);
    reserves[c] =
        veridyn::internal::number_in(table, key, model.coordinates[c].unit() == "m" ? "N" : "N m", kNotNegative);
  }
  return reserves;
}

}  // namespace veridyn::muscle::internal
