#include "veridyn/aircraft/model/subject.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <functional>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::aircraft {

namespace {

const KeyTable<Inertia>& inertia_keys() {
  static const auto table =
      KeyTable<Inertia>("inertia",
                        "Of an aircraft that is symmetric about its xz plane, about the centre of gravity. "
                        "Without it moments are identified per unit inertia. One that breaks the triangle "
                        "inequality of moments of inertia is kept with a warning.")
          .number("Jx", &Inertia::Jx, "kg m^2", kPositive, "about the forward axis")
          .required()
          .number("Jy", &Inertia::Jy, "kg m^2", kPositive, "about the axis to the right")
          .required()
          .number("Jz", &Inertia::Jz, "kg m^2", kPositive, "about the axis down")
          .required()
          .number("Jxz", &Inertia::Jxz, "kg m^2", kAnyNumber, "product of inertia")
          .check([](const StudyTable& t, Inertia& J) {
            if (!J.positive_definite()) throw InputError(t.place(""), J.inadmissible());
          });
  return table;
}

const KeyTable<ReferenceLengths>& length_keys() {
  using L = ReferenceLengths;
  static const auto table = KeyTable<L>("reference_lengths",
                                        "Lengths that make moments and rates dimensionless: definitions "
                                        "without error, which numbers from elsewhere may need.")
                                .number("roll", &L::roll, "m", kPositive, "of Cl and p_n")
                                .otherwise("the span")
                                .number("pitch", &L::pitch, "m", kPositive, "of Cm and q_n")
                                .otherwise("the chord")
                                .number("yaw", &L::yaw, "m", kPositive, "of Cn and r_n")
                                .otherwise("the span");
  return table;
}

const KeyTable<BodySigma>& sigma_keys() {
  using S = BodySigma;
  static const auto table =
      KeyTable<S>("sigma",
                  "Standard deviations of the aircraft's constants, as known from scales, drawings and swing "
                  "tests: errors that all samples share, which widen the intervals of the derivatives.")
          .number("mass", &S::mass, "kg", kNotNegative, "of the mass")
          .number("wing_area", &S::wing_area, "m^2", kNotNegative, "of S")
          .number("span", &S::span, "m", kNotNegative, "of b")
          .number("chord", &S::chord, "m", kNotNegative, "of c")
          .number("Jx", &S::Jx, "kg m^2", kNotNegative, "of each number of the inertia")
          .number("Jy", &S::Jy, "kg m^2", kNotNegative, "")
          .number("Jz", &S::Jz, "kg m^2", kNotNegative, "")
          .number("Jxz", &S::Jxz, "kg m^2", kNotNegative, "");
  return table;
}

KeyTable<Actuator> actuator_keys(const std::string& name) {
  using A = Actuator;
  const bool throttle = name == "throttle";
  KeyTable<A> table(name,
                    throttle ? "Of the engine." : "Of a servo with what it moves; likewise `aileron` and `rudder`.");
  table.number("lower", &A::lower, throttle ? "1" : "rad", kAnyNumber, "stop").otherwise(throttle ? "0" : "-`upper`");
  table
      .number("upper", &A::upper, throttle ? "1" : "rad", kAnyNumber,
              throttle ? "stop" : "stop; also the full throw to which servo outputs are scaled")
      .otherwise(throttle ? "1" : "0.35 rad")
      .number("rate_limit", &A::rate_limit, throttle ? "1/s" : "rad/s", kPositive, "of simulations")
      .otherwise("none")
      .number("time_constant", &A::time_constant, "s", kNotNegative, "of simulations; 0 follows at once")
      .number("delay", &A::delay, "s", from_to(0.0, 5.0), "of simulations");
  if (!throttle)
    table.number("free_play", &A::free_play, "rad", kNotNegative,
                 "of simulations: what the servo moves after a reversal before the surface does");
  table.check([throttle](const StudyTable& t, A& a) {
    if (!throttle && t.has("upper") && !t.has("lower")) a.lower = -a.upper;
    if (!(a.lower < a.upper))
      t.fail(t.has("lower") ? "lower" : "upper",
             fmt::format("lower stop {:g} is not below upper stop {:g}", a.lower, a.upper));
  });
  return table;
}

void read_surfaces(const StudyTable& actuators, Subject& s) {
  for (const auto& [name, surface] :
       {std::pair{"elevator", &s.elevator}, std::pair{"aileron", &s.aileron}, std::pair{"rudder", &s.rudder}})
    actuator_keys(name).read(actuators.table_or_empty(name), *surface);
}

void check(const StudyTable& table, Subject& s) {
  std::vector<std::string> missing;
  for (const auto& [key, value] : {std::pair{"mass", s.mass}, std::pair{"wing_area", s.wing_area},
                                   std::pair{"span", s.span}, std::pair{"chord", s.chord}})
    if (!(value > 0.0)) missing.emplace_back(key);
  refuse_missing(table, missing);
  if (s.name.empty()) s.name = "aircraft";
  if (!table.has("inertia")) return;
  s.warnings.clear();
  if (const std::string why = s.inertia->inadmissible(); !why.empty())
    s.warnings.push_back(fmt::format("{}: {}", table.place("inertia"), why));
}

std::string actuator_toml(std::string_view name, const Actuator& a) {
  std::string out = fmt::format("\n[subject.actuators.{}]\nlower = {}\nupper = {}\ntime_constant = {}\ndelay = {}\n",
                                name, a.lower, a.upper, a.time_constant, a.delay);
  if (std::isfinite(a.rate_limit)) out += fmt::format("rate_limit = {}\n", a.rate_limit);
  if (a.free_play != 0.0) out += fmt::format("free_play = {}\n", a.free_play);
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
         a.imu_position == b.imu_position && a.model == b.model && a.downwash == b.downwash &&
         a.propulsion == b.propulsion && a.elevator == b.elevator && a.aileron == b.aileron && a.rudder == b.rudder &&
         a.throttle == b.throttle;
}

const KeyTable<Subject>& subject_keys() {
  using S = Subject;
  static const auto table =
      KeyTable<S>("subject", "The aircraft: what is measured on the bench, and its model of aerodynamics.")
          .other(
              {"builtin", "", quoted_list(builtin_subject_names(), "`"), "none", "start from it; other keys override",
               true},
              [](const StudyTable& t, const std::string& key, S& s) { s = builtin_subject(t.text(key), t.place(key)); })
          .text("name", &S::name, "of the aircraft")
          .text("description", &S::description, "where the numbers are from")
          .text("sign_convention", &S::sign_convention, "of deflections, in words")
          .number("mass", &S::mass, "kg", kPositive, "at take-off")
          .otherwise("required without `builtin`")
          .number("wing_area", &S::wing_area, "m^2", kPositive, "S")
          .otherwise("required without `builtin`")
          .number("span", &S::span, "m", kPositive, "b")
          .otherwise("required without `builtin`")
          .number("chord", &S::chord, "m", kPositive, "c, mean aerodynamic chord")
          .otherwise("required without `builtin`")
          .numbers("force_point", &S::force_point, "m", kAnyNumber,
                   "where the aerodynamic force acts, from the centre of gravity: forward, right, down")
          .numbers("imu_position", &S::imu_position, "m", kAnyNumber,
                   "of the accelerometer from the centre of gravity: forward, right, down")
          .whole_table("reference_lengths", &S::lengths, length_keys())
          .whole_table("inertia", &S::inertia, inertia_keys())
          .whole_table("sigma", &S::sigma, sigma_keys())
          .table("model", &S::model, aero_model_keys())
          .whole_table("downwash", &S::downwash, Downwash::keys())
          .table("propulsion", &S::propulsion, propulsion_keys())
          .table("actuators", std::identity(),
                 KeyTable<S>("actuators")
                     .within("elevator", actuator_keys("elevator"), read_surfaces)
                     .table("throttle", &S::throttle, actuator_keys("throttle")))
          .check(check);
  return table;
}

Subject read_subject(const StudyTable& table) {
  // Rejected coefficients are "unknown" in such a file, and whoever needs their numbers refuses that.
  table.accept("grades");
  static_cast<void>(table.flag_or("accept_rejected", false));
  return subject_keys().read(table);
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
  if (const Downwash& d = s.downwash; d.any()) {
    out += fmt::format("\n[subject.downwash]\ntail_arm = {}\nCL_alphadot = {}\nCm_alphadot = {}\n", d.tail_arm,
                       d.CL_alphadot, d.Cm_alphadot);
  }
  out += "\n" + write_propulsion_toml(s.propulsion);
  out += actuator_toml("elevator", s.elevator) + actuator_toml("aileron", s.aileron) +
         actuator_toml("rudder", s.rudder) + actuator_toml("throttle", s.throttle);
  return out;
}

}  // namespace veridyn::aircraft
