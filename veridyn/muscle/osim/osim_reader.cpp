#include "veridyn/muscle/osim/osim_reader.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"

namespace veridyn::muscle {
namespace osim {
namespace {

/// About the mass centre. What no mass can have is repaired: negative principal moments become zero.
Eigen::Matrix3d read_inertia(Context& context, const Element& body) {
  std::vector<double> v = body.numbers("inertia");
  if (v.empty()) {  // formats before 4.0
    for (const char* part : {"inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"}) {
      v.push_back(body.number_or(part, 0.0));
    }
  }
  if (v.size() != 6) body.fail("inertia", fmt::format("{} numbers where xx yy zz xy xz yz are expected", v.size()));
  Eigen::Matrix3d inertia;
  inertia << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  const Eigen::Vector3d& moments = principal.eigenvalues();
  if (moments.minCoeff() >= -1e-9 * moments.cwiseAbs().maxCoeff()) return inertia;
  const Eigen::Vector3d raised = moments.cwiseMax(0.0);
  Eigen::Matrix3d repaired = principal.eigenvectors() * raised.asDiagonal() * principal.eigenvectors().transpose();
  context.warn(body, fmt::format("inertia is not positive semidefinite, so that no mass has it: its least principal "
                                 "moment, {:.4g} kg m^2, is taken as 0, which changes entries by up to {:.4g} kg m^2",
                                 moments.minCoeff(), (repaired - inertia).cwiseAbs().maxCoeff()));
  return repaired;
}

WrapQuadrant read_quadrant(const Element& wrap) {
  const std::string text = wrap.text_or("quadrant", "all");
  if (text == "all" || text == "All" || text == "ALL") return {};
  std::string_view axis = text;
  int sign = 1;
  if (axis.starts_with('-')) sign = -1;
  if (axis.starts_with('-') || axis.starts_with('+')) axis.remove_prefix(1);
  if (axis == "x" || axis == "X") return {0, sign};
  if (axis == "y" || axis == "Y") return {1, sign};
  if (axis == "z" || axis == "Z") return {2, sign};
  wrap.fail("quadrant", fmt::format("'{}' is none of all, x, -x, y, -y, z, -z", text));
}

void read_wraps_of(Context& context, const Element& body_element, int body) {
  for (const Element& element : body_element.objects("WrapObjectSet")) {
    WrapObject wrap;
    wrap.name = element.name();
    wrap.body = body;
    wrap.placement = read_placement(element, "translation", "xyz_body_rotation");
    wrap.active = element.flag_or("active", true);
    wrap.quadrant = read_quadrant(element);
    const std::string type = element.type();
    if (type == "WrapSphere") {
      wrap.shape = WrapShape::kSphere;
      wrap.dimensions.x() = element.positive_or("radius", -1.0);
    } else if (type == "WrapCylinder") {
      wrap.shape = WrapShape::kCylinder;
      wrap.dimensions = {element.positive_or("radius", -1.0), element.positive_or("length", 1.0), 0.0};
    } else if (type == "WrapEllipsoid") {
      wrap.shape = WrapShape::kEllipsoid;
      wrap.dimensions = element.vector_or("dimensions", Eigen::Vector3d::Constant(-1.0));
      if (!(wrap.dimensions.minCoeff() > 0.0)) element.fail("dimensions", "all three radii must be > 0");
    } else if (type == "WrapTorus") {
      wrap.shape = WrapShape::kTorus;
      wrap.dimensions = {element.positive_or("inner_radius", -1.0), element.positive_or("outer_radius", -1.0), 0.0};
    } else {
      context.unsupported(element, true);
      continue;
    }
    context.model.wrap_objects.push_back(std::move(wrap));
  }
}

void read_gravity_and_units(Context& context, const Element& root) {
  context.model.gravity = root.vector_or("gravity", {0.0, -kGravity, 0.0});
  // Labels for OpenSim, which computes with the numbers as they are.
  const auto check = [&](const char* property, std::string_view unit, std::initializer_list<std::string_view> same) {
    const std::string text = root.text_or(property, unit);
    if (std::find(same.begin(), same.end(), text) != same.end()) return;
    context.warn(root, fmt::format("{} is '{}'; its numbers are taken as {}, as OpenSim takes them", property,
                                   one_line(text), unit));
  };
  check("length_units", "meters", {"meters", "meter", "metres", "metre", "m"});
  check("force_units", "newtons", {"newtons", "newton", "Newtons", "N"});
}

/// Far above the largest models of people (some 150 bodies): what has more was made by mistake or to do harm.
void refuse_endless(const Document& document) {
  constexpr std::size_t kMostBodies = 2000;
  std::size_t bodies = Element(document, document.model()).objects("BodySet").size();
  for (const pugi::xml_node component : document.model().child("components").children())
    if (part_of(component.name()) == PartOf::kBodySet) ++bodies;
  if (bodies > kMostBodies)
    throw InputError(document.name(), fmt::format("has {} bodies; at most {} are read", bodies, kMostBodies));
}

/// By their order in PartOf.
constexpr std::array<const char*, 6> kSets{"BodySet",  "JointSet",           "ConstraintSet",
                                           "ForceSet", "ContactGeometrySet", "MarkerSet"};

bool ends_with_one_of(std::string_view type, std::initializer_list<std::string_view> ends) {
  return std::any_of(ends.begin(), ends.end(), [type](std::string_view end) { return type.ends_with(end); });
}

}  // namespace

PartOf part_of(std::string_view type) {
  if (type == "Body") return PartOf::kBodySet;
  if (type == "Marker") return PartOf::kMarkerSet;
  if (type == "ContactSphere" || type == "ContactHalfSpace" || type == "ContactMesh")
    return PartOf::kContactGeometrySet;
  if (type.ends_with("Joint")) return PartOf::kJointSet;
  if (type.ends_with("Constraint")) return PartOf::kConstraintSet;
  if (is_muscle(type) || ends_with_one_of(type, {"Force", "Actuator", "Spring", "Ligament", "Muscle"}))
    return PartOf::kForceSet;
  if (ends_with_one_of(type, {"Frame", "Station", "Probe", "Reporter", "Controller", "Metabolics", "Sensor", "IMU"}))
    return PartOf::kNothing;
  return PartOf::kUnknown;
}

std::vector<Element> components_of(const Document& document) {
  std::vector<Element> found;
  for (const pugi::xpath_node node : document.model().select_nodes(".//components/* | ./ComponentSet/objects/*"))
    found.emplace_back(document, node.node());
  return found;
}

std::vector<Element> Context::members(PartOf set) const {
  std::vector<Element> found = Element(document, document.model()).objects(kSets[static_cast<std::size_t>(set)]);
  for (const Element& component : components)
    if (part_of(component.type()) == set) found.push_back(component);
  return found;
}

int Context::body(const Element& user, const char* property, std::string_view reference) const {
  const int index = model.body(last_part(reference));
  if (index < 0) {
    user.fail(property, fmt::format("there is no body '{}'{}", reference,
                                    suggestion(last_part(reference), names_of(model.bodies), 8)));
  }
  return index;
}

int Context::coordinate(const Element& user, const char* property, std::string_view reference) const {
  const int index = model.coordinate(last_part(reference));
  if (index < 0) {
    user.fail(property, fmt::format("there is no coordinate '{}'{}", reference,
                                    suggestion(last_part(reference), names_of(model.coordinates), 8)));
  }
  return index;
}

void Context::warn(const Element& element, std::string_view what) {
  model.warnings.push_back(fmt::format("{}: {}", element.place(), what));
}

void Context::unsupported(const Element& element, bool changes_motion) {
  model.unsupported.push_back({element.type(), element.name(), changes_motion});
}

std::string socket(const Element& user, const char* name) {
  for (const std::string& property : {fmt::format("socket_{}", name), fmt::format("socket_{}_connectee_name", name)}) {
    if (user.has(property.c_str())) return user.text_or(property.c_str(), "");
  }
  for (const pugi::xml_node connector : user.node().child("connectors").children()) {
    if (std::strcmp(connector.attribute("name").value(), name) == 0)
      return connector.child("connectee_name").text().get();
  }
  return {};
}

void read_bodies(Context& context) {
  context.model.bodies.push_back({.name = "ground"});
  for (const Element& element : context.members(PartOf::kBodySet)) {
    if (element.type() != "Body") {
      context.unsupported(element, true);
      continue;
    }
    const std::string name = element.name();
    if (name == "ground") continue;  // formats before 4.0 list it
    if (name.empty()) element.fail("name", "a body needs a name");
    if (context.model.body(name) >= 0) element.fail("name", "a second body of this name");
    Body body;
    body.name = name;
    body.mass = element.not_negative_or("mass", 0.0);
    body.mass_center = element.vector_or("mass_center", Eigen::Vector3d::Zero());
    body.inertia = read_inertia(context, element);
    context.model.bodies.push_back(std::move(body));
  }
}

void read_wrap_objects(Context& context) {
  const Element root(context.document, context.document.model());
  read_wraps_of(context, root.child("Ground"), 0);
  for (const Element& element : context.members(PartOf::kBodySet)) {
    const int body = context.model.body(element.name());
    if (body >= 0) read_wraps_of(context, element, body);
  }
}

void read_markers(Context& context) {
  for (const Element& element : context.members(PartOf::kMarkerSet)) {
    if (element.type() != "Marker") continue;
    const FrameReference at = context.frame_or_ground(element);
    context.model.markers.push_back(
        {element.name(), at.body, at.placement * element.vector_or("location", Eigen::Vector3d::Zero())});
  }
}

}  // namespace osim

OsimFile OsimFile::parse(std::string text, std::string name) {
  OsimFile file;
  auto document = std::make_shared<osim::Document>(std::move(text), std::move(name));
  osim::refuse_endless(*document);
  osim::Context context{*document, {}, {}, {}, osim::components_of(*document)};
  const osim::Element root(*document, document->model());
  context.model.name = root.name();
  context.model.credits = root.text_or("credits", "");
  context.model.version = document->version();
  for (const pugi::xpath_node found : document->model().select_nodes(".//PhysicalOffsetFrame | .//StationDefinedFrame"))
    context.frames.emplace_back(*document, found.node());
  for (const pugi::xpath_node found : document->model().select_nodes(".//Station | .//Marker"))
    context.stations.emplace_back(*document, found.node());
  osim::read_gravity_and_units(context, root);
  osim::read_bodies(context);
  osim::read_wrap_objects(context);
  osim::read_joints(context);
  osim::read_constraints(context);
  osim::read_default_speeds(context);
  osim::read_forces(context);
  osim::read_markers(context);
  for (const char* set : {"ControllerSet", "ProbeSet"})
    for (const osim::Element& element : root.objects(set)) context.unsupported(element, false);
  for (const osim::Element& element : context.components) {
    const osim::PartOf part = osim::part_of(element.type());
    // Frames and stations are nothing by themselves: what refers to them finds them.
    if (element.type().ends_with("Frame") || element.type() == "Station") continue;
    if (part == osim::PartOf::kNothing || part == osim::PartOf::kUnknown)
      context.unsupported(element, part == osim::PartOf::kUnknown);
  }
  file.model_ = std::move(context.model);
  file.document_ = std::move(document);
  return file;
}

OsimFile OsimFile::load(const std::filesystem::path& path) { return parse(read_file(path), path.filename().string()); }

const std::string& OsimFile::text() const { return document_->text(); }

Model read_osim(const std::filesystem::path& path) { return OsimFile::load(path).model(); }

}  // namespace veridyn::muscle
