#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::app {

/// The files that the flights were read from, each once.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(std::span<const aircraft::FlightStudy> studies);

/// Writes, publishes and prints an identification or validation: estimate.json, subject.toml, parameters.csv,
/// flight.csv, coefficients.csv, validation.csv, report.html, run.json; jsbsim.xml where every coefficient was
/// identified. Of several flights flight_1.csv, flight_2.csv, ... in place of flight.csv.
/// @param studies  a flight each
void publish_identification(const StudyRun& run, OutputFolder& folder, std::span<const aircraft::FlightStudy> studies,
                            const aircraft::FlightAnalysis& analysis);

/// The files of a reconstruction: flight.csv (smoother), filter.csv, report.html.
void write_reconstruction(OutputFolder& folder, const aircraft::FlightStudy& study,
                          const aircraft::FlightAnalysis& analysis);

}  // namespace veridyn::app
