#include "veridyn/aircraft/model/builtin_subjects.hpp"

#include <fmt/format.h>

#include <array>
#include <initializer_list>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {

namespace {

using Terms = std::initializer_list<std::pair<std::string_view, double>>;

constexpr std::string_view kPositiveMoments =
    "positive deflection gives positive moment (Cm_de > 0, Cl_da > 0, Cn_dr > 0, CY_dr < 0), as in last_letter";

void set(Subject& s, Coefficient c, Terms terms) {
  s.model.set(coefficient_model(c, std::span(terms.begin(), terms.size())));
}

void set_lateral(Subject& s, Coefficient c, const std::array<double, 6>& v) {
  set(s, c, {{"1", v[0]}, {"beta", v[1]}, {"p_n", v[2]}, {"r_n", v[3]}, {"da", v[4]}, {"dr", v[5]}});
}

void set_stops(Subject& s, double aileron, double elevator, double rudder) {
  s.aileron.lower = -(s.aileron.upper = aileron);
  s.elevator.lower = -(s.elevator.upper = elevator);
  s.rudder.lower = -(s.rudder.upper = rudder);
}

void set_servos(Subject& s, double time_constant, double rate_limit) {
  for (Actuator* a : {&s.aileron, &s.elevator, &s.rudder}) {
    a->time_constant = time_constant;
    a->rate_limit = rate_limit;
  }
}

/// Drag of last_letter's type 1, CDp + (CL0 + CLa alpha - CL_min)^2 / (pi e AR), written as a polynomial in alpha.
void set_drag_parabola(Subject& s, double CDp, double CL0, double CLa, double oswald, double CL_min = 0.0) {
  const double k = 1.0 / (kPi * oswald * s.aspect_ratio());
  const double c = CL0 - CL_min;
  set(s, Coefficient::kCD, {{"1", CDp + k * c * c}, {"alpha", 2.0 * k * c * CLa}, {"alpha^2", k * CLa * CLa}});
}

Propulsion momentum(double S_prop, double C_prop, double k_motor, double k_omega, double x) {
  Propulsion p;
  p.kind = PropulsionKind::kMomentum;
  p.S_prop = S_prop;
  p.C_prop = C_prop;
  p.k_motor = k_motor;
  p.k_omega = k_omega;
  p.position = {x, 0.0, 0.0};
  return p;
}

Propulsion linear_thrust(double full_throttle_N, double loss_N_s_per_m) {
  Propulsion p;
  p.kind = PropulsionKind::kPolynomial;
  p.polynomial = {{1, 0, full_throttle_N}, {1, 1, -loss_N_s_per_m}};
  return p;
}

Subject unatrap() {
  Subject s;
  s.description =
      "UnATRaP of NTUA: masses, geometry and force coefficients as identified in the thesis, roll and yaw moments of "
      "the thesis's simulations. Ours, because the thesis does not print them: inertia (the Aerosonde's, of nearly the "
      "same mass and span), pitching moment (the Skywalker's), thrust, stops, servos and stall angle";
  s.sign_convention = kPositiveMoments;
  s.mass = 12.6;
  s.inertia = Inertia{0.8244, 1.135, 1.759, 0.1204};
  s.wing_area = 0.92;
  s.span = 2.72;
  s.chord = 0.34;
  set(s, Coefficient::kCL, {{"1", 0.2933}, {"alpha", 3.6070}, {"q_n", 2.3550}, {"de", 0.0711}});
  set(s, Coefficient::kCD,
      {{"1", 0.1268}, {"alpha", 0.1268}, {"alpha^2", 1.9081}, {"q_n", 0.2904}, {"de", 0.0068}, {"CT", 0.0152}});
  set_lateral(s, Coefficient::kCY, {0.00312, -0.6696, 0.1055, 0.5134, 0.0032, -0.1257});
  set_lateral(s, Coefficient::kCl, {0.0, -0.12, -1.0, 0.14, 0.25, -0.0037});
  set(s, Coefficient::kCm, {{"1", 0.045}, {"alpha", -0.7}, {"q_n", -20.0}, {"de", 1.0}});
  set_lateral(s, Coefficient::kCn, {0.0, 0.25, 0.022, -1.0, 0.0, 0.10});
  s.model.stall = StallBlend{.M = 50.0, .alpha0 = 20.0 * kDegree, .form = StallForm::kFull, .drag = true};
  s.propulsion = linear_thrust(110.0, 1.2);
  set_stops(s, 20.0 * kDegree, 20.0 * kDegree, 20.0 * kDegree);
  set_servos(s, 0.05, 400.0 * kDegree);
  return s;
}

/// Moments and side force that last_letter's skywalker, its variant and its aerosonde share in structure.
void set_last_letter_lateral(Subject& s, const std::array<double, 6>& CY, const std::array<double, 6>& Cl,
                             const std::array<double, 6>& Cn) {
  set_lateral(s, Coefficient::kCY, CY);
  set_lateral(s, Coefficient::kCl, Cl);
  set_lateral(s, Coefficient::kCn, Cn);
}

Subject skywalker_2013() {
  Subject s;
  s.description =
      "last_letter skywalker_2013 (numbers of the simulator's author; pitch damping, lift slope and Cn_r are "
      "empirical). Engine torque is zero in the source";
  s.sign_convention = kPositiveMoments;
  s.mass = 2.0;
  s.inertia = Inertia{0.8244, 1.135, 1.759, 0.1204};
  s.wing_area = 0.45;
  s.span = 1.88;
  s.chord = 0.24;
  s.force_point = {-0.02, 0.0, -0.05};
  set(s, Coefficient::kCL, {{"1", 0.56}, {"alpha", 6.9}, {"q_n", 0.0}, {"de", 0.0}});
  set_drag_parabola(s, 0.1, 0.56, 6.9, 0.9);
  set_last_letter_lateral(s, {0, -0.98, 0, 0, 0, -0.2}, {0, -0.12, -1.0, 0.14, 0.25, -0.037},
                          {0, 0.25, 0.022, -1.0, 0, 0.1});
  set(s, Coefficient::kCm, {{"1", 0.045}, {"alpha", -0.7}, {"q_n", -20.0}, {"de", 1.0}});
  s.model.stall = StallBlend{.M = 50.0, .alpha0 = 0.4712, .form = StallForm::kSource, .drag = false};
  s.propulsion = momentum(1.0, 0.33, 30.0, 0.0, -0.25);
  set_stops(s, 0.3491, 0.3491, 0.3491);
  return s;
}

Subject skywalker_2013_mod() {
  Subject s = skywalker_2013();
  s.description =
      "last_letter_lib skywalker_2013_mod: the skywalker with a softer lift curve, |alpha| drag and a propeller map. "
      "The source tilts the engine by -0.08 rad; here thrust is along body x. The rotor's lag is ours";
  s.force_point = {0.0, 0.0, 0.0};
  set(s, Coefficient::kCL, {{"1", 0.4}, {"alpha", 6.5}, {"q_n", 0.0}, {"de", 0.0}});
  set(s, Coefficient::kCD, {{"1", 0.09}, {"abs(alpha)", 0.14}});
  set(s, Coefficient::kCm, {{"1", 0.01}, {"alpha", -1.3}, {"q_n", -20.0}, {"de", 1.0}});
  Propulsion p;
  p.kind = PropulsionKind::kPropeller;
  p.position = {-0.25, 0.0, -0.13};
  p.omega_max = 1050.0;
  p.diameter = 0.28;
  p.J_max = 0.763;
  p.CT = {0.1133, -0.0740, -0.1849};
  p.CP = {0.0440, 0.0059, -0.0732};
  s.propulsion = p;
  return s;
}

Subject aerosonde() {
  Subject s;
  s.description =
      "last_letter aerosonde: drag of type 1 with CDp 0.0437; the inertia is a copy of the skywalker's, as in the "
      "source. k_omega without torque (k_tp is zero in the source)";
  s.sign_convention = kPositiveMoments;
  s.mass = 13.5;
  s.inertia = Inertia{0.8244, 1.135, 1.759, 0.1204};
  s.wing_area = 0.55;
  s.span = 2.90;
  s.chord = 0.19;
  set(s, Coefficient::kCL, {{"1", 0.28}, {"alpha", 3.45}, {"q_n", 0.0}, {"de", -0.36}});
  set_drag_parabola(s, 0.0437, 0.28, 3.45, 0.9);
  set_last_letter_lateral(s, {0, -0.98, 0, 0, 0, -0.17}, {0, -0.12, -1.0, 0.14, 0.08, -0.005},
                          {0, 0.25, 0.022, -1.0, -0.006, 0.08});
  set(s, Coefficient::kCm, {{"1", -0.02338}, {"alpha", -0.38}, {"q_n", -10.0}, {"de", 0.5}});
  s.model.stall = StallBlend{.M = 50.0, .alpha0 = 0.4712, .form = StallForm::kSource, .drag = false};
  s.propulsion = momentum(0.2027, 1.0, 80.0, 20.0, -0.5);
  set_stops(s, 0.3491, 0.3491, 0.3491);
  return s;
}

Subject tut_airplane() {
  Subject s;
  s.description = "last_letter tut_airplane, the tutorial's aircraft";
  s.sign_convention = kPositiveMoments;
  s.mass = 1.5;
  s.inertia = Inertia{0.2825, 0.0063, 0.2863, 0.0};
  s.wing_area = 0.3;
  s.span = 1.5;
  s.chord = 0.2;
  s.force_point = {-0.02, 0.0, 0.0};
  set(s, Coefficient::kCL, {{"1", 0.2543}, {"alpha", 2.543}, {"q_n", 0.0}, {"de", 0.0}});
  set_drag_parabola(s, 0.0485, 0.2543, 2.543, 0.9);
  set_last_letter_lateral(s, {0, -0.034, 0, 0, 0, -0.0068}, {0, -0.066, -0.066, 0, 0.0593, 0},
                          {0, 0.25, 0, -0.33, 0, 0.1});
  set(s, Coefficient::kCm, {{"1", 0.0175}, {"alpha", -0.2}, {"q_n", -0.0546}, {"de", 0.25}});
  s.model.stall = StallBlend{.M = 50.0, .alpha0 = 0.3491, .form = StallForm::kSource, .drag = false};
  s.propulsion = momentum(0.0275, 1.0, 27.78, 254.0, -0.25);
  set_stops(s, 0.3491, 0.3491, 0.3491);
  return s;
}

/// A sampled curve of alpha as terms: the straight piece through the first two points and a change of slope at every
/// further one.
void set_polyline(Subject& s, Coefficient c, std::span<const double> alpha_deg, std::span<const double> value,
                  Terms further) {
  CoefficientModel m;
  m.coefficient = c;
  const auto add = [&m](const std::string& text, double v) {
    m.terms.push_back(parse_term(text, "HCUAV"));
    m.values.push_back(v);
  };
  double slope = (value[1] - value[0]) / ((alpha_deg[1] - alpha_deg[0]) * kDegree);
  add("1", value[0] - slope * alpha_deg[0] * kDegree);
  add("alpha", slope);
  for (std::size_t i = 1; i + 1 < alpha_deg.size(); ++i) {
    const double next = (value[i + 1] - value[i]) / ((alpha_deg[i + 1] - alpha_deg[i]) * kDegree);
    add(fmt::format("spline(alpha, {} deg, 1)", alpha_deg[i]), next - slope);
    slope = next;
  }
  for (const auto& [text, v] : further) add(std::string(text), v);
  s.model.set(std::move(m));
}

Subject hcuav() {
  Subject s;
  s.description =
      "last_letter HCUAV: lift and drag are straight pieces through 18 samples of the source's cubic splines. Ours: "
      "thrust (the source has a piston engine with a power map)";
  s.sign_convention = kPositiveMoments;
  s.mass = 185.0;
  s.inertia = Inertia{93.5, 88.7, 165.7, -2.1};
  s.wing_area = 4.45;
  s.span = 6.4;
  s.chord = 0.78;
  constexpr std::array<double, 18> kAlpha = {-90, -45, -20, -10, -5, 0, 2, 4, 8, 10, 12, 14, 16, 18, 20, 25, 45, 90};
  constexpr std::array<double, 18> kLift = {0,     -0.757, -0.351, -0.382, 0.123, 0.622, 0.806, 0.997, 1.364,
                                            1.537, 1.677,  1.766,  1.835,  1.792, 1.587, 1.301, 0.859, 0};
  constexpr std::array<double, 18> kDrag = {2.000,  1.414,  0.782,  0.133,  0.0301, 0.0432, 0.0527, 0.0643, 0.0953,
                                            0.1137, 0.1370, 0.1662, 0.1920, 0.2234, 0.3086, 0.564,  1.380,  2.000};
  set_polyline(s, Coefficient::kCL, kAlpha, kLift, {{"q_n", 4.154}, {"de", -0.381}});
  set_polyline(s, Coefficient::kCD, kAlpha, kDrag, {});
  set_last_letter_lateral(s, {0, -1.64, -0.0658, 1.201, 0, -0.127}, {0, -0.093, -0.448, 0.209, 0.1028, -0.00635},
                          {0, 0.155, 0.0324, -0.408, -0.01018, 0.0476});
  set(s, Coefficient::kCm, {{"1", -0.00778}, {"alpha", -0.268}, {"q_n", -8.513}, {"de", 1.079}});
  s.propulsion = linear_thrust(900.0, 8.0);
  set_stops(s, 0.2618, 0.4363, 0.4363);
  return s;
}

Subject x8() {
  Subject s;
  s.description =
      "Skywalker X8, wind-tunnel numbers of krisgry/x8; no rudder. Its published inertia breaks the triangle "
      "inequality. No data beyond stall; stops are ours";
  s.sign_convention =
      "elevator trailing edge down is positive (Cm_de < 0), aileron positive rolls right (Cl_da > 0); elevons";
  s.mass = 3.364;
  s.inertia = Inertia{1.229, 0.1702, 0.8808, 0.9343};
  s.wing_area = 0.75;
  s.span = 2.1;
  s.chord = 0.3571;
  set(s, Coefficient::kCL, {{"1", 0.0867}, {"alpha", 4.0203}, {"q_n", 3.87}, {"de", 0.2781}});
  set(s, Coefficient::kCD,
      {{"1", 0.0197}, {"alpha", 0.0791}, {"alpha^2", 1.0555}, {"de^2", 0.0633}, {"beta", -0.0058}, {"beta^2", 0.1478}});
  set(s, Coefficient::kCY, {{"1", 0.0}, {"beta", -0.2239}, {"p_n", -0.1374}, {"r_n", 0.0839}, {"da", 0.0433}});
  set(s, Coefficient::kCl, {{"1", 0.0}, {"beta", -0.0849}, {"p_n", -0.4042}, {"r_n", 0.0555}, {"da", 0.1202}});
  set(s, Coefficient::kCm, {{"1", 0.0227}, {"alpha", -0.4629}, {"q_n", -1.3012}, {"de", -0.2292}});
  set(s, Coefficient::kCn, {{"1", 0.0}, {"beta", 0.0283}, {"p_n", 0.0044}, {"r_n", -0.0720}, {"da", -0.0034}});
  // Fitzpatrick's ducted fan: T = rho/2 S_prop C_prop V (V - Va), V = Va + throttle (k_motor - Va), multiplied out at
  // sea-level density.
  const double c = 0.5 * 1.225 * 0.1018;
  const double k = 40.0;
  s.propulsion.kind = PropulsionKind::kPolynomial;
  s.propulsion.polynomial = {{1, 1, c * k}, {1, 2, -c}, {2, 0, c * k * k}, {2, 1, -2.0 * c * k}, {2, 2, c}};
  set_stops(s, 30.0 * kDegree, 30.0 * kDegree, 30.0 * kDegree);
  return s;
}

Subject thor() {
  Subject s;
  s.description =
      "UltraStick 25e 'Thor' of the University of Minnesota (UASLab/OpenFlight): the model published with the "
      "aircraft. "
      "Left out: CL_alphadot 1.9724. No data beyond stall; thrust and stops are ours";
  s.sign_convention =
      "trailing edge down / left is positive (Cm_de < 0, Cl_da < 0, Cn_dr < 0, CY_dr > 0), the textbook convention";
  s.mass = 1.959;
  s.inertia = Inertia{0.07151, 0.08636, 0.15364, 0.014};
  s.wing_area = 0.3097;
  s.span = 1.27;
  s.chord = 0.25;
  set(s, Coefficient::kCL, {{"1", 0.1086}, {"alpha", 4.58}, {"q_n", 6.1639}, {"de", 0.0983}});
  set_drag_parabola(s, 0.0434, 0.1086, 4.58, 0.75, 0.23);
  set_lateral(s, Coefficient::kCY, {0, -0.4889, -0.0375, 0.15, 0, 0.1913});
  set_lateral(s, Coefficient::kCl, {0, -0.0545, -0.4496, 0.1086, -0.1646, 0.0115});
  set(s, Coefficient::kCm, {{"1", -0.0278}, {"alpha", -0.723}, {"q_n", -13.566}, {"de", -0.8488}});
  set_lateral(s, Coefficient::kCn, {0, 0.0723, 0.118, -0.1833, 0.0574, -0.1811});
  s.propulsion = linear_thrust(16.0, 0.35);
  set_stops(s, 25.0 * kDegree, 25.0 * kDegree, 25.0 * kDegree);
  for (Actuator* a : {&s.aileron, &s.elevator, &s.rudder}) a->time_constant = 1.0 / (2.0 * kPi * 8.0);
  return s;
}

struct Entry {
  std::string_view name;
  Subject (*make)();
};

constexpr std::array<Entry, 8> kSubjects = {{{"unatrap", unatrap},
                                             {"skywalker_2013", skywalker_2013},
                                             {"skywalker_2013_mod", skywalker_2013_mod},
                                             {"aerosonde", aerosonde},
                                             {"tut_airplane", tut_airplane},
                                             {"hcuav", hcuav},
                                             {"x8", x8},
                                             {"thor", thor}}};

}  // namespace

std::vector<std::string> builtin_subject_names() {
  std::vector<std::string> names;
  for (const Entry& e : kSubjects) names.emplace_back(e.name);
  return names;
}

Subject builtin_subject(std::string_view name, std::string_view place) {
  for (const Entry& e : kSubjects) {
    if (e.name != name) continue;
    Subject s = e.make();
    s.name = e.name;
    if (const std::string why = s.inertia->inadmissible(); !why.empty()) {
      s.warnings.push_back(fmt::format("{}: {}", name, why));
    }
    return s;
  }
  throw InputError(place, fmt::format("unknown aircraft '{}'{}", name, suggestion(name, builtin_subject_names())));
}

}  // namespace veridyn::aircraft
