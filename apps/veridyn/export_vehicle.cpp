// veridyn export STUDY of a vehicle: its subject, its numbers as a table, and its tyres for programs that read .tir.
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <variant>

#include "apps/veridyn/results/export_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/tyre/tir_writer.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;
using CurvedTyres = AxleTyres<SimpleMagicFormulaTyre<double>>;

std::string numbers_csv(const Vehicle& vehicle, const std::optional<estimation::Estimate>& estimate) {
  std::string text = "name,value,sigma,unit,meaning\n";
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const VehicleField& field = kVehicleFields[i];
    const double value = field_of(vehicle.parameters, i);
    if (!std::isfinite(value)) continue;
    const estimation::Parameter* p = estimate ? estimate->find(field.name) : nullptr;
    const std::string sigma = p != nullptr && std::isfinite(p->sigma) ? fmt::format("{}", p->sigma) : std::string();
    text += fmt::format("{},{},{},{},{}\n", field.name, value, sigma, field.unit, field.meaning);
  }
  return text;
}

/// What a reader of a tyre file has to know of where its numbers come from: a line each.
std::vector<std::string> comments_on(const Vehicle& vehicle, const char* axle,
                                     const std::optional<estimation::Estimate>& estimate) {
  std::vector<std::string> lines{fmt::format("{} tyre of {}, written by {}", axle, vehicle.name, program_name())};
  if (!estimate) return lines;
  lines.emplace_back("identified from a drive; value +- standard error (interval of 95 %):");
  for (const char* name :
       {"C_f", "C_r", "mu", "C", "E", "load_transfer", "load_transfer_loss", "load_transfer_balance"}) {
    const estimation::Parameter* p = estimate->find(name);
    if (p == nullptr) continue;
    lines.push_back(fmt::format("  {} = {:.5g} +- {:.2g} {} ({:.5g} to {:.5g}), {}", name, p->value, p->sigma, p->unit,
                                p->low95, p->high95, estimation::to_string(p->status)));
  }
  if (estimate->find("load_transfer_loss") != nullptr)
    lines.emplace_back("load transfer is the axles' and not in the coefficients below");
  lines.emplace_back("driving and braking: stiffness 1.3 times that of cornering, assumed; the same curve");
  if (is_graded(estimate)) lines.push_back(estimation::sentence_of(*estimate));
  return lines;
}

}  // namespace

int export_vehicle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const StudyTable& root = run.study.root();
  Vehicle vehicle = read_vehicle(root.table("subject"), VehicleNeeds::kGeometry);
  finish_drive_study(root, Progress());
  const std::optional<estimation::Estimate> estimate = given_estimate(run);
  if (estimate) {
    if (estimate->find("C_f") == nullptr)
      throw InputError(run.arguments.text("--estimate-file"), "is not an estimate of a vehicle: it has no C_f");
    const VehicleIdentifyOptions options = VehicleIdentifyOptions::keys().read(root.table_or_empty("identify"));
    vehicle = estimated_vehicle(std::move(vehicle), estimate->parameters, options.model);
  }
  const std::string& format = run.arguments.text("--format");
  const auto desired = [&](const char* name) { return format == "all" || format == name; };
  const auto* curved = std::get_if<CurvedTyres>(&vehicle.tyres);
  if (format == "json" || format == "jsbsim")
    throw InputError(run.path.string(),
                     fmt::format("--format {} is for aircraft; a vehicle has toml, csv and tir", format));
  if (format == "tir" && curved == nullptr)
    throw InputError(run.path.string(), fmt::format("has {} tyres, of which there is no .tir: identify it with "
                                                    "identify.tyre = \"magic formula\"",
                                                    vehicle.tyre_text));
  const bool graded = is_graded(estimate);
  const std::string toml = write_vehicle_toml(vehicle);
  if (desired("toml")) {
    folder.write("subject.toml", graded ? estimation::graded_toml(toml, estimate->judgement)
                                        : toml + estimation::grades_table(root.table("subject")));
  }
  if (desired("csv")) folder.write("model.csv", numbers_csv(vehicle, estimate));
  if (desired("tir") && curved != nullptr) {
    folder.write("tyre_front.tir", write_tir(curved->front, {.comments = comments_on(vehicle, "front", estimate),
                                                             .vertical_stiffness = vehicle.parameters.K_tf}));
    folder.write("tyre_rear.tir", write_tir(curved->rear, {.comments = comments_on(vehicle, "rear", estimate),
                                                           .vertical_stiffness = vehicle.parameters.K_tr}));
  }
  const bool lacks_tyres = format == "all" && curved == nullptr;
  MoreResults more;
  if (lacks_tyres) more.lines.push_back(fmt::format("no .tir: the tyres are {}", vehicle.tyre_text));
  publish_export(run, folder, vehicle.inputs, estimate, more);
  return kDone;
}

}  // namespace veridyn::app
