#include "veridyn/aircraft/model/propulsion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "veridyn/core/error.hpp"

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

std::array<double, 3> vector3(const StudyTable& table, std::string_view key, std::string_view unit,
                              const std::array<double, 3>& otherwise) {
  if (!table.has(key)) return otherwise;
  const std::vector<double> v = table.numbers(key, unit);
  if (v.size() != 3) table.fail(key, fmt::format("has {} numbers, expected 3: [x, y, z]", v.size()));
  return {v[0], v[1], v[2]};
}

}  // namespace

Propulsion read_propulsion(const StudyTable& table, const Propulsion& base) {
  Propulsion p = base;
  const std::vector<std::string> kinds = {"none", "polynomial", "momentum", "propeller"};
  const std::string kind = table.choice_or("kind", kinds, kind_name(base.kind));
  if (table.has("kind") && kind != kind_name(base.kind)) p = Propulsion{};
  p.position = vector3(table, "position", "m", p.position);
  if (kind == "polynomial") {
    p.kind = PropulsionKind::kPolynomial;
    if (table.has("polynomial")) {
      p.polynomial.clear();
      const StudyTable terms = table.table("polynomial");
      for (const std::string& key : terms.keys()) {
        p.polynomial.push_back(parse_thrust_term(key, terms.number(key, "1"), terms.place(key)));
      }
    }
    if (p.polynomial.empty())
      table.fail("polynomial", "is missing or empty: a polynomial needs terms, { throttle = 30 }");
  } else if (kind == "momentum") {
    p.kind = PropulsionKind::kMomentum;
    p.S_prop = p.S_prop > 0.0 ? table.positive_or("S_prop", "m^2", p.S_prop) : table.positive("S_prop", "m^2");
    p.C_prop = table.positive_or("C_prop", "1", p.C_prop);
    p.k_motor = p.k_motor > 0.0 ? table.positive_or("k_motor", "m/s", p.k_motor) : table.positive("k_motor", "m/s");
    p.k_tp = table.number_or("k_tp", "1", p.k_tp);
    p.k_omega = table.number_or("k_omega", "rad/s", p.k_omega);
  } else if (kind == "propeller") {
    p.kind = PropulsionKind::kPropeller;
    p.diameter = p.diameter > 0.0 ? table.positive_or("diameter", "m", p.diameter) : table.positive("diameter", "m");
    p.omega_max =
        p.omega_max > 0.0 ? table.positive_or("omega_max", "rad/s", p.omega_max) : table.positive("omega_max", "rad/s");
    p.time_constant = table.number_or("time_constant", "s", p.time_constant);
    if (!(p.time_constant >= 0.0)) table.fail("time_constant", fmt::format("= {:g} must be >= 0", p.time_constant));
    if (table.has("CT") || p.CT.empty()) p.CT = table.numbers("CT", "1");
    if (table.has("CP") || p.CP.empty()) p.CP = table.numbers("CP", "1");
    p.J_max = table.positive_or("J_max", "1", p.J_max);
    p.rotation = table.number_or("rotation", "1", p.rotation);
    if (std::abs(p.rotation) != 1.0) table.fail("rotation", fmt::format("= {:g} must be 1 or -1", p.rotation));
  }
  return p;
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
