#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "apps/veridyn/output.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::app {

/// The files of an identification or validation: estimate.json, subject.toml, parameters.csv, flight.csv,
/// coefficients.csv, validation.csv, report.html, run.json; jsbsim.xml where every coefficient was identified.
void write_identification(const std::filesystem::path& folder, const aircraft::FlightStudy& study,
                          const aircraft::FlightAnalysis& analysis, const RunRecord& run, const CommonOptions& options);

/// The files of a reconstruction: flight.csv (smoother), filter.csv, report.html, run.json.
void write_reconstruction(const std::filesystem::path& folder, const aircraft::FlightStudy& study,
                          const aircraft::FlightAnalysis& analysis, const RunRecord& run, const CommonOptions& options);

/// Parameters as a table: name, value, sigma, low95, high95, unit, status.
[[nodiscard]] std::string parameters_csv(const estimation::Estimate& estimate);

/// The verdict for people, a line a coefficient.
void tell_identification(const aircraft::FlightAnalysis& analysis, const std::filesystem::path& folder,
                         const CommonOptions& options);

/// The same for machines.
[[nodiscard]] nlohmann::ordered_json summary_of(const aircraft::FlightAnalysis& analysis,
                                                const std::filesystem::path& folder);

}  // namespace veridyn::app
