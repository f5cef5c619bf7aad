#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Takes the terms of a surface that the aircraft does not have off the model, so that the axis keeps its others: of
/// the rudder or the aileron, where no recording holds it (`recorded`) and the table `subject` of the study does not
/// describe its actuator. An aircraft that has neither keeps both, and its coefficients are skipped for what is
/// missing.
/// @return a note for each, that says how to keep it
[[nodiscard]] std::vector<std::string> without_absent_surfaces(AeroModel& model, const StudyTable& subject,
                                                               const std::function<bool(std::string_view)>& recorded);

}  // namespace veridyn::aircraft
