#include "veridyn/io/results/estimate_json.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/io/results/json_text.hpp"

namespace veridyn::io {
namespace {

using estimation::Cause;
using estimation::Estimate;
using estimation::Evidence;
using estimation::Grade;
using estimation::Judgement;
using estimation::kAllCauses;
using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::Purpose;
using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

double read_number(const ordered_json& value, const std::string& place) {
  if (value.is_null()) return kNaN;
  if (!value.is_number()) throw InputError(place, "is not a number");
  return value.get<double>();
}

const ordered_json& require(const ordered_json& object, const char* key, const std::string& place) {
  if (!object.is_object() || !object.contains(key)) throw InputError(place, fmt::format("'{}' is missing", key));
  return object[key];
}

std::string read_text(const ordered_json& object, const char* key, const std::string& place) {
  const ordered_json& value = require(object, key, place);
  if (!value.is_string()) throw InputError(fmt::format("{}: {}", place, key), "is not a text");
  return value.get<std::string>();
}

ParameterStatus read_status(const std::string& text, const std::string& place) {
  for (const ParameterStatus status :
       {ParameterStatus::kIdentified, ParameterStatus::kInsignificant, ParameterStatus::kWeak,
        ParameterStatus::kEffective, ParameterStatus::kImplausible, ParameterStatus::kAtBound,
        ParameterStatus::kNotExcited, ParameterStatus::kRejected, ParameterStatus::kFixed}) {
    if (estimation::to_string(status) == text) return status;
  }
  throw InputError(
      place, fmt::format("status '{}' is not one of identified, insignificant, weak, effective, implausible, at_bound, "
                         "not_excited, rejected, fixed",
                         text));
}

/// Files of versions before 0.9 have no schema.
void check_schema(const ordered_json& root, const std::string& file) {
  if (!root.is_object() || !root.contains("schema")) return;
  if (root["schema"] != kEstimateSchema)
    throw InputError(file, fmt::format("has schema {}; this version reads {}", root["schema"].dump(), kEstimateSchema));
}

/// A usable parameter has a value, and no error bar is negative. What was rejected or not excited may have neither.
void check_parameter(const Parameter& p, const std::string& file) {
  const bool usable = p.status != ParameterStatus::kNotExcited && p.status != ParameterStatus::kRejected;
  const std::string place = fmt::format("{}: parameter '{}'", file, p.name);
  if (usable && !std::isfinite(p.value))
    throw InputError(place, fmt::format("has no value, but status {}", estimation::to_string(p.status)));
  if (p.sigma < 0.0) throw InputError(place, fmt::format("sigma is {:g}; must be >= 0", p.sigma));
}

ordered_json grades_of(const Judgement& judgement) {
  ordered_json grades = ordered_json::object();
  for (const Purpose purpose : estimation::kPurposes) {
    const estimation::PurposeGrade& g = judgement.of(purpose);
    grades[std::string(estimation::to_string(purpose))] = {{"grade", std::string(estimation::to_string(g.grade))},
                                                           {"because", g.decided_by}};
  }
  return grades;
}

ordered_json evidence_of(const Evidence& row) {
  ordered_json purposes = ordered_json::array();
  for (const Purpose purpose : estimation::kPurposes)
    if (row.bears_on.contains(purpose)) purposes.push_back(std::string(estimation::to_string(purpose)));
  ordered_json figures = ordered_json::object();
  for (const estimation::Figure& figure : row.figures) {
    if (const double* value = std::get_if<double>(&figure.value))
      figures[figure.key] = number(*value);
    else
      figures[figure.key] = std::get<std::string>(figure.value);
  }
  return {{"check", estimation::name_of(row)},
          {"about", row.about},
          {"cause", estimation::to_string(row.cause)},
          {"outcome", std::string(estimation::to_string(row.outcome))},
          {"value", number(row.value)},
          {"sigma", number(row.sigma)},
          {"limit", number(row.limit)},
          {"unit", estimation::unit_of(row)},
          {"figures", std::move(figures)},
          {"text", estimation::says(row)},
          {"bears_on", std::move(purposes)},
          {"advice", estimation::advice_of(row)}};
}

/// The value of an enumeration by its word.
template <typename Value, std::size_t kCount>
Value read_word(const std::string& text, const std::array<Value, kCount>& values, const std::string& place) {
  for (const Value value : values)
    if (estimation::to_string(value) == text) return value;
  std::string known;
  for (const Value value : values)
    known += fmt::format("{}{}", known.empty() ? "" : ", ", estimation::to_string(value));
  throw InputError(place, fmt::format("'{}' is not one of {}", text, known));
}

std::vector<std::string> read_texts(const ordered_json& array, const std::string& place) {
  if (!array.is_array()) throw InputError(place, "is not an array");
  std::vector<std::string> texts;
  for (const ordered_json& text : array) {
    if (!text.is_string()) throw InputError(place, "holds something that is not a text");
    texts.push_back(text.get<std::string>());
  }
  return texts;
}

/// Of the whole; files of versions before 0.5 have no grades.
Judgement read_grades(const ordered_json& root, const std::string& file) {
  Judgement judgement;
  if (!root.contains("grades")) return judgement;
  for (const Purpose purpose : estimation::kPurposes) {
    const std::string key(estimation::to_string(purpose));
    const std::string place = fmt::format("{}: grades.{}", file, key);
    const ordered_json& grade = require(root["grades"], key.c_str(), file + ": grades");
    judgement.of(purpose) = {
        .grade = read_word(read_text(grade, "grade", place),
                           std::array{Grade::kYes, Grade::kWithCare, Grade::kNotJudged, Grade::kNo}, place + ".grade"),
        .decided_by = read_texts(require(grade, "because", place), place + ".because")};
  }
  return judgement;
}

/// Numbers and names of a row.
std::vector<estimation::Figure> read_figures(const ordered_json& figures, const std::string& place) {
  if (!figures.is_object()) throw InputError(place, "is not an object");
  std::vector<estimation::Figure> read;
  for (const auto& [key, value] : figures.items()) {
    if (value.is_string())
      read.push_back({key, value.get<std::string>()});
    else
      read.push_back({key, read_number(value, fmt::format("{}.{}", place, key))});
  }
  return read;
}

std::vector<Evidence> read_evidence(const ordered_json& root, const std::string& file) {
  std::vector<Evidence> rows;
  if (!root.contains("evidence")) return rows;
  if (!root["evidence"].is_array()) throw InputError(file, "'evidence' is not an array");
  for (const ordered_json& row : root["evidence"]) {
    const std::string place = fmt::format("{}: evidence[{}]", file, rows.size());
    // Files of versions before 0.9 have neither causes nor figures, and call a check "name".
    const bool older = row.is_object() && !row.contains("check");
    Evidence e{.check = estimation::check_named(read_text(row, older ? "name" : "check", place)),
               .about = read_text(row, "about", place),
               .cause = older ? Cause::kNone : read_word(read_text(row, "cause", place), kAllCauses, place + ".cause"),
               .outcome = read_word(read_text(row, "outcome", place),
                                    std::array{Outcome::kPassed, Outcome::kNotVerified, Outcome::kCare,
                                               Outcome::kMissing, Outcome::kFailed},
                                    place + ".outcome"),
               .value = read_number(require(row, "value", place), place + ".value"),
               .sigma = older ? 0.0 : read_number(require(row, "sigma", place), place + ".sigma"),
               .limit = read_number(require(row, "limit", place), place + ".limit")};
    if (!older) e.figures = read_figures(require(row, "figures", place), place + ".figures");
    for (const std::string& purpose : read_texts(require(row, "bears_on", place), place + ".bears_on"))
      e.bears_on = e.bears_on | read_word(purpose, estimation::kPurposes, place + ".bears_on");
    rows.push_back(std::move(e));
  }
  return rows;
}

/// Where an estimate has some.
void read_next_measurements(const ordered_json& root, const std::string& file, Estimate& estimate) {
  if (!root.contains("next_measurements")) return;
  if (!root["next_measurements"].is_array()) throw InputError(file, "'next_measurements' is not an array");
  for (const ordered_json& next : root["next_measurements"]) {
    const std::string place = fmt::format("{}: next_measurements[{}]", file, estimate.next_measurements.size());
    estimate.next_measurements.push_back(
        {.name = read_text(next, "name", place),
         .widest_now = read_text(next, "widest_now", place),
         .share_now = read_number(require(next, "share_now", place), place + ".share_now"),
         .widest_then = read_text(next, "widest_then", place),
         .share_then = read_number(require(next, "share_then", place), place + ".share_then")});
  }
}

/// Where an estimate has some.
void read_derived(const ordered_json& root, const std::string& file, Estimate& estimate) {
  if (!root.contains("derived")) return;
  if (!root["derived"].is_array()) throw InputError(file, "'derived' is not an array");
  for (const ordered_json& quantity : root["derived"]) {
    const std::string place = fmt::format("{}: derived[{}]", file, estimate.derived.size());
    const auto number_of = [&](const char* key) {
      return read_number(require(quantity, key, place), fmt::format("{}.{}", place, key));
    };
    estimate.derived.push_back({.group = read_text(quantity, "group", place),
                                .name = read_text(quantity, "name", place),
                                .value = number_of("value"),
                                .low95 = number_of("low95"),
                                .high95 = number_of("high95"),
                                .unit = read_text(quantity, "unit", place),
                                .note = read_text(quantity, "note", place)});
  }
}

ordered_json trial_of(const estimation::StructureTrial& trial) {
  ordered_json parameters = ordered_json::array();
  for (const Parameter& p : trial.parameters)
    parameters.push_back({{"name", p.name}, {"value", number(p.value)}, {"sigma", number(p.sigma)}, {"unit", p.unit}});
  return {{"name", trial.name},
          {"taken", trial.taken},
          {"obstacle", trial.obstacle},
          {"log_likelihood_gain", number(trial.log_likelihood_gain)},
          {"needed_gain", number(trial.needed_gain)},
          {"holdout_quantity", trial.holdout_quantity},
          {"holdout_rmse", number(trial.holdout_rmse)},
          {"holdout_unit", trial.holdout_unit},
          {"parameters", std::move(parameters)}};
}

estimation::StructureTrial read_trial(const ordered_json& trial, const std::string& place) {
  const ordered_json& taken = require(trial, "taken", place);
  if (!taken.is_boolean()) throw InputError(place + ".taken", "is neither true nor false");
  estimation::StructureTrial out{
      .name = read_text(trial, "name", place),
      .taken = taken.get<bool>(),
      .obstacle = read_text(trial, "obstacle", place),
      .log_likelihood_gain = read_number(require(trial, "log_likelihood_gain", place), place + ".log_likelihood_gain"),
      .needed_gain = read_number(require(trial, "needed_gain", place), place + ".needed_gain"),
      .holdout_quantity = read_text(trial, "holdout_quantity", place),
      .holdout_rmse = read_number(require(trial, "holdout_rmse", place), place + ".holdout_rmse"),
      .holdout_unit = read_text(trial, "holdout_unit", place)};
  const ordered_json& parameters = require(trial, "parameters", place);
  if (!parameters.is_array()) throw InputError(place + ".parameters", "is not an array");
  for (const ordered_json& p : parameters) {
    const std::string where = fmt::format("{}.parameters[{}]", place, out.parameters.size());
    out.parameters.push_back({.name = read_text(p, "name", where),
                              .value = read_number(require(p, "value", where), where + ".value"),
                              .sigma = read_number(require(p, "sigma", where), where + ".sigma"),
                              .unit = read_text(p, "unit", where)});
  }
  return out;
}

/// Where an estimate says which structure of its model it is of.
void read_structure(const ordered_json& root, const std::string& file, Estimate& estimate) {
  if (!root.contains("structure")) return;
  estimate.structure = read_text(root, "structure", file);
  estimate.structure_reason = read_text(root, "structure_reason", file);
  const ordered_json& trials = require(root, "tried_structures", file);
  if (!trials.is_array()) throw InputError(file, "'tried_structures' is not an array");
  for (const ordered_json& trial : trials)
    estimate.tried_structures.push_back(
        read_trial(trial, fmt::format("{}: tried_structures[{}]", file, estimate.tried_structures.size())));
}

ordered_json validation_of(const std::map<std::string, estimation::ValidationMeasure>& measures) {
  ordered_json validation = ordered_json::object();
  for (const auto& [name, v] : measures) {
    validation[name] = {{"mae", number(v.mae)},
                        {"rmse", number(v.rmse)},
                        {"r2", number(v.r2)},
                        {"theil", number(v.theil)},
                        {"unit", v.unit}};
  }
  return validation;
}

std::map<std::string, estimation::ValidationMeasure> read_validation(const ordered_json& root,
                                                                     const std::string& name) {
  std::map<std::string, estimation::ValidationMeasure> validation;
  if (!root.contains("validation") || !root["validation"].is_object()) return validation;
  for (const auto& [key, value] : root["validation"].items()) {
    const std::string place = fmt::format("{}: validation.{}", name, key);
    validation[key] = {.mae = read_number(require(value, "mae", place), place),
                       .rmse = read_number(require(value, "rmse", place), place),
                       .r2 = read_number(require(value, "r2", place), place),
                       .theil = read_number(require(value, "theil", place), place),
                       .unit = read_text(value, "unit", place)};
  }
  return validation;
}

/// Of an estimate from several recordings.
std::vector<estimation::RecordingUse> read_recordings(const ordered_json& root, const std::string& file) {
  std::vector<estimation::RecordingUse> recordings;
  if (!root.contains("recordings")) return recordings;
  if (!root["recordings"].is_array()) throw InputError(file, "'recordings' is not an array");
  for (const ordered_json& recording : root["recordings"]) {
    const std::string place = fmt::format("{}: recordings[{}]", file, recordings.size());
    recordings.push_back({.name = read_text(recording, "name", place),
                          .use = read_text(recording, "use", place),
                          .validation = read_validation(recording, place)});
  }
  return recordings;
}

}  // namespace

std::string to_json(const Estimate& estimate) {
  ordered_json root;
  root["schema"] = kEstimateSchema;
  root["subject"] = estimate.subject;
  root["method"] = estimate.method;
  if (estimate.interrupted) root["interrupted"] = true;
  root["parameters"] = ordered_json::array();
  for (const Parameter& p : estimate.parameters) {
    root["parameters"].push_back({{"name", p.name},
                                  {"value", number(p.value)},
                                  {"sigma", number(p.sigma)},
                                  {"low95", number(p.low95)},
                                  {"high95", number(p.high95)},
                                  {"unit", p.unit},
                                  {"status", std::string(estimation::to_string(p.status))}});
  }
  if (!estimate.other_methods.empty()) {
    root["other_methods"] = ordered_json::array();
    for (const auto& [method, p] : estimate.other_methods) {
      root["other_methods"].push_back({{"name", p.name},
                                       {"method", method},
                                       {"value", number(p.value)},
                                       {"sigma", number(p.sigma)},
                                       {"low95", number(p.low95)},
                                       {"high95", number(p.high95)},
                                       {"unit", p.unit},
                                       {"status", std::string(estimation::to_string(p.status))}});
    }
  }
  for (const estimation::DerivedQuantity& quantity : estimate.derived) {
    root["derived"].push_back({{"name", quantity.name},
                               {"value", number(quantity.value)},
                               {"low95", number(quantity.low95)},
                               {"high95", number(quantity.high95)},
                               {"unit", quantity.unit},
                               {"group", quantity.group},
                               {"note", quantity.note}});
  }
  root["covariance"] = ordered_json::array();
  for (Eigen::Index i = 0; i < estimate.covariance.rows(); ++i) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index j = 0; j < estimate.covariance.cols(); ++j) row.push_back(number(estimate.covariance(i, j)));
    root["covariance"].push_back(std::move(row));
  }
  root["fit"] = ordered_json::object();
  std::map<std::string, double> fit = estimate.fit;
  for (const auto& [parameter, parts] : estimate.interval_parts)
    for (const estimation::IntervalPart& part : parts) fit[fmt::format("{}.{}", parameter, part.key)] = part.sigma;
  for (const auto& [name, value] : fit) root["fit"][name] = number(value);
  root["validation"] = validation_of(estimate.validation);
  for (const estimation::RecordingUse& recording : estimate.recordings)
    root["recordings"].push_back(
        {{"name", recording.name}, {"use", recording.use}, {"validation", validation_of(recording.validation)}});
  root["verdict"] = estimate.verdict;
  root["grades"] = grades_of(estimate.judgement);
  root["evidence"] = ordered_json::array();
  for (const Evidence& row : estimate.evidence) root["evidence"].push_back(evidence_of(row));
  root["warnings"] = estimate.warnings;
  if (!estimate.structure.empty()) {
    root["structure"] = estimate.structure;
    root["structure_reason"] = estimate.structure_reason;
    root["tried_structures"] = ordered_json::array();
    for (const estimation::StructureTrial& trial : estimate.tried_structures)
      root["tried_structures"].push_back(trial_of(trial));
  }
  for (const estimation::NextMeasurement& next : estimate.next_measurements) {
    root["next_measurements"].push_back({{"name", next.name},
                                         {"widest_now", next.widest_now},
                                         {"share_now", number(next.share_now)},
                                         {"widest_then", next.widest_then},
                                         {"share_then", number(next.share_then)}});
  }
  return json_text(root, 2) + "\n";
}

Estimate read_estimate(const std::filesystem::path& path) {
  const std::string name = path.string();
  ordered_json root;
  try {
    root = ordered_json::parse(read_file(path));
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(name, fmt::format("not JSON at byte {}", error.byte));
  }
  check_schema(root, name);
  Estimate estimate;
  estimate.subject = read_text(root, "subject", name);
  estimate.method = read_text(root, "method", name);
  if (root.contains("interrupted")) {
    if (!root["interrupted"].is_boolean()) throw InputError(name + ": interrupted", "is neither true nor false");
    estimate.interrupted = root["interrupted"].get<bool>();
  }
  const ordered_json& parameters = require(root, "parameters", name);
  if (!parameters.is_array()) throw InputError(name, "'parameters' is not an array");
  for (const ordered_json& p : parameters) {
    const std::string place = fmt::format("{}: parameters[{}]", name, estimate.parameters.size());
    estimate.parameters.push_back({.name = read_text(p, "name", place),
                                   .value = read_number(require(p, "value", place), place + ".value"),
                                   .sigma = read_number(require(p, "sigma", place), place + ".sigma"),
                                   .low95 = read_number(require(p, "low95", place), place + ".low95"),
                                   .high95 = read_number(require(p, "high95", place), place + ".high95"),
                                   .unit = read_text(p, "unit", place),
                                   .status = read_status(read_text(p, "status", place), place)});
    check_parameter(estimate.parameters.back(), name);
  }
  const auto n = signed_index(estimate.parameters.size());
  estimate.covariance = Eigen::MatrixXd::Zero(n, n);
  const ordered_json& covariance = require(root, "covariance", name);
  if (!covariance.is_array() || covariance.size() != estimate.parameters.size()) {
    throw InputError(name, fmt::format("'covariance' is not a {} by {} matrix", n, n));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const ordered_json& row = covariance[i];
    if (!row.is_array() || row.size() != estimate.parameters.size()) {
      throw InputError(name, fmt::format("'covariance' row {} has not {} numbers", i + 1, n));
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      estimate.covariance(i, j) = read_number(row[j], fmt::format("{}: covariance[{}][{}]", name, i, j));
    }
  }
  if (root.contains("fit") && root["fit"].is_object()) {
    for (const auto& [key, value] : root["fit"].items())
      estimate.fit[key] = read_number(value, fmt::format("{}: fit.{}", name, key));
  }
  estimate.validation = read_validation(root, name);
  estimate.recordings = read_recordings(root, name);
  estimate.verdict = read_text(root, "verdict", name);
  estimate.judgement = read_grades(root, name);
  estimate.evidence = read_evidence(root, name);
  if (root.contains("warnings") && root["warnings"].is_array()) {
    for (const ordered_json& warning : root["warnings"]) {
      if (warning.is_string()) estimate.warnings.push_back(warning.get<std::string>());
    }
  }
  read_structure(root, name, estimate);
  read_next_measurements(root, name, estimate);
  read_derived(root, name, estimate);
  return estimate;
}

}  // namespace veridyn::io
