#include "veridyn/aircraft/export/complete_subject.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>

#include "veridyn/aircraft/export/handbook.hpp"
#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Estimate;
using estimation::Parameter;
using estimation::ParameterStatus;

double moment_of_inertia(const Inertia& inertia, Coefficient c) {
  return c == Coefficient::kCl ? inertia.Jx : c == Coefficient::kCm ? inertia.Jy : inertia.Jz;
}

/// "identified, 95 %: 3.1 to 4.2".
std::string interval_text(const Parameter& p, double factor = 1.0) {
  return fmt::format("{}, 95 %: {:.4g} to {:.4g}", to_string(p.status), factor * p.low95, factor * p.high95);
}

/// Whether the sign of a value is more than a guess.
bool determined(const Parameter& p) {
  return p.status == ParameterStatus::kIdentified || p.status == ParameterStatus::kWeak ||
         p.status == ParameterStatus::kEffective || p.status == ParameterStatus::kFixed;
}

/// What is known before anything is estimated.
struct Sources {
  const Subject& known;
  const Subject& study;
  const Estimate* estimate;
  std::optional<Inertia> estimated_inertia;  ///< where the study has none

  [[nodiscard]] const Parameter* parameter(const std::string& name) const {
    return estimate != nullptr ? estimate->find(name) : nullptr;
  }
};

std::optional<double> value_in(const Subject& s, Coefficient c, const Term& term) {
  const CoefficientModel* model = s.model.find(c);
  if (model == nullptr) return std::nullopt;
  const auto at = std::ranges::find(model->terms, term);
  if (at == model->terms.end()) return std::nullopt;
  const double value = model->values[static_cast<std::size_t>(at - model->terms.begin())];
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The value that the flight or the study gives.
std::optional<SourcedValue> known_value(const Sources& from, Coefficient c, const Term& term) {
  const std::string name = parameter_name(c, term);
  if (const std::optional<double> value = value_in(from.known, c, term)) {
    const Parameter* p = from.parameter(name);
    if (p != nullptr && p->value == *value) return SourcedValue{name, *value, ValueOrigin::kFlight, interval_text(*p)};
    return SourcedValue{name, *value, ValueOrigin::kStudy, "the study's"};
  }
  if (from.estimated_inertia && per_unit_inertia(c, from.study)) {
    const Parameter* p = from.parameter(regressed_parameter_name(c, term, from.study));
    if (p != nullptr && std::isfinite(p->value) && p->status != ParameterStatus::kRejected) {
      const double J = moment_of_inertia(*from.estimated_inertia, c);
      return SourcedValue{name, J * p->value, ValueOrigin::kFlight,
                          interval_text(*p, J) + ", times the estimated moment of inertia"};
    }
  }
  if (const std::optional<double> value = value_in(from.study, c, term))
    return SourcedValue{name, *value, ValueOrigin::kStudy, "the study's, not identified"};
  return std::nullopt;
}

/// Sign of the first of these derivatives that is known, times its own sign where the surface is counted as textbooks
/// do; otherwise +1.
double sign_of(const Sources& from, AeroVariable surface, std::initializer_list<std::pair<Coefficient, double>> of) {
  for (const auto& [coefficient, textbook] : of) {
    const Term term{std::string(kAeroVariableNames[surface]), {{.variable = surface}}};
    const std::optional<SourcedValue> value = known_value(from, coefficient, term);
    if (!value || value->value == 0.0) continue;
    const Parameter* p = from.parameter(value->name);
    if (value->origin == ValueOrigin::kFlight && p != nullptr && !determined(*p)) continue;
    return value->value * textbook > 0.0 ? 1.0 : -1.0;
  }
  return 1.0;
}

SurfaceSigns signs_of(const Sources& from) {
  using C = Coefficient;
  return {.elevator = sign_of(from, AeroVariable::kDe, {{C::kCm, -1.0}, {C::kCL, 1.0}}),
          .aileron = sign_of(from, AeroVariable::kDa, {{C::kCl, -1.0}}),
          .rudder = sign_of(from, AeroVariable::kDr, {{C::kCn, -1.0}, {C::kCY, 1.0}})};
}

/// Whether the study models an axis and its surface nowhere: an aircraft without a rudder.
bool surface_absent(const Subject& study, const Term& term) {
  const auto absent = [&](AeroVariable surface, std::initializer_list<Coefficient> axis) {
    if (!term.uses(surface)) return false;
    bool modelled = false, used = false;
    for (const Coefficient c : axis) {
      const CoefficientModel* model = study.model.find(c);
      if (model == nullptr) continue;
      modelled = true;
      used = used || std::ranges::any_of(model->terms, [&](const Term& t) { return t.uses(surface); });
    }
    return modelled && !used;
  };
  const auto lateral = {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn};
  return absent(AeroVariable::kDe, {Coefficient::kCL, Coefficient::kCm}) || absent(AeroVariable::kDa, lateral) ||
         absent(AeroVariable::kDr, lateral);
}

/// Terms that a coefficient is exported with.
std::vector<Term> exported_terms(const Sources& from, Coefficient c) {
  const CoefficientModel* known = from.known.model.find(c);
  if (known != nullptr && known->size() > 0 && known->known()) return known->terms;
  std::vector<Term> terms;
  const auto add = [&](const Term& term) {
    if (std::ranges::find(terms, term) == terms.end()) terms.push_back(term);
  };
  if (known != nullptr) std::ranges::for_each(known->terms, add);
  if (const CoefficientModel* study = from.study.model.find(c)) std::ranges::for_each(study->terms, add);
  // What was identified by unit inertia is a model by itself, as one of a whole coefficient is.
  const bool identified = from.estimated_inertia && !terms.empty() && std::ranges::all_of(terms, [&](const Term& t) {
                            return known_value(from, c, t).has_value();
                          });
  if (identified) return terms;
  for (const Term& term : handbook_terms(c))
    if (!surface_absent(from.study, term)) add(term);
  return terms;
}

double evaluated(const Subject& s, double alpha, Coefficient c, double airspeed) {
  AeroVariables<double> v;
  v.alpha = alpha;
  v.Va = airspeed;
  const AeroCoefficients<double> all = s.model.evaluate(v);
  return select(all, c);
}

/// Level flight of a subject whose lift is complete, by bisection between -20 and 20 deg.
HandbookFlight level_flight(const Subject& s, const ExportCondition& at) {
  HandbookFlight flight;
  flight.CL = s.mass * kGravity / (0.5 * at.density * at.airspeed * at.airspeed * s.wing_area);
  double low = -20.0 * kDegree, high = 20.0 * kDegree;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (evaluated(s, middle, Coefficient::kCL, at.airspeed) < flight.CL ? low : high) = middle;
  }
  flight.alpha = 0.5 * (low + high);
  const double h = 1e-4;
  flight.CL_alpha = (evaluated(s, flight.alpha + h, Coefficient::kCL, at.airspeed) -
                     evaluated(s, flight.alpha - h, Coefficient::kCL, at.airspeed)) /
                    (2.0 * h);
  return flight;
}

void complete_coefficient(const Sources& from, Coefficient c, const HandbookFlight& flight, const SurfaceSigns& signs,
                          CompletedSubject& out) {
  CoefficientModel model{c, exported_terms(from, c), {}};
  for (const Term& term : model.terms) {
    SourcedValue value{parameter_name(c, term), 0.0, ValueOrigin::kZero, "not known: left zero"};
    if (const auto known = known_value(from, c, term))
      value = *known;
    else if (const auto estimate = handbook_value(from.study, flight, signs, c, term))
      value = {value.name, estimate->value, ValueOrigin::kHandbook, "estimate: " + estimate->source};
    model.values.push_back(value.value);
    out.values.push_back(std::move(value));
  }
  if (model.size() > 0) out.subject.model.set(std::move(model));
}

void complete_engine(const HandbookFlight& flight, CompletedSubject& out) {
  Propulsion& engine = out.subject.propulsion;
  if (engine.kind != PropulsionKind::kNone) return;
  const ExportCondition& at = out.condition;
  const double qS = 0.5 * at.density * at.airspeed * at.airspeed * out.subject.wing_area;
  const double drag = qS * evaluated(out.subject, flight.alpha, Coefficient::kCD, at.airspeed);
  // A drag that makes no sense leaves an engine of a tenth of the weight.
  const double full = std::max(2.0 * drag, 0.1 * out.subject.mass * kGravity);
  engine.kind = PropulsionKind::kPolynomial;
  engine.polynomial = {{.throttle_power = 1, .airspeed_power = 0, .value = full}};
  out.values.push_back(
      {"thrust at full throttle", full, ValueOrigin::kHandbook,
       fmt::format("estimate: twice the drag of level flight at {:.4g} m/s, in proportion to throttle", at.airspeed),
       false});
}

/// A name, with the value where that is no measured one.
std::string shown(const SourcedValue& value) {
  return value.origin == ValueOrigin::kHandbook ? fmt::format("{} {:.3g}", value.name, value.value) : value.name;
}

}  // namespace

bool CompletedSubject::all_known() const {
  return std::ranges::none_of(values, [](const SourcedValue& value) {
    return value.origin == ValueOrigin::kHandbook || value.origin == ValueOrigin::kZero;
  });
}

CompletedSubject complete_subject(const Subject& known, const Subject& study, const Estimate* estimate,
                                  const ExportCondition& condition) {
  CompletedSubject out{.subject = known, .values = {}, .condition = condition};
  out.subject.downwash = {};
  Sources from{known, study, estimate, std::nullopt};
  if (!known.inertia) from.estimated_inertia = handbook_inertia(known);
  const SurfaceSigns signs = signs_of(from);
  HandbookFlight flight;
  // Lift comes first: the others are estimated for the angle at which it carries the weight.
  complete_coefficient(from, Coefficient::kCL, flight, signs, out);
  flight = level_flight(out.subject, condition);
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>())
    if (c != Coefficient::kCL) complete_coefficient(from, c, flight, signs, out);
  if (std::ranges::none_of(out.values, [](const SourcedValue& v) {
        return v.origin == ValueOrigin::kFlight || v.origin == ValueOrigin::kStudy;
      }))
    throw InputError(known.name, "no parameter of its model is known, so there is no aircraft to export");
  if (from.estimated_inertia) {
    out.subject.inertia = from.estimated_inertia;
    out.values.push_back({"inertia", from.estimated_inertia->Jy, ValueOrigin::kHandbook,
                          "estimate: radii of gyration, Raymer 2018, table 16.1", false});
  } else {
    out.values.push_back({"inertia", known.inertia->Jy, ValueOrigin::kStudy, "the study's", false});
  }
  complete_engine(flight, out);
  return out;
}

std::vector<std::string> origin_lines(const CompletedSubject& completed) {
  EnumArray<ValueOrigin, std::vector<std::string>, kValueOrigins> names;
  EnumArray<ValueOrigin, std::size_t, kValueOrigins> counts{};
  const std::vector<SourcedValue>& values = completed.values;
  std::size_t at = 0;
  for (const auto& model : completed.subject.model.coefficients) {
    const std::size_t size = model ? model->size() : 0;
    if (size == 0) continue;
    const std::span<const SourcedValue> parameters(values.data() + at, size);
    at += size;
    const ValueOrigin first = parameters.front().origin;
    // A coefficient that is of one origin as a whole is named as one, unless its values are to be looked at.
    const bool whole =
        (first == ValueOrigin::kFlight || first == ValueOrigin::kStudy) &&
        std::ranges::all_of(parameters, [&](const SourcedValue& value) { return value.origin == first; });
    for (const SourcedValue& value : parameters) {
      ++counts[value.origin];
      if (!whole) names[value.origin].push_back(shown(value));
    }
    if (whole) names[first].emplace_back(name_of(model->coefficient));
  }
  for (const SourcedValue& value : std::span(values).subspan(at)) {
    ++counts[value.origin];
    names[value.origin].push_back(shown(value));
  }
  std::vector<std::string> lines;
  for (const ValueOrigin origin : enumerators<ValueOrigin, kValueOrigins>()) {
    if (counts[origin] == 0) continue;
    lines.push_back(
        fmt::format("{:<12} {:>2}: {}", kValueOriginNames[origin], counts[origin], fmt::join(names[origin], ", ")));
  }
  return lines;
}

}  // namespace veridyn::aircraft
