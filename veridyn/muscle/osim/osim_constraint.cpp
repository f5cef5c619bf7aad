#include <fmt/format.h>

#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"

/// Constraints of an .osim file.
namespace veridyn::muscle::osim {
namespace {

void read_coupler(Context& context, const Element& element) {
  const std::vector<std::string> independent = element.words("independent_coordinate_names");
  if (independent.size() != 1) {
    element.fail("independent_coordinate_names",
                 fmt::format("{} names; couplers of one coordinate are understood", independent.size()));
  }
  CoordinateCoupler coupler;
  coupler.name = element.name();
  coupler.independent = context.coordinate(element, "independent_coordinate_names", independent.front());
  coupler.dependent =
      context.coordinate(element, "dependent_coordinate_name", element.text_or("dependent_coordinate_name", ""));
  if (coupler.dependent == coupler.independent)
    element.fail("dependent_coordinate_name", "a coordinate cannot be coupled to itself");
  const Element function = find_function(element, "coupled_coordinates_function");
  if (!function) element.fail("coupled_coordinates_function", "missing");
  coupler.function = read_function(function).scaled(element.number_or("scale_factor", 1.0));
  context.model.couplers.push_back(std::move(coupler));
}

/// Of the sockets' two names the first that is there, or the property of formats before 4.0.
FrameReference constrained_frame(Context& context, const Element& e, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    std::string wanted = socket(e, name);
    if (wanted.empty()) wanted = e.text_or(name, "");
    if (!wanted.empty()) return context.frame(e, name, wanted);
  }
  e.fail(*names.begin(), "names no body or frame");
}

/// The constraint's frames in their bodies, with points as their origins.
LoopConstraint read_bodies_of_loop(Context& context, const Element& e, LoopKind kind,
                                   std::initializer_list<const char*> one, std::initializer_list<const char*> two,
                                   const char* point_1, const char* point_2) {
  LoopConstraint loop;
  loop.name = e.name();
  loop.kind = kind;
  const FrameReference first = constrained_frame(context, e, one), second = constrained_frame(context, e, two);
  loop.body_1 = first.body;
  loop.body_2 = second.body;
  loop.frame_1 = first.placement * Placement{.translation = e.vector_or(point_1, Eigen::Vector3d::Zero())};
  loop.frame_2 = second.placement * Placement{.translation = e.vector_or(point_2, Eigen::Vector3d::Zero())};
  if (loop.body_1 == loop.body_2) e.fail(*two.begin(), "both ends are on the same body");
  return loop;
}

LoopConstraint read_point_loop(Context& context, const Element& e) {
  return read_bodies_of_loop(context, e, LoopKind::kPoint, {"body_1"}, {"body_2"}, "location_body_1",
                             "location_body_2");
}

LoopConstraint read_weld_loop(Context& context, const Element& e) {
  LoopConstraint loop = read_bodies_of_loop(context, e, LoopKind::kWeld, {"frame1", "body_1"}, {"frame2", "body_2"},
                                            "location_body_1", "location_body_2");
  // Of formats before 4.0.
  loop.frame_1.rotation *= body_fixed_xyz(e.vector_or("orientation_body_1", Eigen::Vector3d::Zero()));
  loop.frame_2.rotation *= body_fixed_xyz(e.vector_or("orientation_body_2", Eigen::Vector3d::Zero()));
  return loop;
}

LoopConstraint read_distance_loop(Context& context, const Element& e) {
  LoopConstraint loop = read_bodies_of_loop(context, e, LoopKind::kDistance, {"body_1"}, {"body_2"}, "location_body_1",
                                            "location_body_2");
  loop.distance = e.positive_or("constant_distance", -1.0);
  return loop;
}

LoopConstraint read_line_loop(Context& context, const Element& e) {
  LoopConstraint loop = read_bodies_of_loop(context, e, LoopKind::kPointOnLine, {"line_body"}, {"follower_body"},
                                            "point_on_line", "point_on_follower");
  const Eigen::Vector3d line = e.vector_or("line_direction_vec", Eigen::Vector3d::Zero());
  if (!(line.norm() > 1e-12)) e.fail("line_direction_vec", "has no direction");
  Eigen::Index least = 0;
  line.cwiseAbs().minCoeff(&least);
  Eigen::Matrix3d along;
  along.col(0) = line.normalized();
  along.col(1) = Eigen::Vector3d::Unit(least).cross(along.col(0)).normalized();
  along.col(2) = along.col(0).cross(along.col(1));
  loop.frame_1.rotation *= along;
  return loop;
}

}  // namespace

void read_constraints(Context& context) {
  for (const Element& element : context.members(PartOf::kConstraintSet)) {
    const bool on = element.flag_or("isEnforced", !element.flag_or("isDisabled", false));
    const std::string type = element.type();
    if (type == "CoordinateCouplerConstraint") {
      if (on) read_coupler(context, element);
      continue;
    }
    LoopConstraint (*read)(Context&, const Element&) = nullptr;
    if (type == "PointConstraint") read = read_point_loop;
    if (type == "WeldConstraint") read = read_weld_loop;
    if (type == "ConstantDistanceConstraint") read = read_distance_loop;
    if (type == "PointOnLineConstraint") read = read_line_loop;
    if (read == nullptr) {
      context.unsupported(element, on);
    } else if (on) {
      context.model.loops.push_back(read(context, element));
    }
  }
}

}  // namespace veridyn::muscle::osim
