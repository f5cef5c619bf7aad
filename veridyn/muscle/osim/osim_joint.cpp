#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <deque>
#include <map>
#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/joint_speeds.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"

/// Joints of an .osim file, every type expressed by six transform axes.
namespace veridyn::muscle::osim {
namespace {

/// Which of rotation x, y, z and translation x, y, z a joint's coordinates drive, in the order of its coordinates.
const std::map<std::string, std::vector<int>, std::less<>> kPlainJoints{{"WeldJoint", {}},
                                                                        {"PinJoint", {2}},
                                                                        {"SliderJoint", {3}},
                                                                        {"UniversalJoint", {0, 1}},
                                                                        {"BallJoint", {0, 1, 2}},
                                                                        {"GimbalJoint", {0, 1, 2}},
                                                                        {"PlanarJoint", {2, 3, 4}},
                                                                        {"FreeJoint", {0, 1, 2, 3, 4, 5}},
                                                                        {"EllipsoidJoint", {0, 1, 2}}};

TransformAxis& axis_of(Joint& joint, std::size_t index) {
  return index < 3 ? joint.rotation[index] : joint.translation[index - 3];
}

/// A constant holds the coordinate as a lock does; a motion over time is none that is understood.
void read_prescribed(Context& context, const Element& e, Coordinate& coordinate) {
  const Element function = find_function(e, "prescribed_function");
  if (!function) return;
  if (function.type() != "Constant") {
    context.model.unsupported.push_back({"prescribed_function", coordinate.name, true});
    return;
  }
  coordinate.locked = true;
  coordinate.default_value = function.number_or("value", 0.0);
  coordinate.default_speed = 0.0;
  context.warn(e, fmt::format("its prescribed_function holds it at {:g}", coordinate.default_value));
}

/// Coordinates of a joint: `<coordinates>` (4.x) or `<CoordinateSet>` (before).
void read_coordinates(Context& context, const Element& element, Joint& joint, std::size_t wanted) {
  std::vector<Element> found = element.objects("coordinates");
  if (found.empty()) found = element.objects("CoordinateSet");
  std::erase_if(found, [](const Element& e) { return e.type() != "Coordinate"; });
  const int index = static_cast<int>(context.model.joints.size());
  for (const Element& c : found) {
    Coordinate coordinate;
    coordinate.name = c.name();
    if (coordinate.name.empty()) c.fail("name", "a coordinate needs a name");
    if (context.model.coordinate(coordinate.name) >= 0) c.fail("name", "a second coordinate of this name");
    coordinate.joint = index;
    coordinate.default_value = c.number_or("default_value", 0.0);
    coordinate.default_speed = c.number_or("default_speed_value", 0.0);
    coordinate.clamped = c.flag_or("clamped", false);
    coordinate.locked = c.flag_or("locked", false);
    const std::vector<double> range = c.numbers("range");
    coordinate.low = -1e6;
    coordinate.high = 1e6;
    if (!range.empty()) {
      if (range.size() != 2) c.fail("range", fmt::format("{} numbers where two are expected", range.size()));
      if (range[0] > range[1]) c.fail("range", fmt::format("begins at {} above its end {}", range[0], range[1]));
      coordinate.low = range[0];
      coordinate.high = range[1];
    }
    // Two numbers of a file may differ in their last printed digit.
    const double slack = 1e-6 * (1.0 + coordinate.high - coordinate.low);
    if (coordinate.default_value < coordinate.low - slack || coordinate.default_value > coordinate.high + slack) {
      context.warn(c, fmt::format("default_value {} is outside the range {} .. {}", coordinate.default_value,
                                  coordinate.low, coordinate.high));
    }
    if (c.flag_or("prescribed", false) && !coordinate.locked) read_prescribed(context, c, coordinate);
    joint.coordinates.push_back(static_cast<int>(context.model.coordinates.size()));
    context.model.coordinates.push_back(std::move(coordinate));
  }
  for (std::size_t i = found.size(); i < wanted; ++i) {  // the file left them to OpenSim's defaults
    Coordinate coordinate;
    coordinate.name = fmt::format("{}_coord_{}", joint.name, i);
    if (context.model.coordinate(coordinate.name) >= 0) element.fail("coordinates", "missing");
    coordinate.joint = index;
    coordinate.low = -1e6;
    coordinate.high = 1e6;
    joint.coordinates.push_back(static_cast<int>(context.model.coordinates.size()));
    context.model.coordinates.push_back(std::move(coordinate));
  }
}

void read_plain_axes(Context& context, const Element& element, const std::vector<int>& axes, Joint& joint) {
  if (joint.coordinates.size() != axes.size()) {
    element.fail("coordinates", fmt::format("{} where a {} has {}", joint.coordinates.size(), joint.type, axes.size()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    TransformAxis& axis = axis_of(joint, static_cast<std::size_t>(axes[i]));
    axis.coordinate = joint.coordinates[i];
    axis.function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
    context.model.coordinates[axis.coordinate].motion =
        axes[i] < 3 ? CoordinateMotion::kRotational : CoordinateMotion::kTranslational;
  }
}

/// A coordinate is rotational (translational) when some rotation (translation) is the coordinate itself.
void classify(Context& context, const Joint& joint) {
  for (const int index : joint.coordinates) {
    CoordinateMotion motion = CoordinateMotion::kCoupled;
    Joint copy = joint;
    for (std::size_t i = 0; i < 6; ++i) {
      const TransformAxis& axis = axis_of(copy, i);
      if (axis.coordinate != index || !axis.function.is_linear()) continue;
      const numerics::FunctionValue<double> f = axis.function.evaluate(0.0);
      if (f.slope != 1.0 && f.slope != -1.0) continue;
      motion = i < 3 ? CoordinateMotion::kRotational : CoordinateMotion::kTranslational;
      break;
    }
    context.model.coordinates[index].motion = motion;
  }
}

/// A motion of more than one coordinate of the joint.
void read_axis_of_several(const Context& context, const Element& source, const std::vector<std::string>& names,
                          const Joint& joint, TransformAxis& axis) {
  const Element function = find_function(source, "function");
  if (!function) source.fail("function", "missing");
  for (const std::string& name : names) {
    const int index = context.coordinate(source, "coordinates", name);
    if (std::find(joint.coordinates.begin(), joint.coordinates.end(), index) == joint.coordinates.end())
      source.fail("coordinates", fmt::format("'{}' is not a coordinate of joint '{}'", name, joint.name));
    if (std::find(axis.several.begin(), axis.several.end(), index) != axis.several.end())
      source.fail("coordinates", fmt::format("'{}' stands there twice", name));
    axis.several.push_back(index);
  }
  axis.function_of_several = read_function_of_several(function, names.size());
}

void read_spatial_transform(Context& context, const Element& element, Joint& joint) {
  const Element transform = element.child("SpatialTransform");
  if (!transform) element.fail("SpatialTransform", "missing");
  constexpr std::array<const char*, 6> kAxes{"rotation1",    "rotation2",    "rotation3",
                                             "translation1", "translation2", "translation3"};
  for (const pugi::xml_node node : transform.node().children("TransformAxis")) {
    const Element source(context.document, node);
    std::size_t index = 6;
    for (std::size_t i = 0; i < 6; ++i) {
      if (source.name() == kAxes[i]) index = i;
    }
    if (index == 6) source.fail("name", "is none of rotation1 to rotation3, translation1 to translation3");
    TransformAxis& axis = axis_of(joint, index);
    const Eigen::Vector3d direction = source.vector_or("axis", axis.axis);
    if (!(direction.norm() > 1e-12)) source.fail("axis", "has no direction");
    axis.axis = direction.normalized();
    const std::vector<std::string> names = source.words(source.has("coordinates") ? "coordinates" : "coordinate");
    const Element function = find_function(source, "function");
    if (names.size() > 1) {
      read_axis_of_several(context, source, names, joint, axis);
      continue;
    }
    if (function) axis.function = read_function(function);
    if (names.empty()) {
      // A function without a coordinate has no argument: it has to be a constant.
      if (function && !axis.function.is_constant()) {
        axis.function = numerics::PiecewisePolynomial::constant(axis.function.evaluate(0.0).value);
      }
      continue;
    }
    if (!function) source.fail("function", "missing");
    axis.coordinate = context.coordinate(source, "coordinates", names.front());
    if (std::find(joint.coordinates.begin(), joint.coordinates.end(), axis.coordinate) == joint.coordinates.end()) {
      source.fail("coordinates", fmt::format("'{}' is not a coordinate of joint '{}'", names.front(), joint.name));
    }
    if (axis.function.is_constant()) axis.coordinate = -1;
  }
  classify(context, joint);
}

/// The frame at one end of a joint. Where its socket is empty, the joint's own offset frame of that place, parent's
/// first, as OpenSim writes them; else the body that the formats before 4.0 name.
FrameReference joint_frame(Context& context, const Element& element, const char* name, std::size_t place) {
  const std::string property = fmt::format("socket_{}", name);
  const std::string wanted = socket(element, name);
  if (!wanted.empty()) return context.frame(element, property.c_str(), wanted);
  const std::vector<Element> own = element.objects("frames");
  std::string instead;
  if (place < own.size()) {
    instead = own[place].name();
  } else {
    instead = element.text_or(place == 0 ? "parent_body" : "child_body", "");
  }
  if (instead.empty()) element.fail(property, "is empty, and nothing else says which body is meant");
  context.warn(element, fmt::format("{} is empty; '{}' is taken", property, one_line(instead)));
  return context.frame(element, property.c_str(), instead);
}

struct JointSource {
  Element element;
  int child = -1;  ///< known beforehand in formats before 4.0, where a body holds its joint
};

std::vector<JointSource> joint_sources(const Context& context) {
  std::vector<JointSource> sources;
  for (const Element& element : context.members(PartOf::kJointSet)) sources.push_back({element, -1});
  for (const Element& body : context.members(PartOf::kBodySet)) {
    for (const pugi::xml_node node : body.property("Joint").children()) {
      if (node.type() == pugi::node_element)
        sources.push_back({{context.document, node}, context.model.body(body.name())});
    }
  }
  return sources;
}

/// A joint of no type yet: its axes are those of its frames.
Joint named_joint(const Element& element) {
  Joint joint;
  joint.name = element.name();
  joint.type = element.type();
  for (std::size_t i = 0; i < 3; ++i) {
    joint.rotation[i].axis = Eigen::Vector3d::Unit(signed_index(i));
    joint.translation[i].axis = Eigen::Vector3d::Unit(signed_index(i));
  }
  return joint;
}

/// The bodies that the joint connects, and its frames in them.
void read_ends(Context& context, const JointSource& source, Joint& joint) {
  const Element& element = source.element;
  if (source.child < 0) {
    const FrameReference parent_frame = joint_frame(context, element, "parent_frame", 0);
    const FrameReference child_frame = joint_frame(context, element, "child_frame", 1);
    joint.parent = parent_frame.body;
    joint.parent_frame = parent_frame.placement;
    joint.child = child_frame.body;
    joint.child_frame = child_frame.placement;
  } else {
    joint.parent = context.body(element, "parent_body", element.text_or("parent_body", "ground"));
    joint.child = source.child;
    const auto placement = [&](const char* location, const char* orientation) -> Placement {
      return {body_fixed_xyz(element.vector_or(orientation, Eigen::Vector3d::Zero())),
              element.vector_or(location, Eigen::Vector3d::Zero())};
    };
    joint.parent_frame = placement("location_in_parent", "orientation_in_parent");
    joint.child_frame = placement("location", "orientation");
  }
  if (joint.child == joint.parent) element.fail("child", "a joint cannot connect a body to itself");
}

void read_radii(const Element& element, const char* property, Joint& joint) {
  joint.ellipsoid_radii = element.vector_or(property, Eigen::Vector3d::Constant(-1.0));
  if (!(joint.ellipsoid_radii.minCoeff() > 0.0)) element.fail(property, "all three radii must be > 0");
}

/// As OpenSim builds it: over an ellipsoid of the thorax, whose frame is turned by 90 deg so that abduction and
/// elevation are positive, on a massless body; and from there about the winging axis.
void read_scapulothoracic(Context& context, const Element& element, Joint joint) {
  read_coordinates(context, element, joint, 4);
  Joint winging = joint;
  winging.name += "_winging";
  joint.coordinates.resize(3);
  read_plain_axes(context, element, {0, 1, 2}, joint);
  read_radii(element, "thoracic_ellipsoid_radii_x_y_z", joint);
  std::swap(joint.ellipsoid_radii.x(), joint.ellipsoid_radii.y());
  const Placement turned{body_fixed_xyz({0.0, 0.0, 0.5 * kPi}), Eigen::Vector3d::Zero()};
  joint.parent_frame = joint.parent_frame * turned;
  joint.child_frame = turned;
  joint.child = static_cast<int>(context.model.bodies.size());
  context.model.bodies.push_back({.name = joint.name + "_surface"});

  const std::vector<double> origin = element.numbers("scapula_winging_axis_origin");
  if (!origin.empty() && origin.size() != 2)
    element.fail("scapula_winging_axis_origin", fmt::format("{} numbers where two are expected", origin.size()));
  const double direction = element.number_or("scapula_winging_axis_direction", 0.0);
  // Rotations about z become those about (-sin, cos, 0).
  Placement axis;
  axis.rotation.col(2) = Eigen::Vector3d(-std::sin(direction), std::cos(direction), 0.0);
  axis.rotation.col(0) = Eigen::Vector3d::UnitZ();
  axis.rotation.col(1) = axis.rotation.col(2).cross(axis.rotation.col(0));
  if (!origin.empty()) axis.translation = Eigen::Vector3d(origin[0], origin[1], 0.0);
  winging.coordinates = {winging.coordinates[3]};
  read_plain_axes(context, element, {2}, winging);
  winging.parent = joint.child;
  winging.parent_frame = axis;
  winging.child_frame = winging.child_frame * axis;
  context.model.joints.push_back(std::move(joint));
  context.model.joints.push_back(std::move(winging));
}

void read_joint(Context& context, const JointSource& source) {
  const Element& element = source.element;
  Joint joint = named_joint(element);
  const auto plain = kPlainJoints.find(joint.type);
  if (plain == kPlainJoints.end() && joint.type != "CustomJoint" && joint.type != "ScapulothoracicJoint")
    element.fail(joint.type, "joints of this type are not understood");
  read_ends(context, source, joint);
  joint.reversed = element.flag_or("reverse", false);
  if (joint.type == "ScapulothoracicJoint") {
    if (joint.reversed) element.fail("reverse", "a joint of this type is not understood the other way round");
    return read_scapulothoracic(context, element, std::move(joint));
  }
  read_coordinates(context, element, joint, plain == kPlainJoints.end() ? 0 : plain->second.size());
  if (plain != kPlainJoints.end()) {
    read_plain_axes(context, element, plain->second, joint);
  } else {
    read_spatial_transform(context, element, joint);
  }
  if (joint.type == "EllipsoidJoint") read_radii(element, "radii_x_y_z", joint);
  context.model.joints.push_back(std::move(joint));
}

/// A joint between two bodies that others hold already: half of its child stays, the other half hangs on the joint, and
/// a weld holds them together. OpenSim splits bodies in the same way.
void close_loop(Context& context, std::size_t index) {
  Model& model = context.model;
  Joint& joint = model.joints[index];
  Body& whole = model.bodies[joint.child];
  whole.mass *= 0.5;
  whole.inertia *= 0.5;
  Body half = whole;
  half.name = fmt::format("{}_{}", whole.name, joint.name);
  model.warnings.push_back(
      fmt::format("{}: joint '{}' closes a loop: body '{}' is split into halves that a constraint welds together",
                  context.document.name(), joint.name, whole.name));
  model.loops.push_back({.name = joint.name + "_loop",
                         .kind = LoopKind::kWeld,
                         .body_1 = joint.child,
                         .body_2 = static_cast<int>(model.bodies.size())});
  joint.child = model.loops.back().body_2;
  model.bodies.push_back(std::move(half));
}

/// Makes a tree of the joints, level by level from the ground: those whose child is nearer to it are turned round.
void grow_tree(Context& context) {
  Model& model = context.model;
  std::vector<std::vector<std::size_t>> of_body(model.bodies.size());
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    of_body[model.joints[j].parent].push_back(j);
    of_body[model.joints[j].child].push_back(j);
  }
  std::vector<char> in_tree(model.bodies.size(), 0), used(model.joints.size(), 0);
  std::deque<int> next{0};
  in_tree[0] = 1;
  std::vector<std::size_t> loops;
  while (!next.empty()) {
    const int body = next.front();
    next.pop_front();
    for (const std::size_t j : of_body[body]) {
      if (used[j] != 0) continue;
      used[j] = 1;
      Joint& joint = model.joints[j];
      const int other = joint.parent == body ? joint.child : joint.parent;
      if (in_tree[other] != 0) {
        loops.push_back(j);
        continue;
      }
      in_tree[other] = 1;
      next.push_back(other);
      if (joint.parent == body) continue;
      std::swap(joint.parent, joint.child);
      std::swap(joint.parent_frame, joint.child_frame);
      joint.reversed = !joint.reversed;
    }
  }
  for (const std::size_t j : loops) {
    if (model.joints[j].child == 0) {  // the ground is not split
      std::swap(model.joints[j].parent, model.joints[j].child);
      std::swap(model.joints[j].parent_frame, model.joints[j].child_frame);
      model.joints[j].reversed = !model.joints[j].reversed;
    }
    close_loop(context, j);
  }
  for (std::size_t b = 1; b < in_tree.size(); ++b) {
    if (in_tree[b] != 0) continue;
    const Element root(context.document, context.document.model());
    const std::string& name = model.bodies[b].name;
    if (of_body[b].empty()) root.fail("JointSet", fmt::format("no joint holds body '{}'", name));
    root.fail("JointSet", fmt::format("the joints from body '{}' lead to other bodies, not to the ground", name));
  }
}

}  // namespace

void read_joints(Context& context) {
  for (const JointSource& source : joint_sources(context)) read_joint(context, source);
  grow_tree(context);
}

void read_default_speeds(Context& context) {
  Model& model = context.model;
  Eigen::VectorXd speeds(signed_index(model.coordinates.size()));
  for (Eigen::Index c = 0; c < speeds.size(); ++c) speeds(c) = model.coordinates[at(c)].default_speed;
  try {
    speeds = rates_of_opensim_speeds(model, model.default_pose(), speeds);
  } catch (const InputError& error) {
    throw InputError(context.document.name(), fmt::format("default_speed_value: {}", error.what()));
  }
  for (Eigen::Index c = 0; c < speeds.size(); ++c) model.coordinates[at(c)].default_speed = speeds(c);
}

}  // namespace veridyn::muscle::osim
