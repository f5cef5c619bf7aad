#include <fmt/format.h>

#include <cstring>
#include <set>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_function.hpp"

/// Muscles, their paths and the actuators of an .osim file.
namespace veridyn::muscle::osim {
namespace {

PathPoint read_point(Context& context, const Element& element) {
  PathPoint point;
  point.name = element.name();
  const FrameReference frame = context.frame_or_ground(element);
  point.body = frame.body;
  const std::string type = element.type();
  if (type == "PathPoint" || type == "ConditionalPathPoint" || type == "ViaPoint") {
    point.location = frame.placement * element.vector_or("location", Eigen::Vector3d::Zero());
    if (type == "PathPoint") return point;
    point.kind = PathPointKind::kConditional;
    std::string coordinate = socket(element, "coordinate");
    if (coordinate.empty()) coordinate = element.text_or("coordinate", "");
    point.coordinate = context.coordinate(element, "coordinate", coordinate);
    const std::vector<double> range = element.numbers("range");
    if (range.size() != 2) element.fail("range", fmt::format("{} numbers where two are expected", range.size()));
    point.low = std::min(range[0], range[1]);
    point.high = std::max(range[0], range[1]);
    return point;
  }
  if (type != "MovingPathPoint") element.fail(type, "path points of this kind are not understood");
  point.kind = PathPointKind::kMoving;
  constexpr std::array<const char*, 3> kCoordinate{"x_coordinate", "y_coordinate", "z_coordinate"};
  constexpr std::array<const char*, 3> kLocation{"x_location", "y_location", "z_location"};
  point.frame = frame.placement;
  for (std::size_t i = 0; i < 3; ++i) {
    const Element function = find_function(element, kLocation[i]);
    if (!function) element.fail(kLocation[i], "missing");
    point.moving_location[i] = read_function(function);
    if (point.moving_location[i].is_constant()) continue;
    std::string coordinate = socket(element, kCoordinate[i]);
    if (coordinate.empty()) coordinate = element.text_or(kCoordinate[i], "");
    point.moving_coordinate[i] = context.coordinate(element, kCoordinate[i], coordinate);
  }
  return point;
}

PathWrap read_path_wrap(Context& context, const Element& element, std::size_t points) {
  PathWrap wrap;
  const std::string name = element.text_or("wrap_object", "");
  wrap.object = -1;
  for (std::size_t i = 0; i < context.model.wrap_objects.size(); ++i) {
    if (context.model.wrap_objects[i].name == name) wrap.object = static_cast<int>(i);
  }
  if (wrap.object < 0) {
    std::vector<std::string> names;
    for (const WrapObject& w : context.model.wrap_objects) names.push_back(w.name);
    element.fail("wrap_object", fmt::format("there is no wrap object '{}'{}", name, suggestion(name, names, 8)));
  }
  const std::string method = element.text_or("method", "hybrid");
  if (method == "midpoint") {
    wrap.method = EllipsoidMethod::kMidpoint;
  } else if (method == "axial") {
    wrap.method = EllipsoidMethod::kAxial;
  } else if (method != "hybrid" && method != "Unassigned") {
    element.fail("method", fmt::format("'{}' is none of hybrid, midpoint, axial", method));
  }
  const std::vector<double> range = element.numbers("range");
  if (!range.empty() && range.size() != 2)
    element.fail("range", fmt::format("{} numbers where two are expected", range.size()));
  // 1-based and inclusive in the file, anything below 1 means "from the first" or "to the last".
  const auto index = [&](double value, int otherwise) {
    if (value < 1.0) return otherwise;
    if (value > static_cast<double>(points))
      element.fail("range", fmt::format("{} is beyond the {} points of the path", value, points));
    return static_cast<int>(value) - 1;
  };
  if (range.size() == 2) {
    wrap.first_point = index(range[0], 0);
    wrap.last_point = index(range[1], -1);
    if (wrap.last_point >= 0 && wrap.last_point <= wrap.first_point) {
      element.fail("range", fmt::format("{} to {} holds no two points", range[0], range[1]));
    }
  }
  return wrap;
}

/// What both forms of Thelen's muscle share.
template <typename Curves>
Curves read_thelen_shape(const Element& e) {
  Curves c;
  c.tendon_strain = e.positive_or("FmaxTendonStrain", c.tendon_strain);
  c.passive_strain = e.positive_or("FmaxMuscleStrain", c.passive_strain);
  c.active_width = e.positive_or("KshapeActive", c.active_width);
  c.passive_exponent = e.positive_or("KshapePassive", c.passive_exponent);
  c.Af = e.positive_or("Af", c.Af);
  c.Flen = e.positive_or("Flen", c.Flen);
  if (!(c.Flen > 1.0)) e.fail("Flen", fmt::format("{} must be > 1", c.Flen));
  return c;
}

ThelenCurves read_thelen(const Element& e) {
  auto c = read_thelen_shape<ThelenCurves>(e);
  c.extrapolation_threshold = e.positive_or("fv_linear_extrap_threshold", c.extrapolation_threshold);
  return c;
}

DeprecatedThelenCurves read_deprecated_thelen(const Element& e) {
  auto c = read_thelen_shape<DeprecatedThelenCurves>(e);
  c.damping = e.not_negative_or("damping", c.damping);
  c.Vmax0 = e.positive_or("Vmax0", c.Vmax0);
  return c;
}

MillardCurves read_millard(const Element& e) {
  MillardCurves c;
  if (const Element f = e.child("ActiveForceLengthCurve")) {
    c.min_norm_active_fiber_length = f.number_or("min_norm_active_fiber_length", c.min_norm_active_fiber_length);
    c.transition_norm_fiber_length = f.number_or("transition_norm_fiber_length", c.transition_norm_fiber_length);
    c.max_norm_active_fiber_length = f.number_or("max_norm_active_fiber_length", c.max_norm_active_fiber_length);
    c.shallow_ascending_slope = f.number_or("shallow_ascending_slope", c.shallow_ascending_slope);
    c.minimum_value = f.number_or("minimum_value", c.minimum_value);
    if (!(0.0 < c.min_norm_active_fiber_length && c.min_norm_active_fiber_length < c.transition_norm_fiber_length &&
          c.transition_norm_fiber_length < 1.0 && 1.0 < c.max_norm_active_fiber_length)) {
      f.fail("min_norm_active_fiber_length", "0 < minimum < transition < 1 < maximum is expected");
    }
  }
  if (const Element f = e.child("ForceVelocityCurve")) {
    c.concentric_slope_at_vmax = f.not_negative_or("concentric_slope_at_vmax", c.concentric_slope_at_vmax);
    c.concentric_slope_near_vmax = f.not_negative_or("concentric_slope_near_vmax", c.concentric_slope_near_vmax);
    c.isometric_slope = f.positive_or("isometric_slope", c.isometric_slope);
    c.eccentric_slope_at_vmax = f.not_negative_or("eccentric_slope_at_vmax", c.eccentric_slope_at_vmax);
    c.eccentric_slope_near_vmax = f.not_negative_or("eccentric_slope_near_vmax", c.eccentric_slope_near_vmax);
    c.max_eccentric_velocity_force_multiplier =
        f.positive_or("max_eccentric_velocity_force_multiplier", c.max_eccentric_velocity_force_multiplier);
    if (!(c.max_eccentric_velocity_force_multiplier > 1.0))
      f.fail("max_eccentric_velocity_force_multiplier", "must be > 1");
    c.concentric_curviness = f.not_negative_or("concentric_curviness", c.concentric_curviness);
    c.eccentric_curviness = f.not_negative_or("eccentric_curviness", c.eccentric_curviness);
  }
  if (const Element f = e.child("FiberForceLengthCurve")) {
    c.strain_at_zero_force = f.number_or("strain_at_zero_force", c.strain_at_zero_force);
    c.strain_at_one_norm_force = f.number_or("strain_at_one_norm_force", c.strain_at_one_norm_force);
    c.stiffness_at_low_force = f.number_or("stiffness_at_low_force", c.stiffness_at_low_force);
    c.stiffness_at_one_norm_force = f.number_or("stiffness_at_one_norm_force", c.stiffness_at_one_norm_force);
    c.fiber_curviness = f.number_or("curviness", c.fiber_curviness);
    if (!(c.strain_at_one_norm_force > c.strain_at_zero_force)) {
      f.fail("strain_at_one_norm_force", fmt::format("{} must be above strain_at_zero_force {}",
                                                     c.strain_at_one_norm_force, c.strain_at_zero_force));
    }
  }
  if (const Element f = e.child("TendonForceLengthCurve")) {
    c.tendon_strain_at_one_norm_force = f.positive_or("strain_at_one_norm_force", c.tendon_strain_at_one_norm_force);
    c.tendon_stiffness_at_one_norm_force =
        f.number_or("stiffness_at_one_norm_force", c.tendon_stiffness_at_one_norm_force);
    c.norm_force_at_toe_end = f.number_or("norm_force_at_toe_end", c.norm_force_at_toe_end);
    c.tendon_curviness = f.number_or("curviness", c.tendon_curviness);
  }
  return c;
}

DeGrooteFregly2016Curves read_degroote(const Element& e) {
  DeGrooteFregly2016Curves c;
  c.active_force_width_scale = e.positive_or("active_force_width_scale", c.active_force_width_scale);
  c.passive_fiber_strain_at_one_norm_force =
      e.positive_or("passive_fiber_strain_at_one_norm_force", c.passive_fiber_strain_at_one_norm_force);
  c.tendon_strain_at_one_norm_force =
      e.positive_or("tendon_strain_at_one_norm_force", c.tendon_strain_at_one_norm_force);
  c.ignore_passive_fiber_force = e.flag_or("ignore_passive_fiber_force", c.ignore_passive_fiber_force);
  c.activation_smoothing = e.positive_or("activation_dynamics_smoothing", c.activation_smoothing);
  return c;
}

/// Its time scale and activation factors, which OpenSim has in place of speeds and time constants.
SchutteCurves read_schutte(const Element& e, MusculotendonParameters<double>& m) {
  SchutteCurves c;
  c.damping = e.positive_or("damping", c.damping);
  if (const Element f = find_function(e, "tendon_force_length_curve")) c.tendon = read_function(f);
  if (const Element f = find_function(e, "active_force_length_curve")) c.active = read_function(f);
  if (const Element f = find_function(e, "passive_force_length_curve")) c.passive = read_function(f);
  const double time_scale = e.positive_or("time_scale", 0.1);
  const double faster = e.positive_or("activation1", 7.667), slow = e.positive_or("activation2", 1.459854);
  m.max_contraction_velocity = 1.0 / time_scale;
  m.activation_time_constant = time_scale / (faster + slow);
  m.deactivation_time_constant = time_scale / slow;
  return c;
}

void read_coordinate_actuator(Context& context, const Element& e) {
  CoordinateActuator a;
  a.name = e.name();
  std::string coordinate = socket(e, "coordinate");
  if (coordinate.empty()) coordinate = e.text_or("coordinate", "");
  a.coordinate = context.coordinate(e, "coordinate", coordinate);
  a.optimal_force = e.number_or("optimal_force", 1.0);
  // "-inf" and "inf" stand for no bound.
  const auto bound = [&](const char* name, double otherwise) {
    const std::string text = e.text_or(name, "");
    if (text.empty() || text.find("nf") != std::string::npos) return otherwise;
    return e.number_or(name, otherwise);
  };
  a.min_control = bound("min_control", a.min_control);
  a.max_control = bound("max_control", a.max_control);
  context.model.actuators.push_back(std::move(a));
}

}  // namespace

void read_path(Context& context, const Element& element, std::vector<PathPoint>& points, std::vector<PathWrap>& wraps,
               std::optional<PathFunction>& function) {
  function = read_path_function(context, element);
  if (function) return;
  Element path = element.child("GeometryPath");
  if (!path) path = Element(context.document, element.property("path").child("GeometryPath"));
  if (!path) {
    for (const pugi::xml_node node : element.node().children()) {
      if (std::string_view(node.name()).find("Path") != std::string_view::npos) {
        element.fail(node.name(), "paths of this kind are not understood");
      }
    }
    element.fail("GeometryPath", "missing");
  }
  for (const Element& point : path.objects("PathPointSet")) points.push_back(read_point(context, point));
  if (points.size() < 2) element.fail("PathPointSet", fmt::format("{} points; a path has at least two", points.size()));
  // A path begins and ends with the first and the last point that are there.
  const auto always = std::count_if(points.begin(), points.end(),
                                    [](const PathPoint& p) { return p.kind != PathPointKind::kConditional; });
  if (always < 2)
    element.fail("PathPointSet",
                 fmt::format("{} of {} points are not conditional; at least two must be", always, points.size()));
  for (const Element& wrap : path.objects("PathWrapSet")) {
    wraps.push_back(read_path_wrap(context, wrap, points.size()));
  }
}

bool is_schutte(std::string_view type) { return type == "Schutte1993Muscle_Deprecated" || type == "Schutte1993Muscle"; }

bool is_muscle(std::string_view type) {
  return type == "Thelen2003Muscle" || type == "Thelen2003Muscle_Deprecated" ||
         type == "Millard2012EquilibriumMuscle" || type == "DeGrooteFregly2016Muscle" || is_schutte(type);
}

void read_muscle(Context& context, const Element& e) {
  Muscle muscle;
  MuscleParameters& p = muscle.parameters;
  p.name = e.name();
  if (p.name.empty()) e.fail("name", "a muscle needs a name");
  if (context.model.muscle(p.name) >= 0) e.fail("name", "a second muscle of this name");
  muscle.enabled = e.flag_or("appliesForce", !e.flag_or("isDisabled", false));
  MusculotendonParameters<double>& m = p.musculotendon;
  m.max_isometric_force = e.positive_or("max_isometric_force", 1000.0);
  m.optimal_fiber_length = e.positive_or("optimal_fiber_length", 0.1);
  m.tendon_slack_length = e.not_negative_or("tendon_slack_length", 0.2);
  m.pennation_angle_at_optimal =
      e.not_negative_or("pennation_angle_at_optimal", e.not_negative_or("pennation_angle", 0.0));
  if (m.pennation_angle_at_optimal >= kPi / 2.0) {
    e.fail("pennation_angle_at_optimal", fmt::format("{} rad must be below pi/2", m.pennation_angle_at_optimal));
  }
  m.max_contraction_velocity = e.positive_or("max_contraction_velocity", e.positive_or("Vmax", 10.0));
  const std::string type = e.type();
  if (type == "Thelen2003Muscle") {
    p.curves = read_thelen(e);
    m.activation_time_constant = 0.015;
    m.deactivation_time_constant = 0.050;
  } else if (type == "Thelen2003Muscle_Deprecated") {
    p.curves = read_deprecated_thelen(e);
    m.activation_time_constant = 0.010;
    m.deactivation_time_constant = 0.040;
  } else if (type == "Millard2012EquilibriumMuscle") {
    p.curves = read_millard(e);
    m.activation_time_constant = 0.010;
    m.deactivation_time_constant = 0.040;
    p.fiber_damping = e.not_negative_or("fiber_damping", 0.1);
  } else if (is_schutte(type)) {
    p.curves = read_schutte(e, m);
  } else {
    p.curves = read_degroote(e);
    m.activation_time_constant = 0.015;
    m.deactivation_time_constant = 0.060;
    p.fiber_damping = e.not_negative_or("fiber_damping", 0.0);
    p.minimum_activation = 0.0;
  }
  if (!is_schutte(type)) {
    m.activation_time_constant = e.positive_or("activation_time_constant", m.activation_time_constant);
    m.deactivation_time_constant = e.positive_or("deactivation_time_constant", m.deactivation_time_constant);
  }
  p.minimum_activation = e.not_negative_or("minimum_activation", p.minimum_activation);
  p.maximum_pennation_angle = e.positive_or("maximum_pennation_angle", p.maximum_pennation_angle);
  p.default_activation = e.not_negative_or("default_activation", p.default_activation);
  p.default_fiber_length = e.positive_or("default_fiber_length", p.default_fiber_length);
  p.min_control = e.number_or("min_control", p.min_control);
  p.max_control = e.number_or("max_control", p.max_control);
  if (p.min_control > p.max_control)
    e.fail("min_control", fmt::format("{} is above max_control {}", p.min_control, p.max_control));
  p.rigid_tendon = e.flag_or("ignore_tendon_compliance", false);
  p.ignore_activation_dynamics = e.flag_or("ignore_activation_dynamics", false);
  if (m.tendon_slack_length == 0.0 && !p.rigid_tendon) {
    e.fail("tendon_slack_length", "0 needs a rigid tendon (ignore_tendon_compliance)");
  }
  read_path(context, e, muscle.points, muscle.wraps, muscle.function);
  context.model.muscles.push_back(std::move(muscle));
}

void read_forces(Context& context) {
  for (const Element& element : context.members(PartOf::kForceSet)) {
    const std::string type = element.type();
    const bool on = element.flag_or("appliesForce", !element.flag_or("isDisabled", false));
    if (is_muscle(type)) {
      read_muscle(context, element);
    } else if (type == "CoordinateActuator" || type == "ActivationCoordinateActuator") {
      if (on) read_coordinate_actuator(context, element);
    } else if (type == "PathActuator" || type == "PointActuator" || type == "TorqueActuator" ||
               type == "BodyActuator" || type == "PointToPointActuator") {
      // As those on coordinates: no force unless something controls it, which is nothing here.
      if (on) context.unsupported(element, false);
    } else if (!on || !read_passive_force(context, element)) {
      context.unsupported(element, on);
    }
  }
}

}  // namespace veridyn::muscle::osim
