#include "veridyn/report/aircraft_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/aircraft_figures.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/time_range.hpp"
#include "veridyn/report/parts/aircraft_estimates.hpp"
#include "veridyn/report/parts/aircraft_evidence.hpp"
#include "veridyn/report/parts/aircraft_flights.hpp"
#include "veridyn/report/parts/aircraft_sensors.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/open_loop_section.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

std::vector<std::string> meanings(std::span<const CoefficientResult> results, estimation::GroupVerdict verdict) {
  std::vector<std::string> names;
  for (const CoefficientResult& r : results) {
    if (r.verdict == verdict) names.push_back(fmt::format("{} ({})", meaning_of(r.coefficient), r.name));
  }
  return names;
}

/// The coefficients by what became of them.
std::vector<Fact> outcomes_of(const FlightAnalysis& analysis) {
  std::vector<Fact> facts;
  using estimation::GroupVerdict;
  for (const auto& [group, word] :
       {std::pair{GroupVerdict::kIdentified, "Identified"}, std::pair{GroupVerdict::kEffective, "Predicts only"},
        std::pair{GroupVerdict::kRejected, "Rejected"},
        std::pair{GroupVerdict::kNotExcited, "Not excited by this flight"},
        std::pair{GroupVerdict::kSkipped, "Not attempted"}}) {
    const std::vector<std::string> names = meanings(analysis.coefficients, group);
    if (!names.empty()) facts.push_back({word, fmt::format("{}", fmt::join(names, ", "))});
  }
  return facts;
}

/// "flight1.csv, flight2.csv", or where the only flight is from.
std::string recording_text(const FlightStudy& study, const FlightAnalysis& analysis) {
  if (study.truth) return "simulated from the study";
  if (analysis.flights.size() < 2) return std::filesystem::path(study.mapped.recording.source).filename().string();
  std::vector<std::string> names;
  for (const PreparedFlight& flight : analysis.flights) names.push_back(flight.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<Fact> facts_of(const FlightStudy& study, const FlightAnalysis& analysis) {
  std::vector<Fact> facts{{"Aircraft", study.subject.name},
                          {"Recording", recording_text(study, analysis)},
                          {"Log", study.mapped.log_kind},
                          {"Mass", fmt::format("{:.4g} kg", study.subject.mass)}};
  double recorded = 0.0, airborne = 0.0, longitudinal = 0.0, lateral = 0.0;
  for (const PreparedFlight& flight : analysis.flights) {
    recorded += flight.aligned.recording.span().duration();
    for (const TimeSpan& s : flight.segments.airborne) airborne += s.duration();
    longitudinal += flight.segments.longitudinal.excited_s();
    lateral += flight.segments.lateral.excited_s();
  }
  facts.push_back({"Recorded", fmt::format("{:.0f} s", recorded)});
  if (airborne > 0.0) {
    facts.push_back({"In the air", fmt::format("{:.0f} s", airborne)});
    facts.push_back({"Excited", fmt::format("{:.0f} s longitudinal, {:.0f} s lateral", longitudinal, lateral)});
  }
  if (!study.subject.sign_convention.empty()) facts.push_back({"Signs", study.subject.sign_convention});
  return facts;
}

std::string holdout_text(const FlightStudy& study) {
  if (!(study.segments.holdout > 0.0)) return "whole recordings, or none";
  return fmt::format("{:.0f} % of the excited time, in blocks of {:.0f} s", 100.0 * study.segments.holdout,
                     study.segments.block_s);
}

/// How airspeed and flow angles, and the parameters, were found.
std::string method_text(const FlightStudy& study, const FlightAnalysis& analysis) {
  const FilterKind filter = std::ranges::find_if(analysis.flights, &PreparedFlight::usable)->reconstruction.filter;
  const std::string motion =
      filter == FilterKind::kNone
          ? "airspeed and flow angles are taken as recorded, without a filter"
          : fmt::format(
                "a {} extended Kalman filter with Dryden gust states and its fixed-interval smoother give "
                "airspeed, flow angles and wind",
                to_string(filter));
  const std::string estimator =
      study.identify.choose_output_error
          ? "the parameters of an axis are moved together until the motion integrated from the recorded deflections "
            "fits (output error)"
          : "coefficients follow from the rigid-body equations; each is estimated by ordinary, total and generalised "
            "total least squares on the same samples, with the regressors' errors propagated from the sensors";
  return fmt::format(
      "Sensors are brought onto one clock; {}; all signals pass one zero-phase filter; {}; what is recommended has "
      "passed the checks above and predicts the hold-out.",
      motion, estimator);
}

Section method_section(const FlightStudy& study, const FlightAnalysis& analysis) {
  Section section{.title = "How it was done", .id = "method", .folded = true};
  const FlightSignals& s = std::ranges::find_if(analysis.flights, &PreparedFlight::usable)->signals;
  std::vector<Fact> facts{
      {"Study", study.name},
      {"Seed", std::to_string(study.seed)},
      {"Common grid", fmt::format("{:.0f} Hz, every {}. sample regressed on", s.grid.rate_Hz(), s.stride)},
      {"Pass band", fmt::format("0 to {:.1f} Hz, zero phase", s.filter.pass_Hz)},
      {"Hold-out", holdout_text(study)},
      {"Estimator", study.identify.method_name()}};
  for (const FlightSignal which : {FlightSignal::kAlpha, FlightSignal::kBeta, FlightSignal::kP, FlightSignal::kAz}) {
    const GridSignal& signal = s[which];
    if (!signal.available()) continue;
    const bool angle = which != FlightSignal::kAz;
    facts.push_back({fmt::format("{} regressed on", kFlightSignalNames[which]),
                     fmt::format("{}, error {:.3g} {}", signal.origin, angle ? signal.sigma / kDegree : signal.sigma,
                                 which == FlightSignal::kP ? "deg/s" : (angle ? "deg" : "m/s^2"))});
  }
  section.blocks.emplace_back(FactList{std::move(facts)});
  section.blocks.emplace_back(Paragraph{.text = method_text(study, analysis)});
  return section;
}

}  // namespace

Document identification_report(const FlightStudy& study, const FlightAnalysis& analysis,
                               const AircraftReportContext& context) {
  const bool given = context.command == "validate";
  Document document = started_document(
      fmt::format("{}: aerodynamic model", study.subject.name),
      given ? (analysis.flights.size() > 1 ? "A given estimate validated on these flights"
                                           : "A given estimate validated on this flight")
            : (analysis.flights.size() > 1 ? "Identified from several flights" : "Identified from flight"),
      context.program);
  document.verdict = verdict_of(analysis.estimate);
  for (TimeSeries& figure : coefficient_lead(analysis, given)) document.lead.emplace_back(std::move(figure));
  document.facts = outcomes_of(analysis);
  for (Fact& fact : facts_of(study, analysis)) document.facts.push_back(std::move(fact));
  const auto add = [&](Section section, bool shown = true) {
    if (shown && !section.blocks.empty()) document.sections.push_back(std::move(section));
  };
  const bool several = analysis.flights.size() > 1;
  const bool motion = std::ranges::any_of(analysis.flights, &PreparedFlight::usable);
  /// From take-off to landing; of several with the name of the recording in its title, and on its own clock.
  const auto of = [&](Section section, std::size_t flight) {
    if (const std::optional<Window> range = flown_range(analysis.flights[flight]))
      show_range(section, *range, several ? fmt::format("time_{}", flight + 1) : "time");
    if (!several) return section;
    section.title = fmt::format("{}: {}", section.title, analysis.flights[flight].name);
    section.id = fmt::format("{}_{}", section.id, flight + 1);
    return section;
  };
  add(parameters_section(analysis, ""), !given);
  add(derived_section(analysis.estimate, "Modes and flying qualities",
                      "Small motions about straight and level flight with the controls held, by the identified "
                      "coefficients. Intervals are of their covariance. Levels are of MIL-F-8785C, for piloted "
                      "aircraft."));
  add(coefficients_section(analysis));
  add(evidence_section(analysis.estimate));
  add(methods_section(analysis), !given);
  add(other_estimators_section(analysis));
  add(structure_section(analysis));
  add(validation_section(analysis));
  add(open_loop_section(analysis.open_loop));
  add(flights_section(analysis));
  for (std::size_t i = 0; i < analysis.flights.size(); ++i) {
    if (!analysis.flights[i].usable()) continue;
    Section flight = of(flight_section(study, analysis.flights[i]), i);
    flight.folded = true;
    add(std::move(flight));
  }
  add(coefficient_series_section(analysis));
  add(excitation_section(analysis), !given && motion);
  add(residual_section(analysis), !given);
  add(uncertainty_section(analysis.uncertainty), analysis.uncertainty.available());
  for (std::size_t i = 0; i < analysis.flights.size(); ++i) add(of(sensors_section(analysis.flights[i]), i));
  add_warnings(document, analysis.estimate.warnings);
  add(rejected_section(analysis));
  if (motion) add(method_section(study, analysis));
  return document;
}

Document reconstruction_report(const FlightStudy& study, const FlightAnalysis& analysis,
                               const AircraftReportContext& context) {
  Document document = started_document(fmt::format("{}: motion through the air", study.subject.name),
                                       "Airspeed, flow angles and wind from the recording", context.program);
  document.facts = facts_of(study, analysis);
  const PreparedFlight& flight = analysis.flights.front();
  if (const std::optional<Contradiction>& contradiction = flight.reconstruction.contradiction) {
    document.verdict.level = Level::kBad;
    document.verdict.word = "Contradiction";
    document.verdict.headline = contradiction->statement + ".";
    if (!flight.reconstruction.smoothed.channels().empty()) document.sections.push_back(flight_section(study, flight));
    document.sections.push_back(sensors_section(flight));
    add_warnings(document, flight.reconstruction.warnings);
    return document;
  }
  std::vector<std::string> weak;
  for (const QuantityReport& q : flight.reconstruction.quantities) {
    const bool air_data =
        q.quantity == "airspeed" || q.quantity == "alpha" || q.quantity == "beta" || q.quantity.starts_with("wind");
    if (air_data && q.observability != Observability::kObservable) weak.push_back(q.quantity);
  }
  if (!flight.reconstruction.smoothed.has("wind_north")) weak.emplace_back("wind");
  document.verdict.level = weak.empty() ? Level::kGood : Level::kCaution;
  document.verdict.word = weak.empty() ? "Observable" : "Partly observable";
  document.verdict.headline =
      weak.empty()
          ? "Airspeed, flow angles and wind are determined by the sensors of this flight."
          : fmt::format("The sensors of this flight do not determine {}: mind the bands.", fmt::join(weak, ", "));
  document.sections.push_back(flight_section(study, flight));
  document.sections.push_back(sensors_section(flight));
  if (const std::optional<Window> range = flown_range(flight))
    for (Section& section : document.sections) show_range(section, *range, "time");
  add_warnings(document, flight.reconstruction.warnings);
  return document;
}

}  // namespace veridyn::report
