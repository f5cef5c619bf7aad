#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"

/// Forces of an .osim file that are neither muscles nor actuators.
namespace veridyn::muscle::osim {
namespace {

void read_limit_force(Context& context, const Element& e) {
  CoordinateLimitForce f;
  f.name = e.name();
  f.coordinate = context.coordinate(e, "coordinate", e.text_or("coordinate", ""));
  // The file is per degree for a rotational coordinate.
  const bool rotational = context.model.coordinates[f.coordinate].motion == CoordinateMotion::kRotational;
  const double unit = rotational ? kDegree : 1.0;
  f.upper_stiffness = e.not_negative_or("upper_stiffness", 1.0) / unit;
  f.upper_limit = e.number_or("upper_limit", 0.0) * unit;
  f.lower_stiffness = e.not_negative_or("lower_stiffness", 1.0) / unit;
  f.lower_limit = e.number_or("lower_limit", 0.0) * unit;
  f.damping = e.not_negative_or("damping", 0.001) / unit;
  f.transition = e.positive_or("transition", 0.1) * unit;
  context.model.limit_forces.push_back(std::move(f));
}

void read_coordinate_spring(Context& context, const Element& e) {
  CoordinateSpring s;
  s.name = e.name();
  s.coordinate = context.coordinate(e, "coordinate", e.text_or("coordinate", ""));
  s.stiffness = e.not_negative_or("stiffness", 0.0);
  s.rest_length = e.number_or("rest_length", 0.0);
  s.viscosity = e.not_negative_or("viscosity", 0.0);
  context.model.coordinate_springs.push_back(std::move(s));
}

/// The frame at one end of a force between bodies: a socket, or the property of formats before 4.0.
FrameReference end_frame(Context& context, const Element& e, const char* name, const char* before) {
  const std::string property = fmt::format("socket_{}", name);
  std::string wanted = socket(e, name);
  if (wanted.empty()) wanted = e.text_or(before, "");
  if (wanted.empty()) e.fail(property, "names no body or frame");
  return context.frame(e, property.c_str(), wanted);
}

void read_point_spring(Context& context, const Element& e) {
  PointSpring s;
  s.name = e.name();
  const FrameReference one = end_frame(context, e, "body1", "body1"), two = end_frame(context, e, "body2", "body2");
  s.body_1 = one.body;
  s.body_2 = two.body;
  s.point_1 = one.placement * e.vector_or("point1", Eigen::Vector3d::Zero());
  s.point_2 = two.placement * e.vector_or("point2", Eigen::Vector3d::Zero());
  s.stiffness = e.not_negative_or("stiffness", 1.0);
  s.rest_length = e.not_negative_or("rest_length", 0.0);
  context.model.body_forces.springs.push_back(std::move(s));
}

Eigen::Vector3d bushing_constants(const Element& e, const char* property) {
  Eigen::Vector3d v = e.vector_or(property, Eigen::Vector3d::Zero());
  if (!(v.minCoeff() >= 0.0)) e.fail(property, "all three must not be negative");
  return v;
}

/// Frames and dampers of a bushing.
Bushing bushing_frames(Context& context, const Element& e) {
  Bushing b;
  b.name = e.name();
  const FrameReference one = end_frame(context, e, "frame1", "body_1"), two = end_frame(context, e, "frame2", "body_2");
  const auto placed = [&](const FrameReference& frame, const char* location, const char* orientation) {
    return frame.placement * Placement{body_fixed_xyz(e.vector_or(orientation, Eigen::Vector3d::Zero())),
                                       e.vector_or(location, Eigen::Vector3d::Zero())};
  };
  b.body_1 = one.body;
  b.body_2 = two.body;
  b.frame_1 = placed(one, "location_body_1", "orientation_body_1");
  b.frame_2 = placed(two, "location_body_2", "orientation_body_2");
  b.rotational_damping = bushing_constants(e, "rotational_damping");
  b.translational_damping = bushing_constants(e, "translational_damping");
  return b;
}

void read_bushing(Context& context, const Element& e) {
  Bushing b = bushing_frames(context, e);
  b.set_stiffness(bushing_constants(e, "rotational_stiffness"), bushing_constants(e, "translational_stiffness"));
  context.model.body_forces.bushings.push_back(std::move(b));
}

void read_function_bushing(Context& context, const Element& e) {
  Bushing b = bushing_frames(context, e);
  constexpr std::array<const char*, 6> kResistances{"m_x_theta_x_function", "m_y_theta_y_function",
                                                    "m_z_theta_z_function", "f_x_delta_x_function",
                                                    "f_y_delta_y_function", "f_z_delta_z_function"};
  for (std::size_t i = 0; i < kResistances.size(); ++i)
    if (const Element function = find_function(e, kResistances[i])) b.resistance[i] = read_function(function);
  if (!b.rotational_damping.isZero() || !b.translational_damping.isZero())
    context.warn(e, "its damping counts here; OpenSim reads it and applies none");
  context.model.body_forces.bushings.push_back(std::move(b));
}

/// The formula of a property; "0" where there is none.
Expression formula(const Element& e, const char* property, std::vector<std::string> variables) {
  const std::string text = e.text_or(property, "");
  try {
    return {text.empty() ? "0" : text, std::move(variables)};
  } catch (const InputError& error) {
    e.fail(property, error.what());
  }
}

void read_expression_coordinate_force(Context& context, const Element& e) {
  const int coordinate = context.coordinate(e, "coordinate", e.text_or("coordinate", ""));
  context.model.expression_forces.coordinates.push_back(
      {e.name(), coordinate, formula(e, "expression", {"q", "qdot"})});
}

void read_expression_point_force(Context& context, const Element& e) {
  const FrameReference one = end_frame(context, e, "body1", "body1"), two = end_frame(context, e, "body2", "body2");
  context.model.expression_forces.points.push_back(
      {.name = e.name(),
       .body_1 = one.body,
       .body_2 = two.body,
       .point_1 = one.placement * e.vector_or("point1", Eigen::Vector3d::Zero()),
       .point_2 = two.placement * e.vector_or("point2", Eigen::Vector3d::Zero()),
       .force = formula(e, "expression", {"d", "ddot"})});
}

void read_expression_bushing(Context& context, const Element& e) {
  ExpressionBushing b{bushing_frames(context, e), {}};
  for (const char* property :
       {"Mx_expression", "My_expression", "Mz_expression", "Fx_expression", "Fy_expression", "Fz_expression"})
    b.resistance.push_back(formula(e, property, {"theta_x", "theta_y", "theta_z", "delta_x", "delta_y", "delta_z"}));
  context.model.expression_forces.bushings.push_back(std::move(b));
}

/// A contact geometry of the file by its name; nothing when it is not there.
Element contact_geometry(const Context& context, std::string_view name) {
  for (const Element& geometry : context.members(PartOf::kContactGeometrySet))
    if (geometry.name() == last_part(name)) return geometry;
  return {context.document, {}};
}

FrameReference geometry_frame(Context& context, const Element& geometry) {
  const FrameReference frame = end_frame(context, geometry, "frame", "body_name");
  const Placement in_frame{body_fixed_xyz(geometry.vector_or("orientation", Eigen::Vector3d::Zero())),
                           geometry.vector_or("location", Eigen::Vector3d::Zero())};
  return {frame.body, frame.placement * in_frame};
}

/// What one geometry brings into a contact.
struct ContactMaterial {
  double stiffness = 0.0, dissipation = 0.0, static_friction = 0.0, dynamic_friction = 0.0, viscous_friction = 0.0;
};

ContactMaterial read_material(const Element& e) {
  return {e.positive_or("stiffness", 1.0), e.not_negative_or("dissipation", 0.0),
          e.not_negative_or("static_friction", 0.0), e.not_negative_or("dynamic_friction", 0.0),
          e.not_negative_or("viscous_friction", 0.0)};
}

/// As Simbody combines two materials.
SphereContact contact_of(Context& context, const Element& e, const Element& sphere, const Element& plane,
                         const ContactMaterial& a, const ContactMaterial& b) {
  SphereContact c;
  c.name = e.name();
  const FrameReference at_sphere = geometry_frame(context, sphere), at_plane = geometry_frame(context, plane);
  c.sphere_body = at_sphere.body;
  c.center = at_sphere.placement.translation;
  c.radius = sphere.positive_or("radius", -1.0);
  c.plane_body = at_plane.body;
  c.plane = at_plane.placement;
  const double ka = std::pow(a.stiffness, 2.0 / 3.0), kb = std::pow(b.stiffness, 2.0 / 3.0);
  const double part_a = kb / (ka + kb);
  c.half_stiffness = ka * part_a;
  c.dissipation = a.dissipation * part_a + b.dissipation * (1.0 - part_a);
  const auto both = [](double x, double y) { return x + y > 0.0 ? 2.0 * x * y / (x + y) : 0.0; };
  c.static_friction = both(a.static_friction, b.static_friction);
  c.dynamic_friction = both(a.dynamic_friction, b.dynamic_friction);
  c.viscous_friction = both(a.viscous_friction, b.viscous_friction);
  c.transition_velocity = e.positive_or("transition_velocity", 0.01);
  return c;
}

/// False: it has a pair of geometries that is not a sphere and a half space.
bool read_hunt_crossley(Context& context, const Element& e) {
  struct Side {
    Element geometry;
    ContactMaterial material;
  };
  std::vector<Side> spheres, planes;
  Element set = e.child("contact_parameters");
  if (!set) set = e.child("HuntCrossleyForce::ContactParametersSet");
  pugi::xml_node list = set.node();
  if (const pugi::xml_node objects = list.child("objects")) list = objects;
  for (const pugi::xml_node node : list.children()) {
    if (node.type() != pugi::node_element || std::string_view(node.name()) == "groups") continue;
    const Element parameters(context.document, node);
    const ContactMaterial material = read_material(parameters);
    for (const std::string& name : parameters.words("geometry")) {
      const Element geometry = contact_geometry(context, name);
      if (!geometry) parameters.fail("geometry", fmt::format("there is no contact geometry '{}'", name));
      if (geometry.type() == "ContactSphere") {
        spheres.push_back({geometry, material});
      } else if (geometry.type() == "ContactHalfSpace") {
        planes.push_back({geometry, material});
      } else {
        return false;
      }
    }
  }
  const auto body_of = [&](const Side& side) { return geometry_frame(context, side.geometry).body; };
  for (const Side& sphere : spheres)
    if (body_of(sphere) != body_of(spheres.front())) {
      context.warn(e, "its spheres are of several bodies: they touch the half space, not each other");
      break;
    }
  for (const Side& sphere : spheres)
    for (const Side& plane : planes)
      context.model.body_forces.contacts.push_back(
          contact_of(context, e, sphere.geometry, plane.geometry, sphere.material, plane.material));
  return true;
}

bool read_smooth_contact(Context& context, const Element& e) {
  const Element sphere = contact_geometry(context, socket(e, "sphere"));
  const Element plane = contact_geometry(context, socket(e, "half_space"));
  if (!sphere || !plane) e.fail(sphere ? "socket_half_space" : "socket_sphere", "names no contact geometry");
  const ContactMaterial material = read_material(e);
  SphereContact c = contact_of(context, e, sphere, plane, material, material);
  c.smooth = true;
  c.constant_force = e.positive_or("constant_contact_force", 1e-5);
  c.hertz_smoothing = e.positive_or("hertz_smoothing", 300.0);
  c.hunt_crossley_smoothing = e.positive_or("hunt_crossley_smoothing", 50.0);
  context.model.body_forces.contacts.push_back(std::move(c));
  return true;
}

void read_path_spring(Context& context, const Element& e) {
  PassivePath path;
  path.name = e.name();
  read_path(context, e, path.points, path.wraps, path.function);
  path.law = PathSpringLaw{e.not_negative_or("resting_length", 0.0), e.not_negative_or("stiffness", 0.0),
                           e.not_negative_or("dissipation", 0.0)};
  context.model.passive_paths.push_back(std::move(path));
}

void read_ligament(Context& context, const Element& e) {
  PassivePath path;
  path.name = e.name();
  read_path(context, e, path.points, path.wraps, path.function);
  const Element curve = find_function(e, "force_length_curve");
  if (!curve) e.fail("force_length_curve", "missing");
  path.law =
      LigamentLaw{e.positive_or("resting_length", -1.0), e.not_negative_or("pcsa_force", 0.0), read_function(curve)};
  context.model.passive_paths.push_back(std::move(path));
}

void read_blankevoort_ligament(Context& context, const Element& e) {
  PassivePath path;
  path.name = e.name();
  read_path(context, e, path.points, path.wraps, path.function);
  path.law = BlankevoortLaw{.slack_length = e.positive_or("slack_length", -1.0),
                            .linear_stiffness = e.not_negative_or("linear_stiffness", 1.0),
                            .transition_strain = e.not_negative_or("transition_strain", 0.06),
                            .damping_coefficient = e.not_negative_or("damping_coefficient", 0.003)};
  context.model.passive_paths.push_back(std::move(path));
}

}  // namespace

bool read_passive_force(Context& context, const Element& e) {
  const std::string type = e.type();
  if (type == "CoordinateLimitForce") return read_limit_force(context, e), true;
  if (type == "SpringGeneralizedForce") return read_coordinate_spring(context, e), true;
  if (type == "PointToPointSpring") return read_point_spring(context, e), true;
  if (type == "BushingForce") return read_bushing(context, e), true;
  if (type == "FunctionBasedBushingForce") return read_function_bushing(context, e), true;
  if (type == "HuntCrossleyForce") return read_hunt_crossley(context, e);
  if (type == "SmoothSphereHalfSpaceForce") return read_smooth_contact(context, e);
  if (type == "PathSpring") return read_path_spring(context, e), true;
  if (type == "Ligament") return read_ligament(context, e), true;
  if (type == "ExpressionBasedCoordinateForce") return read_expression_coordinate_force(context, e), true;
  if (type == "ExpressionBasedPointToPointForce") return read_expression_point_force(context, e), true;
  if (type == "ExpressionBasedBushingForce") return read_expression_bushing(context, e), true;
  if (type == "Blankevoort1991Ligament") return read_blankevoort_ligament(context, e), true;
  return false;
}

}  // namespace veridyn::muscle::osim
