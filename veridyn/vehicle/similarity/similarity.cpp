#include "veridyn/vehicle/similarity/similarity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {
namespace {

struct Role {
  const char* symbol;  ///< in formulas; null: the name
  const char* affects;
};

/// What the numbers of a vehicle are called in formulas and what they act on.
Role role_of(std::string_view name) {
  static const std::map<std::string, Role, std::less<>> roles{
      {"mass", {"m", "everything"}},
      {"unsprung_mass", {"M_w", "wheel hop and ride"}},
      {"a", {nullptr, "steady cornering, yaw response, axle loads"}},
      {"b", {nullptr, "steady cornering, yaw response, axle loads"}},
      {"track_f", {"W_f", "roll and lateral load transfer in front"}},
      {"track_r", {"W_r", "roll and lateral load transfer behind"}},
      {"cg_height", {"c", "roll, pitch and load transfer"}},
      {"I_x", {nullptr, "roll transients"}},
      {"I_y", {nullptr, "pitch transients"}},
      {"I_z", {nullptr, "yaw response"}},
      {"C_f", {nullptr, "steady cornering and yaw response"}},
      {"C_r", {nullptr, "steady cornering and yaw response"}},
      {"K_sf", {nullptr, "roll, pitch, heave; share of the front axle in load transfer"}},
      {"K_sr", {nullptr, "roll, pitch, heave; share of the rear axle in load transfer"}},
      {"C_sf", {nullptr, "damping of roll, pitch and heave"}},
      {"C_sr", {nullptr, "damping of roll, pitch and heave"}},
      {"K_bf", {nullptr, "roll; share of the front axle in load transfer"}},
      {"K_br", {nullptr, "roll; share of the rear axle in load transfer"}},
      {"K_tf", {nullptr, "wheel hop, ride and roll"}},
      {"K_tr", {nullptr, "wheel hop, ride and roll"}},
      {"mu", {nullptr, "friction limit"}},
  };
  const auto found = roles.find(name);
  return found == roles.end() ? Role{nullptr, ""} : found->second;
}

const std::string& symbol_of(const SimilarityParameter& parameter) {
  return parameter.symbol.empty() ? parameter.name : parameter.symbol;
}

void check(const SimilaritySubject& subject, const std::vector<SimilarityParameter>& known) {
  if (const std::string why = inadmissible(subject.parameters); !why.empty()) throw InputError("vehicle", why);
  if (!(subject.speed > 0.0 && std::isfinite(subject.speed))) {
    throw InputError("vehicle", fmt::format("speed is {:g} m/s; must be > 0", subject.speed));
  }
  if (!(subject.gravity > 0.0 && std::isfinite(subject.gravity))) {
    throw InputError("vehicle", fmt::format("gravity is {:g} m/s^2; must be > 0", subject.gravity));
  }
  if (subject.steer && !std::isfinite(*subject.steer)) throw InputError("vehicle", "steer is not finite");
  for (auto one = known.begin(); one != known.end(); ++one) {
    if (std::any_of(known.begin(), one, [&](const auto& other) {
          return other.name == one->name || symbol_of(other) == symbol_of(*one);
        })) {
      throw InputError(fmt::format("parameter {}", one->name), "is there already under this name or symbol");
    }
    if (one->name.empty()) throw InputError("parameter", "needs a name");
    if (!std::isfinite(one->value) && one->name != "mu") {
      throw InputError(fmt::format("parameter {}", one->name), "has no finite value");
    }
  }
}

double required_positive(double value, std::string_view name, std::string_view unit) {
  if (!(value > 0.0 && std::isfinite(value))) {
    throw InputError("scale", fmt::format("{} is {:g} {}; must be > 0", name, value, unit));
  }
  return value;
}

}  // namespace

namespace internal {

std::vector<SimilarityParameter> similarity_parameters(const SimilaritySubject& subject, bool with_friction) {
  std::vector<SimilarityParameter> list;
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const VehicleField& field = kVehicleFields[i];
    const double value = field_of(subject.parameters, i);
    if (std::string_view(field.name) == "mu" && !with_friction && !(value < kInfinity)) {
      continue;
    }
    const Role role = role_of(field.name);
    list.push_back(
        {field.name, role.symbol == nullptr ? field.name : role.symbol, value, parse_unit(field.unit), role.affects});
  }
  list.push_back({"wheelbase", "L", subject.parameters.wheelbase(), parse_unit("m"), "everything"});
  list.push_back({"speed", "u", subject.speed, parse_unit("m/s"), "everything"});
  list.push_back({"gravity", "g", subject.gravity, parse_unit("m/s^2"),
                  "static loads, lift-off, friction limit, load-dependent tyres"});
  if (subject.steer) list.push_back({"steer", "delta", *subject.steer, parse_unit("rad"), "the manoeuvre itself"});
  list.insert(list.end(), subject.further.begin(), subject.further.end());
  check(subject, list);
  return list;
}

RankedGroups similarity_groups(const std::vector<SimilarityParameter>& parameters,
                               std::span<const std::string> repeating) {
  std::vector<numerics::DimensionalQuantity> quantities;
  for (const SimilarityParameter& parameter : parameters) quantities.push_back({symbol_of(parameter), parameter.unit});
  const numerics::PiGroups pi = numerics::pi_groups(quantities, repeating);
  for (const std::size_t i : pi.repeating) {
    if (!(parameters[i].value > 0.0 && std::isfinite(parameters[i].value))) {
      throw InputError("repeating variables",
                       fmt::format("{} is {:g} {}; a repeating variable must be > 0", parameters[i].name,
                                   parameters[i].value, parameters[i].unit.name));
    }
  }
  std::vector<SimilarityGroup> groups;
  for (const numerics::PiGroup& group : pi.groups) {
    const SimilarityParameter& about = parameters[group.quantity];
    double value = about.value;
    for (std::size_t i = 0; i < pi.repeating.size(); ++i) {
      if (!group.exponents[i].is_zero()) {
        value *= std::pow(parameters[pi.repeating[i]].value, group.exponents[i].value());
      }
    }
    groups.push_back({about.name, group.formula, group.exponents, value});
  }
  return {std::move(groups), pi.rank};
}

}  // namespace internal

std::vector<SimilarityParameter> similarity_parameters(const SimilaritySubject& subject) {
  return internal::similarity_parameters(subject, false);
}

std::span<const std::string> default_repeating_variables() {
  static const std::array<std::string, 3> names{"m", "L", "u"};
  return names;
}

std::vector<SimilarityGroup> similarity_groups(const SimilaritySubject& subject,
                                               std::span<const std::string> repeating) {
  return internal::similarity_groups(similarity_parameters(subject), repeating).groups;
}

double ScaleFactors::of(const Unit& unit) const {
  // Dimensions are m, kg, s, K, A, rad.
  if (unit.dimension[3] != 0 || unit.dimension[4] != 0) {
    throw InputError("scale", fmt::format("a quantity in {} has no scale: it is not made of m, kg and s", unit.name));
  }
  return std::pow(length, unit.dimension[0]) * std::pow(mass, unit.dimension[1]) * std::pow(time(), unit.dimension[2]);
}

ScaleFactors scale_factors(const SimilaritySubject& prototype, const SimilaritySubject& model) {
  return {model.parameters.wheelbase() / prototype.parameters.wheelbase(),
          model.parameters.mass / prototype.parameters.mass, model.speed / prototype.speed};
}

VehicleParameters<double> scaled(const VehicleParameters<double>& parameters, const ScaleFactors& factors) {
  VehicleParameters<double> out;
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    field_of(out, i) = field_of(parameters, i) * factors.of(kVehicleFields[i].unit);
  }
  return out;
}

ScaledVehicle scale(const SimilaritySubject& prototype, const ScaleRequest& request) {
  check(prototype, similarity_parameters(prototype));
  ScaledVehicle out;
  ScaleFactors& factors = out.factors;
  if (request.length_ratio) factors.length = required_positive(*request.length_ratio, "length_ratio", "");
  if (request.mass) factors.mass = required_positive(*request.mass, "mass", "kg") / prototype.parameters.mass;
  if (request.speed) factors.speed = required_positive(*request.speed, "speed", "m/s") / prototype.speed;
  if (!request.length_ratio) {
    if (request.mass) {
      factors.length = std::cbrt(factors.mass);
      out.chosen.push_back(fmt::format("length ratio {:.6g}: the same density", factors.length));
    } else if (request.speed) {
      factors.length = request.froude ? factors.speed * factors.speed : factors.speed;
      out.chosen.push_back(fmt::format("length ratio {:.6g}: {}", factors.length,
                                       request.froude ? "the square of the speed ratio (Froude)" : "equal times"));
    } else {
      throw InputError("scale", "needs at least one of length_ratio, mass and speed");
    }
  }
  if (!request.mass) {
    factors.mass = factors.length * factors.length * factors.length;
    out.chosen.push_back(fmt::format("mass {:.6g} kg: the same density", prototype.parameters.mass * factors.mass));
  }
  if (!request.speed) {
    factors.speed = request.froude ? std::sqrt(factors.length) : factors.length;
    out.chosen.push_back(fmt::format("speed {:.6g} m/s: {}", prototype.speed * factors.speed,
                                     request.froude ? "the root of the length ratio (Froude)" : "equal times"));
  }
  out.model = prototype;
  out.model.parameters = scaled(prototype.parameters, factors);
  out.model.speed = prototype.speed * factors.speed;
  out.similar_gravity = prototype.gravity * factors.acceleration();
  for (SimilarityParameter& parameter : out.model.further) parameter.value *= factors.of(parameter.unit);
  return out;
}

VehicleTrajectory scaled(const VehicleTrajectory& trajectory, const ScaleFactors& factors) {
  VehicleTrajectory out = trajectory;
  const auto by = [](double factor, auto&... columns) {
    const auto one = [factor](std::vector<double>& column) {
      for (double& value : column) value *= factor;
    };
    (one(columns), ...);
  };
  const auto each = [&by](double factor, PerWheel<std::vector<double>>& columns) {
    for (std::vector<double>& column : columns) by(factor, column);
  };
  const double rate = 1.0 / factors.time();
  out.end_time *= factors.time();
  for (LiftOff& lift : out.lift_offs) {
    lift.from *= factors.time();
    lift.to *= factors.time();
  }
  by(factors.time(), out.time);
  by(factors.length, out.x, out.y, out.heave);
  by(factors.speed, out.u, out.v, out.heave_rate);
  by(rate, out.r, out.roll_rate, out.pitch_rate);
  by(rate * rate, out.yaw_acceleration);
  by(factors.acceleration(), out.longitudinal_acceleration, out.lateral_acceleration);
  for (PerWheel<std::vector<double>>* forces : {&out.Fx, &out.Fy, &out.Fz}) each(factors.force(), *forces);
  for (PerWheel<std::vector<double>>* heights : {&out.wheel_height, &out.suspension_travel, &out.road}) {
    each(factors.length, *heights);
  }
  each(rate, out.wheel_speed);
  return out;
}

namespace {

const KeyTable<SimilarityParameter>& similarity_parameter_keys() {
  using P = SimilarityParameter;
  static const auto table =
      KeyTable<P>("parameter", "A further quantity, which gets its group like any other.")
          .text("name", &P::name, "a new one")
          .required()
          .text("symbol", &P::symbol, "as in formulas")
          .otherwise("the name")
          .text("affects", &P::affects, "which part of the behaviour, in words")
          .elsewhere({"value", "", "", "", "a number with `unit`, or a text with one, `\"3 N\"`"})
          .required()
          .elsewhere({"unit", "", "", "that of `value`", "of `value`, where it is a number", true});
  return table;
}

}  // namespace

const KeyTable<ScaleRequest>& ScaleRequest::keys() {
  using R = ScaleRequest;
  static const auto table =
      KeyTable<R>("scale",
                  "A dynamically similar vehicle of another size; at least one of size, mass and speed, or a "
                  "`[scale.model]` to check, with keys of `[subject]` and its `speed`.")
          .number("length_ratio", &R::length_ratio, "1", kPositive, "model over prototype")
          .otherwise("cube root of the mass ratio, or with speed alone what keeps the time axis")
          .number("mass", &R::mass, "kg", kPositive, "of the model")
          .otherwise("by `length_ratio` cubed: the same density")
          .number("speed", &R::speed, "m/s", kPositive, "of the model")
          .otherwise("by `length_ratio`: the same time axis")
          .flag("froude", &R::froude, "speed by the square root of the length ratio, so that gravity scales too")
          .tables("parameter", similarity_parameter_keys(), [](const StudyTable&, R&) {});
  return table;
}

std::vector<SimilarityParameter> read_similarity_parameters(const StudyTable& table) {
  std::vector<SimilarityParameter> list;
  for (const StudyTable& one : table.tables("parameter")) {
    SimilarityParameter parameter = similarity_parameter_keys().read(one);
    if (parameter.symbol.empty()) parameter.symbol = parameter.name;
    try {
      if (one.is_text("value") && !one.has("unit")) {
        const std::string text = one.text("value");
        double number = 0.0;
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc{}) one.fail("value", fmt::format("'{}' is not a number with a unit", text));
        const Unit unit = parse_unit(std::string_view(stop, text.data() + text.size()));
        parameter.value = unit.to_si(number);
        parameter.unit = unit.si();
      } else {
        const Unit unit = parse_unit(one.text("unit"));
        parameter.value = one.is_text("value") ? one.number("value", unit.si_name())
                                               : unit.to_si(one.number("value", unit.si_name()));
        parameter.unit = unit.si();
      }
    } catch (const InputError& wrong) {
      if (!wrong.place().empty()) throw;
      one.fail(one.has("unit") ? "unit" : "value", wrong.what());
    }
    if (!std::isfinite(parameter.value)) one.fail("value", "must be finite");
    list.push_back(std::move(parameter));
  }
  return list;
}

}  // namespace veridyn::vehicle
