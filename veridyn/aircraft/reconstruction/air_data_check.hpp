#pragma once

#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"

/// Inside of reconstruct_solve: errors of vanes and pitot tube without a model of the aircraft.
namespace veridyn::aircraft::internal {

/// Errors of the air data from what is true whatever pilot and airframe make of a gust: the airspeed over the headings
/// flown, the vanes against attitude, ground velocity and mean wind, the alpha vane in manoeuvres with the elevator as
/// instrument (air_data_consistency.hpp), each weighed with its prior. One that these do not see beyond three standard
/// errors and what the rows of a recording allow (2 % of the airspeed, 0.5 deg, 10 % of a slope) is not applied: a
/// clean flight's answer is not moved by asking. Of a scale and a bias of the pitot tube only the scale is found.
[[nodiscard]] AirDataErrors check_air_data_errors(const RunSetting& base, const SolveTask& task);

}  // namespace veridyn::aircraft::internal
