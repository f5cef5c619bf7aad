#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/estimation/result/derived_quantity.hpp"
#include "veridyn/estimation/result/parameter.hpp"

namespace veridyn::estimation {

/// A parameter by another method, for comparison.
struct MethodEstimate {
  std::string method;  ///< "output error", "frequency domain", "bootstrap of GTLS"
  Parameter parameter;
};

/// How well a quantity was predicted on held-out data.
struct ValidationMeasure {
  double mae = 0.0;
  double rmse = 0.0;
  double r2 = 0.0;
  double theil = 0.0;
  std::string unit = "1";
};

/// A part of what a parameter's standard deviation is made of.
struct IntervalPart {
  std::string_view key;    ///< of `fit` in estimate.json, after the parameter and a point: "by_noise"
  std::string_view words;  ///< "noise"
  double sigma = 0.0;      ///< in the parameter's unit
};

/// One of several recordings that an estimate was made from, or tried on.
struct RecordingUse {
  std::string name;                                       ///< of its file
  std::string use;                                        ///< "identification", "hold-out", "left out", ...
  std::map<std::string, ValidationMeasure> validation{};  ///< how well its held-out part is predicted
};

/// A measurement that was not made, and how wide the widest interval of 95 % would be with it (half of it over the
/// value known before).
struct NextMeasurement {
  std::string name;
  std::string widest_now;  ///< parameter
  double share_now = 0.0;
  std::string widest_then;  ///< parameter
  double share_then = 0.0;
};

/// A structure of the model that was fitted, and what decides between it and the others.
struct StructureTrial {
  std::string name;
  bool taken = false;
  std::string obstacle = {};            ///< why it cannot be taken whatever it gains; empty: nothing
  double log_likelihood_gain = kNaN;    ///< over the first that can be taken
  double needed_gain = kNaN;            ///< what it has to gain over the one taken before it; NaN for the first
  std::string holdout_quantity = {};    ///< that was predicted on the hold-out
  double holdout_rmse = kNaN;           ///< of it
  std::string holdout_unit = "1";       ///< of that
  std::vector<Parameter> parameters{};  ///< that all structures have: name, value, sigma, unit
};

/// What identification delivers, whatever the domain: the content of `estimate.json`.
struct Estimate {
  std::string subject;
  std::string method;
  bool interrupted = false;  ///< the best that was there when the search was interrupted
  std::vector<Parameter> parameters;
  Eigen::MatrixXd covariance;                 ///< in parameter order; zero between separately estimated groups
  std::vector<DerivedQuantity> derived = {};  ///< what follows from the parameters
  std::vector<MethodEstimate> other_methods;  ///< alongside `parameters`; `other_methods` of estimate.json
  std::map<std::string, double> fit;
  std::map<std::string, std::vector<IntervalPart>> interval_parts = {};  ///< by parameter; written into `fit`
  std::map<std::string, ValidationMeasure> validation;
  std::vector<RecordingUse> recordings = {};  ///< where there are several; `validation` is of all of them
  std::string verdict;
  Judgement judgement;             ///< of the whole; "not judged" where an estimate was read from an older file
  std::vector<Evidence> evidence;  ///< every check behind it
  std::vector<std::string> warnings;
  std::string structure = {};                         ///< of the model; empty: its domain has but one
  std::string structure_reason = {};                  ///< why this one; empty: the study fixes it
  std::vector<StructureTrial> tried_structures = {};  ///< the simplest first
  std::vector<NextMeasurement> next_measurements;     ///< the best first; empty: not asked for, or none to advise

  [[nodiscard]] const Parameter* find(std::string_view name) const;
};

/// What it may be used for in one sentence, after one that says that its search was interrupted where it was.
[[nodiscard]] std::string sentence_of(const Estimate& estimate);

}  // namespace veridyn::estimation
