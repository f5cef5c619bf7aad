#include "veridyn/muscle/model/external_load.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::muscle {
namespace {

using Columns = std::array<std::vector<double>, 3>;

std::vector<double> constant_column(double value, std::size_t rows) { return std::vector<double>(rows, value); }

Columns constant_columns(const Eigen::Vector3d& value, std::size_t rows) {
  return {constant_column(value.x(), rows), constant_column(value.y(), rows), constant_column(value.z(), rows)};
}

/// The column named `name`, with or without a path before it; -1: none.
int column_of(const SignalTable& table, std::string_view name) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string_view column = table.names[i];
    if (column == name || (column.ends_with(name) && column[column.size() - name.size() - 1] == '/'))
      return static_cast<int>(i);
  }
  return -1;
}

/// x, y, z: named so after `identifier`, or the only three columns that begin with it, in their order.
std::array<std::size_t, 3> find_columns(const ExternalLoadSource& source, const char* what,
                                        const std::string& identifier, const SignalTable& table) {
  for (const std::string_view letters : {"xyz", "XYZ", "123"}) {
    for (const char* between : {"", "_", "."}) {
      std::array<int, 3> found{};
      for (std::size_t i = 0; i < 3; ++i)
        found[i] = column_of(table, fmt::format("{}{}{}", identifier, between, letters[i]));
      if (found[0] >= 0 && found[1] >= 0 && found[2] >= 0) return {at(found[0]), at(found[1]), at(found[2])};
    }
  }
  std::vector<std::size_t> begin;
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (table.names[i].starts_with(identifier)) begin.push_back(i);
  if (begin.size() == 3) return {begin[0], begin[1], begin[2]};
  if (begin.empty())
    throw InputError(source.place, fmt::format("{} '{}': {} has no columns that begin so{}", what, identifier,
                                               table.source, suggestion(identifier + "x", table.names, 12)));
  throw InputError(source.place,
                   fmt::format("{} '{}': {} columns of {} begin so, three are needed, as {}x, {}y, {}z", what,
                               identifier, begin.size(), table.source, identifier, identifier, identifier));
}

Columns read_columns(const ExternalLoadSource& source, const char* what, const std::string& identifier,
                     const SignalTable& table) {
  const std::array<std::size_t, 3> found = find_columns(source, what, identifier, table);
  Columns columns;
  for (std::size_t i = 0; i < 3; ++i) {
    check_finite(table, found[i]);
    columns[i] = table.values[found[i]];
  }
  return columns;
}

int body_of(const ExternalLoadSource& source, const char* what, std::string_view name, const Model& model) {
  const std::size_t slash = name.rfind('/');
  const std::string last(slash == std::string_view::npos ? name : name.substr(slash + 1));
  const int body = model.body(last);
  if (body >= 0) return body;
  std::vector<std::string> names;
  for (const Body& b : model.bodies) names.push_back(b.name);
  throw InputError(source.place,
                   fmt::format("{} '{}' is no body of model '{}'{}", what, name, model.name, suggestion(last, names)));
}

ExternalLoad make_load(const ExternalLoadSource& source, const SignalTable* table, const Model& model,
                       const std::optional<numerics::FirKernel>& kernel) {
  ExternalLoad load;
  load.name = source.name;
  load.body = body_of(source, "body", source.body, model);
  if (load.body == 0) throw InputError(source.place, "acts on the ground, which nothing moves");
  load.force_frame = body_of(source, "force frame", source.force_frame, model);
  load.point_frame = body_of(source, "point frame", source.point_frame, model);
  const bool columns = !source.force.empty() || !source.point.empty() || !source.moment.empty();
  if (columns && table == nullptr) throw InputError(source.place, "names columns, but there is no file of them");
  const std::size_t rows = columns ? table->time.size() : 1;
  const auto read = [&](const char* what, const std::string& identifier, const Eigen::Vector3d& constant) {
    return identifier.empty() ? constant_columns(constant, rows) : read_columns(source, what, identifier, *table);
  };
  Columns force = read("force", source.force, source.constant_force);
  Columns moment = read("torque", source.moment, source.constant_moment);
  Columns point = read("point", source.point, source.constant_point);
  // Without a point the force acts at the body's origin, wherever that is.
  if (source.point.empty() && !source.has_constant_point) load.point_frame = load.body;
  if (load.point_frame == load.force_frame) {
    for (std::size_t i = 0; i < rows; ++i) {
      const Eigen::Vector3d p(point[0][i], point[1][i], point[2][i]), f(force[0][i], force[1][i], force[2][i]);
      const Eigen::Vector3d turned = p.cross(f);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        moment[axis][i] += turned(axis);
        point[axis][i] = 0.0;
      }
    }
  }
  const auto join = [&](Columns& from, std::array<numerics::PiecewisePolynomial, 3>& to) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double>& values = from[axis];
      if (std::ranges::count(values, values.front()) == std::ssize(values)) {
        to[axis] = numerics::PiecewisePolynomial::constant(values.front());
      } else {
        if (kernel) values = numerics::filter(values, *kernel);
        to[axis] = numerics::PiecewisePolynomial::natural_spline(table->time, values);
      }
    }
  };
  join(force, load.force);
  join(moment, load.moment);
  join(point, load.point);
  return load;
}

}  // namespace

void add_external_loads(std::span<const ExternalLoadSource> sources, const SignalTable* table, const Model& model,
                        double low_pass_Hz, ExternalLoads& loads) {
  std::optional<numerics::FirKernel> kernel;
  if (table != nullptr && low_pass_Hz > 0.0) kernel = low_pass_of(*table, low_pass_Hz);
  for (const ExternalLoadSource& source : sources) loads.loads.push_back(make_load(source, table, model, kernel));
  if (table != nullptr) {
    loads.begin = std::max(loads.begin, table->time.front());
    loads.end = std::min(loads.end, table->time.back());
  }
}

}  // namespace veridyn::muscle
