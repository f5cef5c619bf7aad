#include "veridyn/aircraft/model/propulsion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

namespace {

std::string_view kind_name(PropulsionKind kind) {
  switch (kind) {
    case PropulsionKind::kNone:
      return "none";
    case PropulsionKind::kPolynomial:
      return "polynomial";
    case PropulsionKind::kMomentum:
      return "momentum";
    case PropulsionKind::kPropeller:
      return "propeller";
  }
  return {};
}

constexpr std::array kKinds{PropulsionKind::kNone, PropulsionKind::kPolynomial, PropulsionKind::kMomentum,
                            PropulsionKind::kPropeller};

/// Reads "throttle^i*Va^j".
ThrustTerm parse_thrust_term(std::string_view text, double value, const std::string& place) {
  ThrustTerm term;
  term.value = value;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    std::size_t end = text.find('*', begin);
    if (end == std::string_view::npos) end = text.size();
    std::string_view factor = text.substr(begin, end - begin);
    begin = end + 1;
    while (factor.starts_with(' ')) factor.remove_prefix(1);
    while (factor.ends_with(' ')) factor.remove_suffix(1);
    if (factor == "1") continue;
    int power = 1;
    const std::size_t hat = factor.find('^');
    bool good = true;
    if (hat != std::string_view::npos) {
      const std::string_view digits = factor.substr(hat + 1);
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
      good = error == std::errc() && stop == digits.data() + digits.size() && power >= 1 && power <= 9;
      factor = factor.substr(0, hat);
    }
    if (good && factor == "throttle") {
      term.throttle_power += power;
    } else if (good && factor == "Va") {
      term.airspeed_power += power;
    } else {
      throw InputError(place, fmt::format("thrust term '{}' is not a product of throttle^i and Va^j", text));
    }
  }
  return term;
}

std::string thrust_term_text(const ThrustTerm& t) {
  std::vector<std::string> factors;
  if (t.throttle_power > 0) {
    factors.push_back(t.throttle_power == 1 ? "throttle" : fmt::format("throttle^{}", t.throttle_power));
  }
  if (t.airspeed_power > 0) {
    factors.push_back(t.airspeed_power == 1 ? "Va" : fmt::format("Va^{}", t.airspeed_power));
  }
  return factors.empty() ? "1" : fmt::format("{}", fmt::join(factors, "*"));
}

void read_kind(const StudyTable& table, const std::string& key, Propulsion& p) {
  std::vector<std::string> names;
  for (const PropulsionKind kind : kKinds) names.emplace_back(kind_name(kind));
  const std::string chosen = table.choice_or(key, names, "");
  for (const PropulsionKind kind : kKinds) {
    if (kind_name(kind) != chosen || kind == p.kind) continue;
    p = Propulsion();
    p.kind = kind;
  }
}

void read_polynomial(const StudyTable& table, const std::string& key, Propulsion& p) {
  const StudyTable terms = table.table(key);
  p.polynomial.clear();
  for (const std::string& term : terms.keys())
    p.polynomial.push_back(parse_thrust_term(term, terms.number(term, "1"), terms.place(term)));
}

/// Refuses keys of other kinds, and wants what its kind cannot do without.
void check_kind(const StudyTable& table, Propulsion& p) {
  const auto refuse = [&](PropulsionKind kind, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (p.kind != kind && table.has(key))
        table.fail(key, fmt::format("is of kind \"{}\", but the kind is \"{}\"", kind_name(kind), kind_name(p.kind)));
  };
  refuse(PropulsionKind::kPolynomial, {"polynomial"});
  refuse(PropulsionKind::kMomentum, {"S_prop", "C_prop", "k_motor", "k_tp", "k_omega"});
  refuse(PropulsionKind::kPropeller, {"diameter", "omega_max", "time_constant", "CT", "CP", "J_max", "rotation"});
  std::vector<std::string> missing;
  const auto want = [&](PropulsionKind kind, const char* key, bool there) {
    if (p.kind == kind && !there) missing.emplace_back(key);
  };
  want(PropulsionKind::kPolynomial, "polynomial", !p.polynomial.empty());
  want(PropulsionKind::kMomentum, "S_prop", p.S_prop > 0.0);
  want(PropulsionKind::kMomentum, "k_motor", p.k_motor > 0.0);
  want(PropulsionKind::kPropeller, "diameter", p.diameter > 0.0);
  want(PropulsionKind::kPropeller, "omega_max", p.omega_max > 0.0);
  want(PropulsionKind::kPropeller, "CT", !p.CT.empty());
  want(PropulsionKind::kPropeller, "CP", !p.CP.empty());
  refuse_missing(table, missing);
  if (std::abs(p.rotation) != 1.0) table.fail("rotation", fmt::format("= {:g} must be 1 or -1", p.rotation));
}

}  // namespace

const KeyTable<Propulsion>& propulsion_keys() {
  using P = Propulsion;
  static const auto table =
      KeyTable<P>(
          "propulsion",
          "Where thrust comes from. `momentum`: T = rho/2 S_prop C_prop ((k_motor throttle)^2 - Va^2), not below "
          "0, torque -k_tp (k_omega throttle)^2. `propeller`: T = rho n^2 D^4 CT(J), Q = rho n^2 D^5 CP(J)/(2 "
          "pi), J = Va/(n D). Keys are those of the kind.")
          .other({"kind", "", "`\"none\"`, `\"polynomial\"`, `\"momentum\"`, `\"propeller\"`", "\"none\"",
                  "`none`: no engine, or thrust is recorded"},
                 read_kind)
          .numbers("position", &P::position, "m", kAnyNumber,
                   "of the thrust line from the centre of gravity: forward, right, down")
          .other({"polynomial", "N, m/s", "`{ throttle = 30, \"throttle*Va\" = -0.5, \"Va^2\" = -0.01 }`", "required",
                  "polynomial: thrust; a negative sum counts as 0", true},
                 read_polynomial)
          .number("S_prop", &P::S_prop, "m^2", kPositive, "momentum: swept area")
          .otherwise("required")
          .number("C_prop", &P::C_prop, "1", kPositive, "momentum: efficiency")
          .number("k_motor", &P::k_motor, "m/s", kPositive, "momentum: exit speed of the air at full throttle")
          .otherwise("required")
          .number("k_tp", &P::k_tp, "1", kAnyNumber, "momentum: torque constant, in N m s^2")
          .number("k_omega", &P::k_omega, "rad/s", kAnyNumber, "momentum: rotor speed at full throttle")
          .number("diameter", &P::diameter, "m", kPositive, "propeller: D")
          .otherwise("required")
          .number("omega_max", &P::omega_max, "rad/s", kPositive, "propeller: rotor speed at full throttle")
          .otherwise("required")
          .number("time_constant", &P::time_constant, "s", kNotNegative,
                  "propeller: the rotor follows throttle * omega_max with this lag")
          .numbers("CT", &P::CT, "1", kAnyNumber, "propeller: thrust coefficient, powers of J from 0")
          .otherwise("required")
          .numbers("CP", &P::CP, "1", kAnyNumber, "propeller: power coefficient, powers of J from 0")
          .otherwise("required")
          .number("J_max", &P::J_max, "1", kPositive,
                  "propeller: largest J of the map; beyond it the values at J_max hold")
          .number("rotation", &P::rotation, "1", kAnyNumber,
                  "propeller: 1 where it turns clockwise seen from behind, which rolls the body to the left; else -1")
          .check(check_kind);
  return table;
}

std::string write_propulsion_toml(const Propulsion& p, std::string_view heading) {
  std::string out =
      fmt::format("[{}]\nkind = \"{}\"\nposition = [{}]\n", heading, kind_name(p.kind), fmt::join(p.position, ", "));
  switch (p.kind) {
    case PropulsionKind::kNone:
      break;
    case PropulsionKind::kPolynomial:
      out += "polynomial = {";
      for (std::size_t i = 0; i < p.polynomial.size(); ++i) {
        out +=
            fmt::format("{} \"{}\" = {}", i == 0 ? "" : ",", thrust_term_text(p.polynomial[i]), p.polynomial[i].value);
      }
      out += " }\n";
      break;
    case PropulsionKind::kMomentum:
      out += fmt::format("S_prop = {}\nC_prop = {}\nk_motor = {}\nk_tp = {}\nk_omega = {}\n", p.S_prop, p.C_prop,
                         p.k_motor, p.k_tp, p.k_omega);
      break;
    case PropulsionKind::kPropeller:
      out += fmt::format(
          "diameter = {}\nomega_max = {}\ntime_constant = {}\nCT = [{}]\nCP = [{}]\nJ_max = {}\nrotation = {}\n",
          p.diameter, p.omega_max, p.time_constant, fmt::join(p.CT, ", "), fmt::join(p.CP, ", "), p.J_max, p.rotation);
      break;
  }
  return out;
}

}  // namespace veridyn::aircraft
