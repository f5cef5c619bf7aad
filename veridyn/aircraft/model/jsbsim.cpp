#include "veridyn/aircraft/model/jsbsim.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <initializer_list>
#include <pugixml.hpp>
#include <sstream>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kFoot = 0.3048;                               // m
constexpr double kPound = 4.4482216152605;                     // N
const double kSlugPerCubicFoot = kPound / std::pow(kFoot, 4);  // kg/m^3: 1 slug = 1 lbf s^2/ft

/// The children of an operation, composed by value: JSBSim's functions are trees.
struct Expression {
  std::string element;
  std::string text = {};
  std::vector<Expression> arguments = {};
};

Expression value(double number) { return {"value", fmt::format("{:.17g}", number), {}}; }
Expression property(std::string name) { return {"property", std::move(name), {}}; }
Expression operation(const char* name, std::vector<Expression> arguments) { return {name, {}, std::move(arguments)}; }
// JSBSim warns of a product of one factor.
Expression product(std::vector<Expression> a) {
  return a.size() == 1 ? std::move(a.front()) : operation("product", std::move(a));
}
Expression sum(std::vector<Expression> a) { return operation("sum", std::move(a)); }
Expression difference(Expression a, Expression b) { return operation("difference", {std::move(a), std::move(b)}); }
Expression quotient(Expression a, Expression b) { return operation("quotient", {std::move(a), std::move(b)}); }
Expression power(Expression a, int n) { return n == 1 ? a : operation("pow", {std::move(a), value(n)}); }

void append(pugi::xml_node parent, const Expression& expression) {
  pugi::xml_node node = parent.append_child(expression.element.c_str());
  if (!expression.text.empty()) node.text().set(expression.text.c_str());
  for (const Expression& argument : expression.arguments) append(node, argument);
}

void function(pugi::xml_node parent, const std::string& name, const std::string& description, const Expression& body) {
  pugi::xml_node node = parent.append_child("function");
  node.append_attribute("name") = name.c_str();
  if (!description.empty()) node.append_child("description").text().set(description.c_str());
  append(node, body);
}

void measure(pugi::xml_node parent, const char* name, double number, const char* unit) {
  pugi::xml_node node = parent.append_child(name);
  node.append_attribute("unit") = unit;
  node.text().set(fmt::format("{:.17g}", number).c_str());
}

void xyz(pugi::xml_node node, const std::array<double, 3>& components) {
  constexpr const char* names[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    node.append_child(names[i]).text().set(fmt::format("{:.17g}", components[i] + 0.0).c_str());
  }
}

/// A point of body axes in the structural frame: x aft, z up.
void location(pugi::xml_node parent, const char* name, const std::array<double, 3>& body) {
  pugi::xml_node node = parent.append_child("location");
  if (name != nullptr) node.append_attribute("name") = name;
  node.append_attribute("unit") = "M";
  xyz(node, {0.0 - body[0], body[1], 0.0 - body[2]});
}

// ------------------------------------------------------------------------------------------------- aerodynamics

Expression variable(AeroVariable v) {
  switch (v) {
    case AeroVariable::kAlpha:
      return property("aero/alpha-rad");
    case AeroVariable::kBeta:
      return property("aero/beta-rad");
    case AeroVariable::kPn:
      return property("aero/function/p_n");
    case AeroVariable::kQn:
      return property("aero/function/q_n");
    case AeroVariable::kRn:
      return property("aero/function/r_n");
    case AeroVariable::kDe:
      return property("fcs/elevator-pos-rad");
    case AeroVariable::kDa:
      return property("fcs/left-aileron-pos-rad");
    case AeroVariable::kDr:
      return property("fcs/rudder-pos-rad");
    case AeroVariable::kCT:
      return property("aero/function/CT");
    case AeroVariable::kVa:
      break;
  }
  return product({property("velocities/vt-fps"), value(kFoot)});
}

Expression factor(const Factor& f) {
  const Expression x = variable(f.variable);
  switch (f.kind) {
    case Factor::Kind::kPower:
      break;
    case Factor::Kind::kAbsolute:
      return power(operation("abs", {x}), f.power);
    case Factor::Kind::kSpline:
      // 0^0 is 1 in pow(), but the step is 0 at its knot.
      if (f.power == 0) return operation("gt", {x, value(f.knot)});
      return power(operation("max", {difference(x, value(f.knot)), value(0.0)}), f.power);
  }
  return power(x, f.power);
}

std::string coefficient_property(std::string_view name) { return fmt::format("aero/coefficient/{}", name); }

/// 1 / (1 + e^-x); JSBSim's numbers overflow to infinity, whose reciprocal is the right 0.
Expression logistic_of(Expression x) {
  return quotient(value(1.0), sum({value(1.0), operation("exp", {product({value(-1.0), std::move(x)})})}));
}

Expression flat_plate(Coefficient c) {
  const Expression s = operation("sin", {property("aero/alpha-rad")});
  if (c == Coefficient::kCD) return product({value(2.0), s, s});
  return product({value(2.0), s, operation("abs", {s}), operation("cos", {property("aero/alpha-rad")})});
}

/// What the stall blend takes over: CL_0 + CL_alpha alpha, or the whole sum.
Expression blended_part(const CoefficientModel& model, bool whole) {
  std::vector<Expression> parts;
  for (const Term& term : model.terms) {
    const bool affine = term.factors.empty() || (term.factors.size() == 1 && term.factors[0] == Factor{});
    if (whole || affine) parts.push_back(property(coefficient_property(parameter_name(model.coefficient, term))));
  }
  return parts.empty() ? value(0.0) : sum(std::move(parts));
}

void write_stall(pugi::xml_node aero, const StallBlend& stall) {
  const Expression alpha = property("aero/alpha-rad");
  function(aero, "aero/function/upper-stall", "share of separated flow beyond +alpha0",
           logistic_of(product({value(stall.M), difference(alpha, value(stall.alpha0))})));
  function(aero, "aero/function/lower-stall", "share of separated flow beyond -alpha0",
           logistic_of(product({value(-stall.M), sum({alpha, value(stall.alpha0)})})));
  const Expression a = property("aero/function/upper-stall"), b = property("aero/function/lower-stall");
  function(aero, "aero/function/separated-share", "share of separated flow", difference(sum({a, b}), product({a, b})));
  if (stall.form == StallForm::kSeparation) {
    function(aero, "aero/function/attached-lift-share", "((1 + sqrt(1 - s)) / 2)^2",
             power(product({value(0.5), sum({value(1.0), operation("pow", {product({difference(value(1.0), a),
                                                                                    difference(value(1.0), b)}),
                                                                           value(0.5)})})}),
                   2));
  }
}

Expression with_stall(const CoefficientModel& model, const std::optional<StallBlend>& stall) {
  Expression whole = blended_part(model, true);
  const Coefficient c = model.coefficient;
  if (!stall || (c != Coefficient::kCL && (c != Coefficient::kCD || !stall->drag))) return whole;
  if (stall->form == StallForm::kSeparation) {
    if (c == Coefficient::kCD) return whole;
    return sum({whole, product({difference(property("aero/function/attached-lift-share"), value(1.0)),
                                blended_part(model, false)})});
  }
  const Expression blended = blended_part(model, stall->form == StallForm::kFull);
  return sum({whole, product({property("aero/function/separated-share"), difference(flat_plate(c), blended)})});
}

/// b p / (2 Va) with Va not below 0.1 m/s, as in `aero_loads`.
Expression normalised_rate(const Expression& length, const char* rate) {
  return quotient(product({length, property(rate)}),
                  product({value(2.0), operation("max", {property("velocities/vt-fps"), value(0.1 / kFoot)})}));
}

/// What makes moments and rates dimensionless [ft].
struct MomentLengths {
  Expression roll, pitch, yaw;
};

/// Span and chord of the file's metrics, or the subject's own reference lengths.
MomentLengths moment_lengths(const Subject& s) {
  const auto length = [](const std::optional<double>& own, const char* metric) {
    return own ? value(*own / kFoot) : property(metric);
  };
  return {.roll = length(s.lengths.roll, "metrics/bw-ft"),
          .pitch = length(s.lengths.pitch, "metrics/cbarw-ft"),
          .yaw = length(s.lengths.yaw, "metrics/bw-ft")};
}

void write_aerodynamics(pugi::xml_node root, const Subject& s, const Expression& thrust_lbs,
                        const std::map<std::string, std::string>& origins) {
  pugi::xml_node aero = root.append_child("aerodynamics");
  const MomentLengths length = moment_lengths(s);
  function(aero, "aero/function/p_n", "b p / (2 Va)", normalised_rate(length.roll, "velocities/p-aero-rad_sec"));
  function(aero, "aero/function/q_n", "c q / (2 Va)", normalised_rate(length.pitch, "velocities/q-aero-rad_sec"));
  function(aero, "aero/function/r_n", "b r / (2 Va)", normalised_rate(length.yaw, "velocities/r-aero-rad_sec"));
  function(aero, "aero/function/thrust-lbs", "along body x", thrust_lbs);
  const Expression slow_Va = operation("max", {property("velocities/vt-fps"), value(0.1 / kFoot)});
  function(aero, "aero/function/CT", "thrust / (qbar S)",
           quotient(property("aero/function/thrust-lbs"), product({value(0.5), property("atmosphere/rho-slugs_ft3"),
                                                                   property("metrics/Sw-sqft"), slow_Va, slow_Va})));
  if (s.model.stall) write_stall(aero, *s.model.stall);
  for (const auto& model : s.model.coefficients) {
    if (!model) continue;
    for (std::size_t i = 0; i < model->size(); ++i) {
      const Term& term = model->terms[i];
      std::vector<Expression> factors = {value(model->values[i])};
      for (const Factor& f : term.factors) factors.push_back(factor(f));
      const std::string name = parameter_name(model->coefficient, term);
      const auto origin = origins.find(name);
      function(aero, coefficient_property(name), origin == origins.end() ? "" : origin->second,
               product(std::move(factors)));
    }
    function(aero, coefficient_property(name_of(model->coefficient)), "", with_stall(*model, s.model.stall));
  }

  const Expression qS = product({property("aero/qbar-psf"), property("metrics/Sw-sqft")});
  const auto coefficient = [&](Coefficient c) {
    return s.model.find(c) != nullptr ? property(coefficient_property(name_of(c))) : value(0.0);
  };
  const Expression sa = operation("sin", {property("aero/alpha-rad")});
  const Expression ca = operation("cos", {property("aero/alpha-rad")});
  const Expression CL = coefficient(Coefficient::kCL), CD = coefficient(Coefficient::kCD);
  const auto axis = [&](const char* name, const char* description, const Expression& body) {
    pugi::xml_node node = aero.append_child("axis");
    node.append_attribute("name") = name;
    function(node, fmt::format("aero/load/{}", name), description, body);
  };
  axis("X", "qbar S (CL sin alpha - CD cos alpha)", product({qS, difference(product({CL, sa}), product({CD, ca}))}));
  axis("Y", "qbar S CY", product({qS, coefficient(Coefficient::kCY)}));
  axis("Z", "-qbar S (CD sin alpha + CL cos alpha)",
       product({value(-1.0), qS, sum({product({CD, sa}), product({CL, ca})})}));
  axis("ROLL", "qbar S b Cl", product({qS, length.roll, coefficient(Coefficient::kCl)}));
  axis("PITCH", "qbar S c Cm", product({qS, length.pitch, coefficient(Coefficient::kCm)}));
  axis("YAW", "qbar S b Cn", product({qS, length.yaw, coefficient(Coefficient::kCn)}));
}

// --------------------------------------------------------------------------------------------------- propulsion

struct ThrustFunctions {
  Expression thrust_lbs = value(0.0);
  Expression torque_lbsft = value(0.0);
};

Expression polynomial_in(const std::vector<double>& coefficients, const Expression& x) {
  std::vector<Expression> parts = {value(coefficients.empty() ? 0.0 : coefficients[0])};
  for (std::size_t i = 1; i < coefficients.size(); ++i)
    parts.push_back(product({value(coefficients[i]), power(x, static_cast<int>(i))}));
  return sum(std::move(parts));
}

ThrustFunctions thrust_functions(const Propulsion& p) {
  const Expression throttle = property("fcs/throttle-pos-norm");
  const Expression speed = product({property("velocities/u-aero-fps"), value(kFoot)});
  const Expression rho = product({property("atmosphere/rho-slugs_ft3"), value(kSlugPerCubicFoot)});
  const double per_pound = 1.0 / kPound, per_pound_foot = 1.0 / (kPound * kFoot);
  ThrustFunctions out;
  switch (p.kind) {
    case PropulsionKind::kNone:
      break;
    case PropulsionKind::kPolynomial: {
      std::vector<Expression> parts = {value(0.0)};
      for (const ThrustTerm& term : p.polynomial) {
        std::vector<Expression> factors = {value(term.value)};
        if (term.throttle_power > 0) factors.push_back(power(throttle, term.throttle_power));
        if (term.airspeed_power > 0) factors.push_back(power(speed, term.airspeed_power));
        parts.push_back(product(std::move(factors)));
      }
      out.thrust_lbs = product({value(per_pound), operation("max", {value(0.0), sum(std::move(parts))})});
      break;
    }
    case PropulsionKind::kMomentum: {
      const Expression exit = product({value(p.k_motor), throttle});
      out.thrust_lbs = product({value(0.5 * p.S_prop * p.C_prop * per_pound), rho,
                                operation("max", {value(0.0), difference(power(exit, 2), power(speed, 2))})});
      out.torque_lbsft = product({value(-p.k_tp * p.k_omega * p.k_omega * per_pound_foot), power(throttle, 2)});
      break;
    }
    case PropulsionKind::kPropeller: {
      const Expression n = property("aero/function/rotor-revolutions-per-second");
      const Expression J = property("aero/function/advance-ratio");
      const Expression turning = operation("gt", {n, value(1e-6)});
      const double D2 = p.diameter * p.diameter;
      out.thrust_lbs = product({turning, value(D2 * D2 * per_pound), rho, power(n, 2), polynomial_in(p.CT, J)});
      out.torque_lbsft = product({turning, value(-p.rotation * D2 * D2 * p.diameter / (2.0 * kPi) * per_pound_foot),
                                  rho, power(n, 2), polynomial_in(p.CP, J)});
      break;
    }
  }
  return out;
}

/// An engine without power, so that JSBSim has a throttle: thrust is an external reaction to it.
void write_engine(pugi::xml_node root, const Propulsion& p) {
  pugi::xml_node engine = root.append_child("propulsion").append_child("engine");
  engine.append_attribute("name") = "throttle";
  pugi::xml_node motor = engine.append_child("electric_engine");
  motor.append_attribute("name") = "throttle";
  measure(motor, "power", 0.0, "WATTS");
  pugi::xml_node thruster = engine.append_child("thruster");
  thruster.append_attribute("name") = "none";
  location(thruster, nullptr, p.position);
  pugi::xml_node orient = thruster.append_child("orient");
  orient.append_attribute("unit") = "DEG";
  for (const char* angle : {"roll", "pitch", "yaw"}) orient.append_child(angle).text().set("0");
  thruster.append_child("direct").append_attribute("name") = "none";
}

void write_external_reactions(pugi::xml_node root, const Propulsion& p, const ThrustFunctions& functions) {
  pugi::xml_node reactions = root.append_child("external_reactions");
  if (p.kind == PropulsionKind::kPropeller) {
    const Expression n = property("aero/function/rotor-revolutions-per-second");
    function(reactions, "aero/function/rotor-revolutions-per-second", "behind the rotor's lag",
             product({value(p.omega_max / (2.0 * kPi)), property("fcs/rotor-speed-norm")}));
    function(
        reactions, "aero/function/advance-ratio", "J = Va / (n D), within the propeller's map",
        operation("min", {value(p.J_max), quotient(product({property("velocities/u-aero-fps"), value(kFoot)}),
                                                   product({operation("max", {n, value(1e-6)}), value(p.diameter)}))}));
  }
  pugi::xml_node force = reactions.append_child("force");
  force.append_attribute("name") = "thrust";
  force.append_attribute("frame") = "BODY";
  append(force.append_child("function"), property("aero/function/thrust-lbs"));
  location(force, nullptr, p.position);
  xyz(force.append_child("direction"), {1.0, 0.0, 0.0});
  pugi::xml_node moment = reactions.append_child("moment");
  moment.append_attribute("name") = "rotor-torque";
  moment.append_attribute("frame") = "BODY";
  append(moment.append_child("function"), functions.torque_lbsft);
  xyz(moment.append_child("direction"), {1.0, 0.0, 0.0});
}

// ----------------------------------------------------------------------------------------------- flight control

struct SurfaceNames {
  std::string name, trim, output;
};

void write_surface(pugi::xml_node control, const SurfaceNames& names, const Actuator& a) {
  const std::string& name = names.name;
  pugi::xml_node channel = control.append_child("channel");
  channel.append_attribute("name") = name.c_str();
  pugi::xml_node command = channel.append_child("summer");
  command.append_attribute("name") = fmt::format("fcs/{}-and-trim-cmd-norm", name).c_str();
  command.append_child("input").text().set(fmt::format("fcs/{}-cmd-norm", name).c_str());
  command.append_child("input").text().set(names.trim.c_str());
  pugi::xml_node full = command.append_child("clipto");
  full.append_child("min").text().set("-1");
  full.append_child("max").text().set("1");
  pugi::xml_node scale = channel.append_child("aerosurface_scale");
  scale.append_attribute("name") = fmt::format("fcs/{}-command-rad", name).c_str();
  scale.append_child("input").text().set(fmt::format("fcs/{}-and-trim-cmd-norm", name).c_str());
  pugi::xml_node range = scale.append_child("range");
  range.append_child("min").text().set(fmt::format("{:.17g}", a.lower).c_str());
  range.append_child("max").text().set(fmt::format("{:.17g}", a.upper).c_str());
  pugi::xml_node actuator = channel.append_child("actuator");
  actuator.append_attribute("name") = fmt::format("fcs/{}-actuator", name).c_str();
  actuator.append_child("input").text().set(fmt::format("fcs/{}-command-rad", name).c_str());
  if (a.time_constant > 0.0)
    actuator.append_child("lag").text().set(fmt::format("{:.17g}", 1.0 / a.time_constant).c_str());
  if (std::isfinite(a.rate_limit))
    actuator.append_child("rate_limit").text().set(fmt::format("{:.17g}", a.rate_limit).c_str());
  if (a.delay > 0.0) {
    pugi::xml_node delay = actuator.append_child("delay");
    delay.append_attribute("type") = "time";
    delay.text().set(fmt::format("{:.17g}", a.delay).c_str());
  }
  pugi::xml_node clip = actuator.append_child("clipto");
  clip.append_child("min").text().set(fmt::format("{:.17g}", a.lower).c_str());
  clip.append_child("max").text().set(fmt::format("{:.17g}", a.upper).c_str());
  actuator.append_child("output").text().set(names.output.c_str());
}

void write_flight_control(pugi::xml_node root, const Subject& s) {
  pugi::xml_node control = root.append_child("flight_control");
  control.append_attribute("name") = "surfaces and throttle";
  write_surface(control, {"elevator", "fcs/pitch-trim-cmd-norm", "fcs/elevator-pos-rad"}, s.elevator);
  write_surface(control, {"aileron", "fcs/roll-trim-cmd-norm", "fcs/left-aileron-pos-rad"}, s.aileron);
  write_surface(control, {"rudder", "fcs/yaw-trim-cmd-norm", "fcs/rudder-pos-rad"}, s.rudder);
  if (s.propulsion.kind == PropulsionKind::kPropeller) {
    pugi::xml_node channel = control.append_child("channel");
    channel.append_attribute("name") = "rotor";
    pugi::xml_node lag = channel.append_child("lag_filter");
    lag.append_attribute("name") = "fcs/rotor-speed-norm";
    lag.append_child("input").text().set("fcs/throttle-pos-norm");
    lag.append_child("c1").text().set(fmt::format("{:.17g}", 1.0 / std::max(1e-3, s.propulsion.time_constant)).c_str());
  }
}

// ------------------------------------------------------------------------------------------------------ the body

void write_body(pugi::xml_node root, const Subject& s) {
  pugi::xml_node metrics = root.append_child("metrics");
  measure(metrics, "wingarea", s.wing_area, "M2");
  measure(metrics, "wingspan", s.span, "M");
  measure(metrics, "chord", s.chord, "M");
  location(metrics, "AERORP", s.force_point);
  location(metrics, "EYEPOINT", {0.0, 0.0, 0.0});
  location(metrics, "VRP", {0.0, 0.0, 0.0});

  pugi::xml_node mass = root.append_child("mass_balance");
  measure(mass, "ixx", s.inertia->Jx, "KG*M2");
  measure(mass, "iyy", s.inertia->Jy, "KG*M2");
  measure(mass, "izz", s.inertia->Jz, "KG*M2");
  measure(mass, "ixz", 0.0 - s.inertia->Jxz, "KG*M2");
  measure(mass, "emptywt", s.mass, "KG");
  location(mass, "CG", {0.0, 0.0, 0.0});

  pugi::xml_node ground = root.append_child("ground_reactions");
  const double half = 0.5 * s.span, weight = s.mass * kGravity;
  const std::pair<const char*, std::array<double, 3>> points[] = {{"nose", {0.3 * s.span, 0.0, 0.1 * s.span}},
                                                                  {"tail", {-0.4 * s.span, 0.0, 0.05 * s.span}},
                                                                  {"left tip", {0.0, -half, 0.0}},
                                                                  {"right tip", {0.0, half, 0.0}}};
  for (const auto& [name, point] : points) {
    pugi::xml_node contact = ground.append_child("contact");
    contact.append_attribute("type") = "STRUCTURE";
    contact.append_attribute("name") = name;
    location(contact, nullptr, point);
    contact.append_child("static_friction").text().set("0.8");
    contact.append_child("dynamic_friction").text().set("0.5");
    // Two centimetres under the whole weight, and a damping of a half of critical.
    measure(contact, "spring_coeff", weight / 0.02, "N/M");
    measure(contact, "damping_coeff", std::sqrt(weight / 0.02 * s.mass), "N/M/SEC");
  }
}

}  // namespace

std::string write_jsbsim(const Subject& s, const JsbsimNotes& notes) {
  if (const std::vector<std::string> unknown = s.model.unknown_parameters(); !unknown.empty()) {
    throw InputError(s.name,
                     fmt::format("JSBSim needs every parameter, these have no value: {}", fmt::join(unknown, ", ")));
  }
  if (!s.inertia) throw InputError(s.name, "JSBSim needs the inertia: subject.inertia is missing");
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("fdm_config");
  root.append_attribute("name") = s.name.c_str();
  root.append_attribute("version") = "2.0";
  root.append_attribute("release") = "ALPHA";
  pugi::xml_node header = root.append_child("fileheader");
  header.append_child("author").text().set("Veridyn");
  header.append_child("description").text().set(s.description.empty() ? s.name.c_str() : s.description.c_str());
  header.append_child("note").text().set(
      fmt::format("Deflections: {}. Throttle: fcs/throttle-cmd-norm, 0 to 1.",
                  s.sign_convention.empty() ? "sign convention not stated" : s.sign_convention)
          .c_str());
  for (const std::string& note : notes.header) header.append_child("note").text().set(note.c_str());
  write_body(root, s);
  const ThrustFunctions thrust = thrust_functions(s.propulsion);
  write_external_reactions(root, s.propulsion, thrust);
  write_engine(root, s.propulsion);
  write_flight_control(root, s);
  write_aerodynamics(root, s, thrust.thrust_lbs, notes.parameters);
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace veridyn::aircraft
