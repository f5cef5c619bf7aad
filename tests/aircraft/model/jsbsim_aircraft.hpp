#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/flight_dynamics.hpp"

namespace veridyn::aircraft::testing {

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
    values_["fcs/throttle-pos-norm"] = controls.throttle;
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
  static constexpr double kFoot = 0.3048, kPound = 4.4482216152605, kSlug = kPound / kFoot;

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

}  // namespace veridyn::aircraft::testing
