#include "veridyn/aircraft/model/estimated_subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/results/json_text.hpp"

namespace veridyn::aircraft {

CoefficientModel estimated_coefficient(const CoefficientModel& structure, const std::vector<std::string>& names,
                                       const estimation::Estimate& estimate) {
  using estimation::ParameterStatus;
  CoefficientModel model{structure.coefficient, {}, {}};
  bool rejected = false, estimated = false;
  for (std::size_t i = 0; i < structure.size(); ++i) {
    const estimation::Parameter* p = estimate.find(names[i]);
    rejected = rejected || (p != nullptr && p->status == ParameterStatus::kRejected);
    if (p == nullptr || p->status == ParameterStatus::kRejected || !std::isfinite(p->value)) continue;
    estimated = estimated || (p->status != ParameterStatus::kNotExcited && p->status != ParameterStatus::kFixed);
    model.terms.push_back(structure.terms[i]);
    model.values.push_back(p->value);
  }
  // A coefficient is rejected as a whole; what was held in it keeps that status, and is no model by itself.
  if (rejected && !estimated) return {structure.coefficient, {}, {}};
  return model;
}

namespace {

/// Refuses an estimate with a parameter that no coefficient of the model has: leaving it out would change the model.
void refuse_unknown(const AeroModel& model, const estimation::Estimate& estimate, const std::string& place) {
  std::vector<std::string> known;
  for (const auto& coefficient : model.coefficients) {
    if (!coefficient) continue;
    const std::vector<std::string> names = coefficient->parameter_names();
    known.insert(known.end(), names.begin(), names.end());
  }
  for (const estimation::Parameter& p : estimate.parameters) {
    if (std::find(known.begin(), known.end(), p.name) != known.end()) continue;
    throw InputError(place,
                     fmt::format("parameter '{}' is not in the study's model{}", p.name, suggestion(p.name, known)));
  }
}

}  // namespace

Subject estimated_subject(const Subject& subject, const estimation::Estimate& estimate, const std::string& place) {
  refuse_unknown(subject.model, estimate, place);
  Subject result = subject;
  bool any = false;
  for (auto& coefficient : result.model.coefficients) {
    if (!coefficient) continue;
    CoefficientModel model = estimated_coefficient(*coefficient, coefficient->parameter_names(), estimate);
    if (model.size() > 0) {
      coefficient = std::move(model);
      any = true;
    } else {
      std::fill(coefficient->values.begin(), coefficient->values.end(), kNaN);
    }
  }
  if (!any) throw InputError(place, "holds no usable parameter of the study's model");
  return result;
}

std::string to_json(const Subject& s, const estimation::Estimate* estimate) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["name"] = s.name;
  json["description"] = s.description;
  json["sign_convention"] = s.sign_convention;
  json["mass_kg"] = s.mass;
  json["wing_area_m2"] = s.wing_area;
  json["span_m"] = s.span;
  json["chord_m"] = s.chord;
  json["reference_lengths_m"] = {{"roll", s.roll_length()}, {"pitch", s.pitch_length()}, {"yaw", s.yaw_length()}};
  if (s.inertia) {
    json["inertia_kgm2"] = {
        {"Jx", s.inertia->Jx}, {"Jy", s.inertia->Jy}, {"Jz", s.inertia->Jz}, {"Jxz", s.inertia->Jxz}};
  }
  if (s.model.stall) {
    json["stall"] = {{"M", s.model.stall->M},
                     {"alpha0_rad", s.model.stall->alpha0},
                     {"form", name_of(s.model.stall->form)},
                     {"drag", s.model.stall->drag}};
  }
  if (estimate != nullptr && !estimate->evidence.empty()) {
    for (const estimation::Purpose purpose : estimation::kPurposes)
      json["grades"][std::string(estimation::to_string(purpose))] =
          estimation::to_string(estimate->judgement.of(purpose).grade);
  }
  json["coefficients"] = Json::object();
  for (const auto& model : s.model.coefficients) {
    if (!model) continue;
    Json terms = Json::array();
    for (std::size_t i = 0; i < model->size(); ++i) {
      const std::string name = parameter_name(model->coefficient, model->terms[i]);
      Json term = {{"term", model->terms[i].expression}, {"name", name}, {"unit", model->terms[i].parameter_unit()}};
      term["value"] = std::isfinite(model->values[i]) ? Json(model->values[i]) : Json(nullptr);
      if (const auto* p = estimate != nullptr ? estimate->find(name) : nullptr) {
        term["sigma"] = std::isfinite(p->sigma) ? Json(p->sigma) : Json(nullptr);
        term["status"] = estimation::to_string(p->status);
      }
      terms.push_back(std::move(term));
    }
    json["coefficients"][std::string(name_of(model->coefficient))] = std::move(terms);
  }
  return io::json_text(json, 2) + "\n";
}

}  // namespace veridyn::aircraft
