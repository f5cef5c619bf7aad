#include "apps/veridyn/results/aircraft_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/open_loop_results.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/aircraft/export/jsbsim_export.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/numerics/threads/parallel.hpp"
#include "veridyn/report/aircraft_report.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::aircraft;

std::string structure_csv(const FlightAnalysis& analysis) {
  std::string text = "coefficient,action,term,terms,F,residual_sd,r2,r2_change,press,pse,in_model,reason\n";
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.structure) continue;
    for (const estimation::StructureStep& s : r.structure->history) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},\"{}\"\n", name_of(r.coefficient),
                          estimation::to_string(s.action), s.term, s.terms, s.F, s.residual_sd, s.r2, s.r2_change,
                          s.press, s.pse, s.in_model ? 1 : 0, s.reason);
    }
  }
  return text;
}

std::string sensor_errors_csv(const Reconstruction& r) {
  std::string text = "name,value,sigma,prior_sigma,unit,information,correlation,correlated_with,observability\n";
  for (const SensorErrorReport& e : r.sensor_errors) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", e.name, e.value, e.sigma, e.prior_sigma, e.unit, e.information,
                        e.correlation, e.correlated_with, aircraft::to_string(e.observability));
  }
  return text;
}

bool searched_structure(const FlightAnalysis& analysis) {
  return std::any_of(analysis.coefficients.begin(), analysis.coefficients.end(),
                     [](const CoefficientResult& r) { return r.structure.has_value(); });
}

std::string filter_errors_csv(const Reconstruction& r) {
  std::string text =
      "quantity,unit,signal_sd,free_filter_rms,free_smoother_rms,free_filter_bound,free_smoother_bound,"
      "model_filter_rms,model_smoother_rms,model_filter_bound,model_smoother_bound\n";
  for (const FilterError& e : r.comparison) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", e.quantity, e.unit, e.signal_sd, e.model_free.filter_rms,
                        e.model_free.smoother_rms, e.model_free.filter_bound, e.model_free.smoother_bound,
                        e.model_based.filter_rms, e.model_based.smoother_rms, e.model_based.filter_bound,
                        e.model_based.smoother_bound);
  }
  return text;
}

/// The tables of a reconstruction that there are; `number` of one of several flights: "_2".
void write_filter_tables(OutputFolder& folder, const Reconstruction& r, const std::string& number = {}) {
  if (!r.sensor_errors.empty()) folder.write("sensor_errors" + number + ".csv", sensor_errors_csv(r));
  if (!r.innovations.channels().empty()) folder.write("innovations" + number + ".csv", io::to_csv(r.innovations));
  if (!r.comparison.empty()) folder.write("filter_errors" + number + ".csv", filter_errors_csv(r));
}

/// At most `rate_Hz` samples a second of each channel: an hour at 100 Hz with all its bands would be 300 MB of text.
Recording thinned(const Recording& recording, double rate_Hz) {
  Recording result;
  result.source = recording.source;
  result.frame = recording.frame;
  std::map<const std::vector<double>*, TimeBase> bases;
  for (const Channel& channel : recording.channels()) {
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(channel.rate_Hz() / rate_Hz)));
    TimeBase& base = bases[channel.time.get()];
    if (!base) {
      std::vector<double> stamps;
      for (std::size_t i = 0; i < channel.size(); i += stride) stamps.push_back(channel.times()[i]);
      base = make_time_base(std::move(stamps));
    }
    Channel part{channel.name, channel.unit, channel.recorded_unit, base, {}};
    for (std::size_t i = 0; i < channel.size(); i += stride) part.value.push_back(channel.value[i]);
    result.add(std::move(part));
  }
  return result;
}

constexpr double kFlightCsvRate_Hz = 20.0;

Recording coefficient_recording(const FlightAnalysis& analysis) {
  Recording recording;
  recording.source = "coefficients.csv";
  recording.frame = Frame::kFrd;
  for (const CoefficientResult& r : analysis.coefficients) {
    if (r.time.empty()) continue;
    const TimeBase time = make_time_base(r.time);
    const char* unit = r.per_unit_inertia ? "1/kg/m^2" : "1";
    recording.add(make_channel(r.name, unit, time, r.measured));
    if (r.verdict == estimation::GroupVerdict::kIdentified) {
      recording.add(make_channel(fmt::format("{}_model", r.name), unit, time, r.modelled));
    }
  }
  return recording;
}

Recording validation_recording(const Validation& validation) {
  Recording recording;
  recording.source = "validation.csv";
  for (const PredictedQuantity& q : validation.quantities) {
    const TimeBase time = make_time_base(q.time);
    const char* unit = q.unit == "deg" ? "rad" : "m/s";
    recording.add(make_channel(q.name, unit, time, q.measured));
    recording.add(make_channel(q.name + "_model", unit, time, q.predicted));
  }
  return recording;
}

void write_identification(const StudyRun& run, OutputFolder& folder, const FlightStudy& study,
                          const FlightAnalysis& analysis) {
  report::AircraftReportContext context{.program = program_name()};
  context.command = run.command;
  const std::size_t count = analysis.flights.size();
  std::string page, coefficients, validation;  // the large texts
  std::vector<std::string> flights(count);
  numerics::parallel_for(3 + count, run.options().threads, [&](std::size_t k) {
    if (k == 0)
      page = report::to_html(report::identification_report(study, analysis, context));
    else if (k == 1)
      coefficients = io::to_csv(coefficient_recording(analysis));
    else if (k == 2 + count)
      validation = io::to_csv(validation_recording(analysis.validation));
    else
      flights[k - 2] = io::to_csv(thinned(analysis.flights[k - 2].reconstruction.smoothed, kFlightCsvRate_Hz));
  });
  folder.write("coefficients.csv", coefficients);
  if (analysis.validation.available()) folder.write("validation.csv", validation);
  write_open_loop(folder, analysis.open_loop, Frame::kFrd);
  folder.write("report.html", page);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string number = count == 1 ? std::string() : fmt::format("_{}", k + 1);
    folder.write("flight" + number + ".csv", flights[k]);
    write_filter_tables(folder, analysis.flights[k].reconstruction, number);
  }
  if (searched_structure(analysis)) folder.write("structure.csv", structure_csv(analysis));
  if (analysis.uncertainty.available()) folder.write("coefficient_uncertainty.csv", to_csv(analysis.uncertainty));
  folder.write("subject.toml",
               estimation::graded_toml(write_subject_toml(analysis.identified), analysis.estimate.judgement));
  // `veridyn export` writes one of what is partly known, and flies it.
  const Subject& identified = analysis.identified;
  const std::optional<ExportCondition> condition = condition_of(analysis.estimate);
  if (condition && identified.inertia && identified.model.unknown_parameters().empty())
    folder.write(
        "jsbsim.xml",
        graded_xml(jsbsim_file(complete_subject(identified, identified, &analysis.estimate, *condition), nullptr),
                   analysis.estimate.judgement));
}

}  // namespace

void write_reconstruction(OutputFolder& folder, const FlightStudy& study, const FlightAnalysis& analysis) {
  folder.write("report.html",
               report::to_html(report::reconstruction_report(study, analysis, {.program = program_name()})));
  folder.write("flight.csv", io::to_csv(analysis.flights.front().reconstruction.smoothed));
  folder.write("filter.csv", io::to_csv(analysis.flights.front().reconstruction.filtered));
  write_filter_tables(folder, analysis.flights.front().reconstruction);
}

std::vector<std::filesystem::path> inputs_of(std::span<const FlightStudy> studies) {
  std::vector<std::filesystem::path> inputs;
  for (const FlightStudy& study : studies) {
    for (const std::filesystem::path& file : study.inputs)
      if (std::ranges::find(inputs, file) == inputs.end()) inputs.push_back(file);
  }
  return inputs;
}

void publish_identification(const StudyRun& run, OutputFolder& folder, std::span<const FlightStudy> studies,
                            const FlightAnalysis& analysis) {
  write_identification(run, folder, studies.front(), analysis);
  MoreResults more{.lines = open_loop_lines(analysis.open_loop)};
  if (analysis.open_loop.available()) more.summary.emplace_back("open_loop", open_loop_summary(analysis.open_loop));
  publish_analysis(folder, run.record(studies.front().seed, inputs_of(studies)), run.options(), analysis, more);
}

}  // namespace veridyn::app
