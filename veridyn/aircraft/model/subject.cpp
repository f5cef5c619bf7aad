#include "veridyn/aircraft/model/subject.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::aircraft {

namespace {

std::array<double, 3> vector3(const StudyTable& table, std::string_view key, const std::array<double, 3>& otherwise) {
  if (!table.has(key)) return otherwise;
  const std::vector<double> v = table.numbers(key, "m");
  if (v.size() != 3) table.fail(key, fmt::format("has {} numbers, expected 3: [x, y, z]", v.size()));
  return {v[0], v[1], v[2]};
}

double positive(const StudyTable& table, std::string_view key, std::string_view unit, double base) {
  return base > 0.0 ? table.positive_or(key, unit, base) : table.positive(key, unit);
}

Inertia read_inertia(const StudyTable& subject, std::vector<std::string>& warnings) {
  const StudyTable table = subject.table("inertia");
  Inertia J;
  J.Jx = table.positive("Jx", "kg m^2");
  J.Jy = table.positive("Jy", "kg m^2");
  J.Jz = table.positive("Jz", "kg m^2");
  J.Jxz = table.number_or("Jxz", "kg m^2", 0.0);
  const std::string why = J.inadmissible();
  if (!J.positive_definite()) subject.fail("inertia", why);
  if (!why.empty()) warnings.push_back(fmt::format("{}: {}", subject.place("inertia"), why));
  return J;
}

ReferenceLengths read_reference_lengths(const StudyTable& table) {
  const auto length = [&](std::string_view key) {
    return table.has(key) ? std::optional(table.positive(key, "m")) : std::nullopt;
  };
  return {.roll = length("roll"), .pitch = length("pitch"), .yaw = length("yaw")};
}

BodySigma read_body_sigma(const StudyTable& table) {
  const auto sigma = [&](std::string_view key, std::string_view unit) {
    const double value = table.number_or(key, unit, 0.0);
    if (!(value >= 0.0)) table.fail(key, fmt::format("= {:g} must be >= 0", value));
    return value;
  };
  return {.mass = sigma("mass", "kg"),
          .wing_area = sigma("wing_area", "m^2"),
          .span = sigma("span", "m"),
          .chord = sigma("chord", "m"),
          .Jx = sigma("Jx", "kg m^2"),
          .Jy = sigma("Jy", "kg m^2"),
          .Jz = sigma("Jz", "kg m^2"),
          .Jxz = sigma("Jxz", "kg m^2")};
}

Actuator read_actuator(const StudyTable& table, const Actuator& base, bool throttle) {
  const std::string_view unit = throttle ? "1" : "rad";
  const std::string_view rate = throttle ? "1/s" : "rad/s";
  Actuator a = base;
  a.upper = table.number_or("upper", unit, base.upper);
  a.lower = table.number_or("lower", unit, !throttle && table.has("upper") ? -a.upper : base.lower);
  if (!(a.lower < a.upper)) {
    table.fail(table.has("lower") ? "lower" : "upper",
               fmt::format("lower stop {:g} is not below upper stop {:g}", a.lower, a.upper));
  }
  if (table.has("rate_limit")) a.rate_limit = table.positive("rate_limit", rate);
  a.time_constant = table.number_or("time_constant", "s", base.time_constant);
  if (!(a.time_constant >= 0.0)) table.fail("time_constant", fmt::format("= {:g} must be >= 0", a.time_constant));
  a.delay = table.number_or("delay", "s", base.delay);
  if (!(a.delay >= 0.0 && a.delay <= 5.0)) table.fail("delay", fmt::format("= {:g} must be from 0 to 5 s", a.delay));
  return a;
}

std::string actuator_toml(std::string_view name, const Actuator& a) {
  std::string out = fmt::format("\n[subject.actuators.{}]\nlower = {}\nupper = {}\ntime_constant = {}\ndelay = {}\n",
                                name, a.lower, a.upper, a.time_constant, a.delay);
  if (std::isfinite(a.rate_limit)) out += fmt::format("rate_limit = {}\n", a.rate_limit);
  return out;
}

std::string lengths_toml(const ReferenceLengths& lengths) {
  std::vector<std::string> given;
  if (lengths.roll) given.push_back(fmt::format("roll = {}", *lengths.roll));
  if (lengths.pitch) given.push_back(fmt::format("pitch = {}", *lengths.pitch));
  if (lengths.yaw) given.push_back(fmt::format("yaw = {}", *lengths.yaw));
  return fmt::format("reference_lengths = {{ {} }}\n", fmt::join(given, ", "));
}

}  // namespace

Eigen::Matrix3d Inertia::matrix() const {
  Eigen::Matrix3d J;
  J << Jx, 0, -Jxz, 0, Jy, 0, -Jxz, 0, Jz;
  return J;
}

bool Inertia::positive_definite() const { return Jx > 0.0 && Jy > 0.0 && Jz > 0.0 && Jx * Jz - Jxz * Jxz > 0.0; }

std::string Inertia::inadmissible() const {
  if (!positive_definite()) {
    return fmt::format(
        "inertia Jx = {:g}, Jy = {:g}, Jz = {:g}, Jxz = {:g} is not positive definite: needs Jx Jz > Jxz^2 and all "
        "moments > 0",
        Jx, Jy, Jz, Jxz);
  }
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix(), Eigen::EigenvaluesOnly).eigenvalues();
  if (principal(2) > (principal(0) + principal(1)) * (1.0 + 1e-9)) {
    return fmt::format(
        "principal moments of inertia {:.4g}, {:.4g}, {:.4g} kg m^2: the largest exceeds the sum of the others, which "
        "no body of positive mass has",
        principal(0), principal(1), principal(2));
  }
  return {};
}

bool operator==(const Subject& a, const Subject& b) {
  return a.name == b.name && a.description == b.description && a.sign_convention == b.sign_convention &&
         a.mass == b.mass && a.inertia == b.inertia && a.sigma == b.sigma && a.wing_area == b.wing_area &&
         a.span == b.span && a.chord == b.chord && a.lengths == b.lengths && a.force_point == b.force_point &&
         a.imu_position == b.imu_position && a.model == b.model && a.propulsion == b.propulsion &&
         a.elevator == b.elevator && a.aileron == b.aileron && a.rudder == b.rudder && a.throttle == b.throttle;
}

Subject read_subject(const StudyTable& table) {
  Subject s;
  // Rejected coefficients are "unknown" in such a file, and whoever needs their numbers refuses that.
  table.accept("grades");
  static_cast<void>(table.flag_or("accept_rejected", false));
  if (table.has("builtin")) s = builtin_subject(table.text("builtin"), table.place("builtin"));
  s.name = table.text_or("name", s.name.empty() ? "aircraft" : s.name);
  s.description = table.text_or("description", s.description);
  s.sign_convention = table.text_or("sign_convention", s.sign_convention);
  s.mass = positive(table, "mass", "kg", s.mass);
  s.wing_area = positive(table, "wing_area", "m^2", s.wing_area);
  s.span = positive(table, "span", "m", s.span);
  s.chord = positive(table, "chord", "m", s.chord);
  if (table.has("reference_lengths")) s.lengths = read_reference_lengths(table.table("reference_lengths"));
  s.force_point = vector3(table, "force_point", s.force_point);
  s.imu_position = vector3(table, "imu_position", s.imu_position);
  if (table.has("inertia")) {
    s.warnings.clear();
    s.inertia = read_inertia(table, s.warnings);
  }
  if (table.has("sigma")) s.sigma = read_body_sigma(table.table("sigma"));
  s.model = read_aero_model(table.table_or_empty("model"), s.model);
  s.propulsion = read_propulsion(table.table_or_empty("propulsion"), s.propulsion);
  const StudyTable actuators = table.table_or_empty("actuators");
  s.elevator = read_actuator(actuators.table_or_empty("elevator"), s.elevator, false);
  s.aileron = read_actuator(actuators.table_or_empty("aileron"), s.aileron, false);
  s.rudder = read_actuator(actuators.table_or_empty("rudder"), s.rudder, false);
  s.throttle = read_actuator(actuators.table_or_empty("throttle"), s.throttle, true);
  return s;
}

std::string write_subject_toml(const Subject& s) {
  std::string out = fmt::format(
      "[subject]\nname = {}\ndescription = {}\nsign_convention = {}\nmass = {}\nwing_area = {}\nspan = {}\nchord = {}\n"
      "force_point = [{}]\nimu_position = [{}]\n",
      toml_text(s.name), toml_text(s.description), toml_text(s.sign_convention), s.mass, s.wing_area, s.span, s.chord,
      fmt::join(s.force_point, ", "), fmt::join(s.imu_position, ", "));
  if (s.lengths.any()) out += lengths_toml(s.lengths);
  if (s.inertia) {
    out += fmt::format("inertia = {{ Jx = {}, Jy = {}, Jz = {}, Jxz = {} }}\n", s.inertia->Jx, s.inertia->Jy,
                       s.inertia->Jz, s.inertia->Jxz);
  }
  if (s.sigma.any()) {
    const BodySigma& e = s.sigma;
    out += fmt::format(
        "sigma = {{ mass = {}, wing_area = {}, span = {}, chord = {}, Jx = {}, Jy = {}, Jz = {}, Jxz = {} }}\n", e.mass,
        e.wing_area, e.span, e.chord, e.Jx, e.Jy, e.Jz, e.Jxz);
  }
  out += "\n" + write_aero_model_toml(s.model);
  out += "\n" + write_propulsion_toml(s.propulsion);
  out += actuator_toml("elevator", s.elevator) + actuator_toml("aileron", s.aileron) +
         actuator_toml("rudder", s.rudder) + actuator_toml("throttle", s.throttle);
  return out;
}

}  // namespace veridyn::aircraft
