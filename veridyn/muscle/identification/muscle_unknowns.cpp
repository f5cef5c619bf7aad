#include "veridyn/muscle/identification/muscle_unknowns.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::muscle {
namespace {

/// The model's value of a parameter.
double model_value(const Model& model, const MuscleParameterName& name) {
  if (name.field == MuscleParameterName::kGain) return 1.0;
  if (name.field == MuscleParameterName::kDelay) return 0.0;
  return field_of(model.muscles[name.muscle].parameters.musculotendon, name.field);
}

std::string full_name(const Model& model, const MuscleParameterName& name) {
  return fmt::format("{}.{}", model.muscles[name.muscle].name(), parameter_field(name.field).name);
}

std::size_t find_field(std::string_view field, std::string_view place) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < MuscleParameterName::kCount; ++i) {
    names.emplace_back(parameter_field(i).name);
    if (names.back() == field) return i;
  }
  throw InputError(place, fmt::format("'{0}': a muscle has no parameter '{0}'{1}", field, suggestion(field, names)));
}

std::vector<int> find_muscles(const Model& model, const MuscleUnknownSpec& spec, std::string_view place) {
  std::vector<int> muscles;
  for (const std::string& name : spec.muscles) {
    if (name == "all" && model.muscle(name) < 0) {
      for (std::size_t m = 0; m < model.muscles.size(); ++m) muscles.push_back(static_cast<int>(m));
      continue;
    }
    const int index = model.muscle(name);
    if (index < 0) throw InputError(place, fmt::format("'{}': {}", name, model.no_muscle(name)));
    muscles.push_back(index);
  }
  if (muscles.empty()) throw InputError(place, "names no muscle");
  return muscles;
}

/// Distance from the start that an extent means.
double distance(const Extent& extent, double start) {
  return extent.percent ? 0.01 * extent.value * std::abs(start) : extent.value;
}

void set_bounds(MuscleUnknown& unknown, const MuscleUnknownSpec& spec, std::string_view place) {
  const double reach = unknown.is_delay() ? 0.1 : 0.5 * std::abs(unknown.start);
  // Percent are counted from the start; units are values.
  const auto bound = [&](const std::optional<Extent>& extent, double otherwise) {
    if (!extent) return otherwise;
    return extent->percent ? unknown.start + distance(*extent, unknown.start) : extent->value;
  };
  unknown.low = bound(spec.low, unknown.start - reach);
  unknown.high = bound(spec.high, unknown.start + reach);
  if (!(unknown.low < unknown.high)) {
    throw InputError(place, fmt::format("bounds of '{}' cross: from {:.6g} to {:.6g} {}", unknown.name, unknown.low,
                                        unknown.high, unknown.unit));
  }
  if (!(unknown.low <= unknown.start && unknown.start <= unknown.high)) {
    throw InputError(place, fmt::format("bounds of '{}', {:.6g} to {:.6g}, leave out its start, {:.6g} {}",
                                        unknown.name, unknown.low, unknown.high, unknown.start, unknown.unit));
  }
  if (!unknown.is_delay() && !(unknown.low > 0.0)) {
    const bool angle = std::string_view(unknown.unit) == "rad" && unknown.low == 0.0;
    if (!angle)
      throw InputError(place, fmt::format("the lower bound of '{}' is {:.6g}; must be > 0", unknown.name, unknown.low));
  }
  unknown.prior_sigma = spec.prior ? distance(*spec.prior, unknown.start) : kInfinity;
  if (!(unknown.prior_sigma > 0.0))
    throw InputError(place, fmt::format("the prior's width of '{}' is {:.6g} {}; must be > 0", unknown.name,
                                        unknown.prior_sigma, unknown.unit));
}

}  // namespace

MusculotendonField parameter_field(std::size_t field) {
  if (field == MuscleParameterName::kGain) return {"excitation_gain", "1"};
  if (field == MuscleParameterName::kDelay) return {"excitation_delay", "s"};
  return estimable_field(field);
}

MuscleUnknown make_unknown(const Model& model, const MuscleUnknownSpec& spec, std::string_view place) {
  MuscleUnknown unknown;
  unknown.factor = spec.factor;
  unknown.fixed = spec.fixed;
  if (spec.fields.empty()) throw InputError(place, "names no parameter of a muscle");
  for (const int muscle : find_muscles(model, spec, place)) {
    for (const std::string& field : spec.fields) unknown.parameters.push_back({muscle, find_field(field, place)});
  }
  const MuscleParameterName& first = unknown.parameters.front();
  const bool several = unknown.parameters.size() > 1;
  unknown.name = !spec.name.empty() ? spec.name : full_name(model, first) + (several ? "..." : "");
  unknown.unit = spec.factor ? "1" : parameter_field(first.field).unit;
  for (const MuscleParameterName& p : unknown.parameters) {
    const double value = model_value(model, p);
    if (spec.factor && !(value != 0.0)) {
      throw InputError(
          place, fmt::format("'{}': {} is 0 in the model, which no factor changes", unknown.name, full_name(model, p)));
    }
    if (spec.factor) continue;
    if (p.field != first.field)
      throw InputError(place, fmt::format("'{}' would give {} and {} one value; factor = true scales both",
                                          unknown.name, full_name(model, first), full_name(model, p)));
    if (!spec.start && value != model_value(model, first))
      throw InputError(place, fmt::format("'{}': {} is {:.6g} in the model and {} is {:.6g}; give a start for the one "
                                          "value of both, or factor = true",
                                          unknown.name, full_name(model, first), model_value(model, first),
                                          full_name(model, p), value));
  }
  unknown.start = spec.start.value_or(spec.factor ? 1.0 : model_value(model, first));
  if (!std::isfinite(unknown.start))
    throw InputError(place, fmt::format("the start of '{}' is not a finite number", unknown.name));
  if (!spec.factor && parameter_field(first.field).unit == std::string_view("rad") && unknown.start == 0.0) {
    throw InputError(
        place, fmt::format("'{}' is 0, where nothing depends on it to first order; give a start > 0", unknown.name));
  }
  set_bounds(unknown, spec, place);
  return unknown;
}

MuscleUnknown unknown_of(const Model& model, const MuscleParameterName& name) {
  return make_unknown(model,
                      {.name = full_name(model, name),
                       .muscles = {std::string(model.muscles[name.muscle].name())},
                       .fields = {parameter_field(name.field).name}},
                      full_name(model, name));
}

std::vector<estimation::ModelParameter> model_parameters(std::span<const MuscleUnknown> unknowns) {
  std::vector<estimation::ModelParameter> parameters;
  for (const MuscleUnknown& u : unknowns) {
    parameters.push_back({.name = u.name,
                          .unit = u.unit,
                          .start = u.start,
                          .low = u.low,
                          .high = u.high,
                          .prior_sigma = u.prior_sigma,
                          .fixed = u.fixed});
  }
  return parameters;
}

void check_unknowns(const Model& model, std::span<const MuscleUnknown> unknowns, std::string_view place) {
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    for (std::size_t a = 0; a < unknowns[i].parameters.size(); ++a) {
      const MuscleParameterName& p = unknowns[i].parameters[a];
      for (std::size_t b = 0; b < a; ++b) {
        if (p == unknowns[i].parameters[b])
          throw InputError(place, fmt::format("'{}' names {} twice", unknowns[i].name, full_name(model, p)));
      }
      for (std::size_t j = 0; j < i; ++j) {
        for (const MuscleParameterName& other : unknowns[j].parameters) {
          if (p == other)
            throw InputError(place, fmt::format("'{}' and '{}' both set {}; one of them has to go", unknowns[j].name,
                                                unknowns[i].name, full_name(model, p)));
        }
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (unknowns[i].name == unknowns[j].name)
        throw InputError(place, fmt::format("two unknowns have the name '{}'", unknowns[i].name));
    }
  }
}

}  // namespace veridyn::muscle
