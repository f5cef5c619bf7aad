#include "veridyn/muscle/identification/measured_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::muscle {
namespace {

/// Column of an output; -1: none.
int column_of(const SignalTable& table, const Model& model, const MuscleOutput& output) {
  if (output.kind == MuscleOutputKind::kValue) return table.find(model.coordinates[output.index].name, "value");
  std::string name = output_name(model, output);
  if (output.kind == MuscleOutputKind::kMoment && output_unit(model, output) == "N" && table.find(name, "") < 0)
    name = model.coordinates[output.index].name + ".force";
  const std::size_t dot = name.rfind('.');
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    for (const char separator : {'.', '_', '/'}) {
      std::string wanted = name;
      wanted[dot] = separator;
      if (table.names[i] == wanted || table.names[i].ends_with("/" + wanted)) return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace

void check_times(const SignalTable& table) {
  const std::vector<double>& t = table.time;
  if (t.size() < 2) throw InputError(table.source, "has fewer than two samples");
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  const double usual = numerics::median(steps);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > 5.0 * usual && steps[i] > 0.05)
      throw InputError(table.source, fmt::format("has a gap from {:g} to {:g} s; its samples are {:.3g} s apart "
                                                 "otherwise",
                                                 t[i], t[i + 1], usual));
  }
}

void refuse_degrees(const SignalTable& table, const Model& model) {
  if (table.rotations_in_degrees) return;
  for (const Coordinate& c : model.coordinates) {
    const int column = table.find(c.name, "value");
    if (column < 0 || c.motion != CoordinateMotion::kRotational) continue;
    const std::vector<double>& v = table.values[column];
    const double width = c.high - c.low, margin = 0.1 * width;
    double largest = 0.0;
    bool beyond = false, in_degrees = true;
    for (const double x : v) {
      if (!std::isfinite(x)) continue;
      beyond = beyond || x > c.high + width || x < c.low - width;
      in_degrees = in_degrees && kDegree * x > c.low - margin && kDegree * x < c.high + margin;
      if (std::abs(x) > std::abs(largest)) largest = x;
    }
    if (beyond && in_degrees)
      throw InputError(table.source,
                       fmt::format("'{}' goes to {:.4g} where the model's range is {:.4g} .. {:.4g} rad: these are "
                                   "degrees taken for radians, a factor of 57; write inDegrees=yes in its header, or "
                                   "radians",
                                   table.names[column], largest, c.low, c.high));
  }
}

MeasuredMotion read_measured_motion(const SignalTable& table, const Model& model,
                                    std::span<const MuscleOutput> outputs) {
  check_times(table);
  refuse_degrees(table, model);
  MeasuredMotion motion;
  motion.source = table.source;
  motion.time = table.time;
  motion.values = estimation::RowMatrix::Constant(table.time.size(), outputs.size(), kNaN);
  bool any = false, moves = false;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const int column = column_of(table, model, outputs[j]);
    if (column < 0) continue;
    any = true;
    const MuscleOutput& output = outputs[j];
    const bool of_coordinate = output.kind == MuscleOutputKind::kValue || output.kind == MuscleOutputKind::kSpeed;
    const bool rotation = of_coordinate && model.coordinates[output.index].motion == CoordinateMotion::kRotational;
    const double unit = rotation && table.rotations_in_degrees ? kDegree : 1.0;
    double low = kInfinity, high = -kInfinity;
    for (std::size_t k = 0; k < table.time.size(); ++k) {
      const double value = unit * table.values[column][k];
      if (!std::isfinite(value))
        throw InputError(table.source,
                         fmt::format("column '{}' has no value at {:g} s", table.names[column], table.time[k]));
      motion.values(k, j) = value;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    moves = moves || high - low > 1e-9;
  }
  if (!any) {
    std::string wanted;
    for (const MuscleOutput& output : outputs) wanted += (wanted.empty() ? "" : ", ") + output_name(model, output);
    throw InputError(table.source,
                     fmt::format("has no column of an output ({}); it has {}", wanted, fmt::join(table.names, ", ")));
  }
  if (!moves) throw InputError(table.source, "does not move: there is nothing to compare a simulation with");
  return motion;
}

}  // namespace veridyn::muscle
