#include "veridyn/muscle/study/muscle_study_parts.hpp"

#include <fmt/format.h>

namespace veridyn::muscle::internal {

double read_accuracy(const StudyTable& table, double otherwise) {
  const double accuracy = table.positive_or("accuracy", "1", otherwise);
  if (!(accuracy >= 1e-13 && accuracy <= 0.1))
    table.fail("accuracy", fmt::format("{:g} must be from 1e-13 to 0.1", accuracy));
  return accuracy;
}

double read_reserve_force(const StudyTable& table, double otherwise) {
  const double force = table.number_or("reserve_force", "N m", otherwise);
  if (!(force >= 0.0)) table.fail("reserve_force", fmt::format("{:g} must be >= 0", force));
  return force;
}

std::vector<double> read_reserves(const StudyTable& motion, const Model& model) {
  std::vector<double> reserves(model.coordinates.size(), read_reserve_force(motion, 1.0));
  const StudyTable table = motion.table_or_empty("reserves");
  for (const std::string& key : table.keys()) {
    const std::size_t c = coordinate_of(table, key, key, model);
    reserves[c] = table.number(key, model.coordinates[c].unit() == "m" ? "N" : "N m");
    if (!(reserves[c] >= 0.0)) table.fail(key, fmt::format("{:g} must be >= 0", reserves[c]));
  }
  return reserves;
}

ControlOptions read_control_options(const StudyTable& table) {
  ControlOptions o;
  o.window = table.positive_or("window", "s", o.window);
  o.kp = table.number_or("kp", "1/s^2", o.kp);
  o.kv = table.number_or("kv", "1/s", o.kv);
  if (!(o.kp >= 0.0)) table.fail("kp", fmt::format("{:g} must be >= 0", o.kp));
  if (!(o.kv >= 0.0)) table.fail("kv", fmt::format("{:g} must be >= 0", o.kv));
  o.min_control = table.number_or("min_control", "1", o.min_control);
  o.max_control = table.number_or("max_control", "1", o.max_control);
  if (!(o.min_control >= 0.0 && o.min_control < 1.0))
    table.fail("min_control", fmt::format("{:g} must be from 0 to below 1", o.min_control));
  if (!(o.max_control > o.min_control && o.max_control <= 1.0)) {
    table.fail("max_control",
               fmt::format("{:g} must be above min_control = {:g} and at most 1", o.max_control, o.min_control));
  }
  return o;
}

}  // namespace veridyn::muscle::internal
