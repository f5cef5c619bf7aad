#include "veridyn/muscle/model/model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::muscle {
namespace {

template <typename List, typename Name>
int index_of(const List& list, std::string_view wanted, const Name& name) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (name(list[i]) == wanted) return static_cast<int>(i);
  }
  return -1;
}

Eigen::Matrix3d point_mass_inertia(double mass, const Eigen::Vector3d& r) {
  return mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

}  // namespace

Eigen::Matrix3d body_fixed_xyz(const Eigen::Vector3d& angles) {
  return (Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

bool Coordinate::in_range(double value) const {
  const double slack = 1e-6 * (1.0 + high - low);
  return value >= low - slack && value <= high + slack;
}

std::string Coordinate::outside_range(double value) const {
  return fmt::format("coordinate '{}' = {:.6g} {} is outside its range {:.6g} .. {:.6g}", name, value, unit(), low,
                     high);
}

int Model::body(std::string_view wanted) const {
  return index_of(bodies, wanted, [](const Body& b) -> const std::string& { return b.name; });
}

int Model::coordinate(std::string_view wanted) const {
  return index_of(coordinates, wanted, [](const Coordinate& c) -> const std::string& { return c.name; });
}

int Model::muscle(std::string_view wanted) const {
  return index_of(muscles, wanted, [](const Muscle& m) -> const std::string& { return m.name(); });
}

std::vector<std::string> Model::coordinate_names() const {
  std::vector<std::string> names;
  for (const Coordinate& c : coordinates) names.push_back(c.name);
  return names;
}

std::vector<std::string> Model::muscle_names() const {
  std::vector<std::string> names;
  for (const Muscle& m : muscles) names.push_back(m.name());
  return names;
}

std::string Model::no_coordinate(std::string_view wanted) const {
  return fmt::format("model '{}' has no coordinate '{}'{}", name, wanted, suggestion(wanted, coordinate_names()));
}

std::string Model::no_muscle(std::string_view wanted) const {
  return fmt::format("model '{}' has no muscle '{}'{}", name, wanted, suggestion(wanted, muscle_names()));
}

Eigen::VectorXd Model::default_pose() const {
  Eigen::VectorXd q(coordinates.size());
  for (std::size_t i = 0; i < coordinates.size(); ++i) q(i) = coordinates[i].default_value;
  for (const CoordinateCoupler& c : couplers) q(c.dependent) = c.function.evaluate(q(c.independent)).value;
  return q;
}

void add_load(Model& model, std::string_view body_name, double mass, const Eigen::Vector3d& location) {
  const int index = model.body(body_name);
  if (index < 0) {
    std::vector<std::string> names;
    for (const Body& b : model.bodies) names.push_back(b.name);
    throw InputError("load",
                     fmt::format("model '{}' has no body '{}'{}", model.name, body_name, suggestion(body_name, names)));
  }
  if (!(mass >= 0.0)) throw InputError("load", fmt::format("mass = {} kg on '{}' must be >= 0", mass, body_name));
  Body& body = model.bodies[index];
  const double total = body.mass + mass;
  if (total <= 0.0) return;
  const Eigen::Vector3d center = (body.mass * body.mass_center + mass * location) / total;
  body.inertia +=
      point_mass_inertia(body.mass, body.mass_center - center) + point_mass_inertia(mass, location - center);
  body.mass = total;
  body.mass_center = center;
}

}  // namespace veridyn::muscle
