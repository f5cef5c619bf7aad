#include "veridyn/aircraft/absent_surfaces.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "veridyn/core/index.hpp"

namespace veridyn::aircraft {
namespace {

/// Takes the terms of a variable off a coefficient. @return whether there were any
bool drop_terms(CoefficientModel& model, AeroVariable variable) {
  bool any = false;
  for (std::size_t i = model.terms.size(); i-- > 0;) {
    if (!model.terms[i].uses(variable)) continue;
    model.terms.erase(model.terms.begin() + signed_index(i));
    model.values.erase(model.values.begin() + signed_index(i));
    any = true;
  }
  return any;
}

}  // namespace

std::vector<std::string> without_absent_surfaces(AeroModel& model, const StudyTable& subject,
                                                 const std::function<bool(std::string_view)>& recorded) {
  constexpr std::array<std::pair<std::string_view, AeroVariable>, 2> kLateral{
      {{"rudder", AeroVariable::kDr}, {"aileron", AeroVariable::kDa}}};
  std::vector<std::string> notes;
  if (subject.has("builtin") || (!recorded("rudder") && !recorded("aileron"))) return notes;
  const StudyTable actuators = subject.table_or_empty("actuators");
  for (const auto& [name, variable] : kLateral) {
    if (recorded(name) || actuators.has(name)) continue;
    bool any = false;
    for (const Coefficient c : enumerators<Coefficient, kCoefficients>())
      if (CoefficientModel* of = model.find(c)) any = drop_terms(*of, variable) || any;
    if (!any) continue;
    notes.push_back(fmt::format(
        "no {0} is recorded, and the study describes none: the aircraft is taken for one without it, and its "
        "terms are left out; [subject.actuators.{0}] says that there is one",
        name));
  }
  return notes;
}

}  // namespace veridyn::aircraft
