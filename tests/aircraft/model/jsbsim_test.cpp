#include "veridyn/aircraft/model/jsbsim.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <random>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kFoot = 0.3048, kPound = 4.4482216152605, kSlug = kPound / kFoot;

/// Reads a JSBSim file and computes its loads from the file alone, in JSBSim's units and order: an independent reading
/// of what `write_jsbsim` wrote, after JSBSim's reference manual (functions, aerodynamics, external reactions).
class JsbsimAircraft {
 public:
  explicit JsbsimAircraft(const std::string& text) {
    const pugi::xml_parse_result result = document_.load_string(text.c_str());
    EXPECT_TRUE(result) << result.description();
    root_ = document_.child("fdm_config");
    EXPECT_TRUE(root_);
  }

  struct Loads {
    Eigen::Vector3d force, moment;  // N, N m, body axes about the centre of gravity
  };

  Loads loads(const Eigen::Vector3d& v_r, const Eigen::Vector3d& omega, const Controls<double>& controls, double rho,
              double rotor_speed_share) {
    const double Va = v_r.norm();
    const pugi::xml_node metrics = root_.child("metrics");
    values_.clear();
    values_["metrics/Sw-sqft"] = quantity(metrics.child("wingarea"));
    values_["metrics/bw-ft"] = quantity(metrics.child("wingspan"));
    values_["metrics/cbarw-ft"] = quantity(metrics.child("chord"));
    values_["velocities/vt-fps"] = Va / kFoot;
    values_["velocities/u-aero-fps"] = v_r.x() / kFoot;
    values_["aero/alpha-rad"] = std::atan2(v_r.z(), v_r.x());
    values_["aero/beta-rad"] = Va > 0.0 ? std::asin(v_r.y() / Va) : 0.0;
    const double rho_slugs = rho / (kSlug / std::pow(kFoot, 3));
    values_["atmosphere/rho-slugs_ft3"] = rho_slugs;
    values_["aero/qbar-psf"] = 0.5 * rho_slugs * Va * Va / (kFoot * kFoot);
    values_["velocities/p-aero-rad_sec"] = omega.x();
    values_["velocities/q-aero-rad_sec"] = omega.y();
    values_["velocities/r-aero-rad_sec"] = omega.z();
    values_["fcs/elevator-pos-rad"] = controls.de;
    values_["fcs/left-aileron-pos-rad"] = controls.da;
    values_["fcs/rudder-pos-rad"] = controls.dr;
    values_["fcs/engine-throttle-norm"] = controls.throttle;
    values_["fcs/rotor-speed-norm"] = rotor_speed_share;

    const pugi::xml_node reactions = root_.child("external_reactions");
    for (const pugi::xml_node f : reactions.children("function")) define(f);
    std::map<std::string, double> axis;
    for (const pugi::xml_node node : root_.child("aerodynamics").children()) {
      if (std::string(node.name()) == "function") define(node);
      if (std::string(node.name()) != "axis") continue;
      for (const pugi::xml_node f : node.children("function")) axis[node.attribute("name").value()] += define(f);
    }
    const Eigen::Vector3d aero = kPound * Eigen::Vector3d(axis.at("X"), axis.at("Y"), axis.at("Z"));
    const Eigen::Vector3d about_reference =
        kPound * kFoot * Eigen::Vector3d(axis.at("ROLL"), axis.at("PITCH"), axis.at("YAW"));
    Loads out;
    const Eigen::Vector3d reference = body_point(location(metrics, "AERORP"));
    const pugi::xml_node thrust = reactions.child("force");
    const Eigen::Vector3d T =
        kPound * evaluate(thrust.child("function").first_child()) * vector(thrust.child("direction"));
    const pugi::xml_node torque = reactions.child("moment");
    out.force = aero + T;
    out.moment = about_reference + reference.cross(aero) + body_point(thrust.child("location")).cross(T) +
                 kPound * kFoot * evaluate(torque.child("function").first_child()) * vector(torque.child("direction"));
    return out;
  }

  MassProperties mass() {
    const pugi::xml_node m = root_.child("mass_balance");
    const double ixx = quantity(m.child("ixx")), iyy = quantity(m.child("iyy")), izz = quantity(m.child("izz"));
    const double ixz = quantity(m.child("ixz"));
    Eigen::Matrix3d J;  // FGMassBalance: the product enters with a plus
    J << ixx, 0, ixz, 0, iyy, 0, ixz, 0, izz;
    return {quantity(m.child("emptywt")), J};
  }

 private:
  static double quantity(pugi::xml_node node) {
    const std::string unit = node.attribute("unit").value();
    const double x = node.text().as_double();
    if (unit == "M2") return x / (kFoot * kFoot);
    if (unit == "M") return x / kFoot;
    if (unit == "KG*M2" || unit == "KG") return x;
    ADD_FAILURE() << node.name() << " in " << unit;
    return 0.0;
  }
  static Eigen::Vector3d vector(pugi::xml_node node) {
    return {node.child("x").text().as_double(), node.child("y").text().as_double(), node.child("z").text().as_double()};
  }
  static pugi::xml_node location(pugi::xml_node parent, const char* name) {
    return parent.find_child_by_attribute("location", "name", name);
  }
  /// Structural frame (x aft, z up, metres) to body axes from the centre of gravity, which is the origin.
  static Eigen::Vector3d body_point(pugi::xml_node node) {
    EXPECT_STREQ(node.attribute("unit").value(), "M");
    const Eigen::Vector3d p = vector(node);
    return {-p.x(), p.y(), -p.z()};
  }
  double define(pugi::xml_node f) {
    pugi::xml_node body = f.first_child();
    if (std::string(body.name()) == "description") body = body.next_sibling();
    return values_[f.attribute("name").value()] = evaluate(body);
  }
  double evaluate(pugi::xml_node node) {
    const std::string op = node.name();
    if (op == "value") return node.text().as_double();
    if (op == "property") {
      const auto found = values_.find(node.text().get());
      if (found == values_.end()) {
        ADD_FAILURE() << "property before its definition: " << node.text().get();
        return std::nan("");
      }
      return found->second;
    }
    std::vector<double> a;
    for (const pugi::xml_node child : node.children()) a.push_back(evaluate(child));
    if (op == "sum" || op == "product") {
      double result = op == "sum" ? 0.0 : 1.0;
      for (const double x : a) result = op == "sum" ? result + x : result * x;
      return result;
    }
    if (op == "difference" && a.size() == 2) return a[0] - a[1];
    if (op == "quotient" && a.size() == 2) return a[0] / a[1];
    if (op == "pow" && a.size() == 2) return std::pow(a[0], a[1]);
    if (op == "max" && a.size() == 2) return std::max(a[0], a[1]);
    if (op == "min" && a.size() == 2) return std::min(a[0], a[1]);
    if (op == "gt" && a.size() == 2) return a[0] > a[1] ? 1.0 : 0.0;
    if (a.size() == 1) {
      if (op == "sin") return std::sin(a[0]);
      if (op == "cos") return std::cos(a[0]);
      if (op == "exp") return std::exp(a[0]);
      if (op == "abs") return std::abs(a[0]);
    }
    ADD_FAILURE() << "unknown operation " << op << " of " << a.size();
    return std::nan("");
  }

  pugi::xml_document document_;
  pugi::xml_node root_;
  std::map<std::string, double> values_;
};

/// A subject with everything that the exporter can meet.
Subject everything(StallForm form, PropulsionKind propulsion) {
  Subject s = builtin_subject("aerosonde");
  s.force_point = {-0.02, 0.01, 0.03};
  s.model.stall = StallBlend{.M = 40.0, .alpha0 = 0.3, .form = form};
  CoefficientModel CD = s.model.at(Coefficient::kCD);
  for (const auto& [text, number] : {std::pair{"abs(de)", 0.03},
                                     {"spline(alpha, 5 deg, 2)", 0.7},
                                     {"CT", 0.1},
                                     {"spline(alpha, 3 deg, 0)", 0.01},
                                     {"alpha*q_n", 0.2},
                                     {"Va", 1e-4}}) {
    CD.terms.push_back(parse_term(text, "test"));
    CD.values.push_back(number);
  }
  s.model.set(CD);
  Propulsion p;
  p.kind = propulsion;
  p.position = {0.3, 0.02, -0.05};
  p.polynomial = {{1, 0, 30.0}, {1, 1, -0.5}, {0, 2, -0.01}};
  p.S_prop = 0.2, p.k_motor = 50.0, p.k_tp = 1e-6, p.k_omega = 500.0;
  p.diameter = 0.4, p.omega_max = 800.0, p.CT = {0.1, -0.02, -0.08}, p.CP = {0.04, 0.01, -0.03}, p.J_max = 1.0;
  s.propulsion = p;
  return s;
}

TEST(Jsbsim, LoadsOfTheFileAreThoseOfTheSubjectAtRandomStates) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const StallForm form : {StallForm::kFull, StallForm::kSource, StallForm::kSeparation}) {
    for (const PropulsionKind kind :
         {PropulsionKind::kNone, PropulsionKind::kPolynomial, PropulsionKind::kMomentum, PropulsionKind::kPropeller}) {
      const Subject s = everything(form, kind);
      JsbsimAircraft file(write_jsbsim(s));
      const MassProperties mass = file.mass();
      EXPECT_EQ(mass.mass, s.mass);
      EXPECT_EQ(mass.inertia, s.inertia->matrix());
      for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d v(20.0 + 8.0 * unit(random), 4.0 * unit(random), 12.0 * unit(random));
        const Eigen::Vector3d omega(unit(random), unit(random), unit(random));
        Controls<double> controls{0.3 * unit(random), 0.3 * unit(random), 0.3 * unit(random), 0.5 + 0.5 * unit(random),
                                  0.0};
        const double share = 0.5 + 0.5 * unit(random);
        controls.rotor_speed =
            share * (kind == PropulsionKind::kPropeller ? s.propulsion.omega_max : s.propulsion.k_omega);
        const AeroLoads<double> ours = aero_loads<double>(s, v, omega, controls, 1.1);
        const JsbsimAircraft::Loads theirs = file.loads(v, omega, controls, 1.1, share);
        EXPECT_LT((theirs.force - ours.force).norm(), 1e-11 * (1.0 + ours.force.norm()));
        EXPECT_LT((theirs.moment - ours.moment).norm(), 1e-11 * (1.0 + ours.moment.norm()));
      }
    }
  }
}

TEST(Jsbsim, BothModelsFlyTheSameTenSeconds) {
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    if (!s.inertia || !s.model.unknown_parameters().empty()) continue;
    JsbsimAircraft file(write_jsbsim(s));
    const MassProperties ours(s.mass, s.inertia->matrix()), theirs = file.mass();
    const auto controls = [&](double t) {
      Controls<double> c{0.03 * std::sin(2.0 * t), 0.02 * std::sin(3.0 * t), 0.03 * std::cos(1.5 * t),
                         0.5 + 0.3 * std::sin(0.7 * t), 0.0};
      c.rotor_speed = s.propulsion.steady_rotor_speed(c.throttle);
      return c;
    };
    const auto rate_of_file = [&](double t, const RigidBodyState<double>& x) {
      const Eigen::Vector3d v_r = R_body_from_ned(x) * x.segment<3>(3);
      const Controls<double> c = controls(t);
      const JsbsimAircraft::Loads l = file.loads(v_r, x.tail<3>(), c, 1.2, c.throttle);
      return rigid_body_rate<double>(x, theirs, l.force, l.moment, 9.80665);
    };
    const auto rate_of_subject = [&](double t, const RigidBodyState<double>& x) {
      return aircraft_rate<double>(s, ours, x, controls(t), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 1.2,
                                   9.80665);
    };
    const auto fly = [](const auto& rate) {
      RigidBodyState<double> x = RigidBodyState<double>::Zero();
      x(2) = -200.0, x(3) = 20.0, x(5) = 0.5, x(9) = 1.0;
      const double h = 0.01;
      for (int i = 0; i < 1000; ++i) {
        x = numerics::runge_kutta_4_step(rate, h * i, x, h);
        normalise_attitude(x);
      }
      return x;
    };
    const RigidBodyState<double> a = fly(rate_of_subject), b = fly(rate_of_file);
    EXPECT_GT((a.head<3>() - Eigen::Vector3d(0, 0, -200)).norm(), 10.0) << name << " must have flown";
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-7) << name;
  }
}

TEST(Jsbsim, WhatCannotFlyIsRefusedByName) {
  Subject s = builtin_subject("aerosonde");
  s.model.at(Coefficient::kCm).values[0] = kNaN;
  try {
    (void)write_jsbsim(s);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Cm_0"), std::string::npos) << error.what();
  }
  s = builtin_subject("aerosonde");
  s.inertia.reset();
  EXPECT_THROW((void)write_jsbsim(s), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
