#include "veridyn/aircraft/identification/options/identify_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;
using estimation::StructureMethod;

/// What `method` may be besides a regression.
constexpr const char* kOutputError = "output error";
constexpr std::array kMethods{Method::kOls, Method::kTls, Method::kGtls, Method::kPcaGtls};

std::vector<std::string> method_names() {
  std::vector<std::string> names{"auto"};
  for (const Method method : kMethods) names.emplace_back(estimation::to_string(method));
  names.emplace_back(kOutputError);
  return names;
}

void read_method(const StudyTable& table, const std::string& key, IdentifyOptions& options) {
  const std::string chosen = table.choice_or(key, method_names(), "auto");
  for (const Method method : kMethods)
    if (estimation::to_string(method) == chosen) options.method = method;
  options.choose_output_error = chosen == kOutputError;
}

void read_candidates(const StudyTable& table, const std::string& key, IdentifyOptions& options) {
  const StudyTable candidates = table.table(key);
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    if (!candidates.has(kCoefficientNames[i])) continue;
    for (const std::string& text : candidates.texts(kCoefficientNames[i])) {
      Term term = parse_term(text, candidates.place(kCoefficientNames[i]));
      auto& terms = options.candidates[i];
      if (std::find(terms.begin(), terms.end(), term) != terms.end())
        candidates.fail(kCoefficientNames[i], fmt::format("names the term '{}' twice", text));
      terms.push_back(std::move(term));
    }
  }
}

void read_band(const StudyTable& table, const std::string& key, IdentifyOptions& options) {
  const std::vector<double> band = table.numbers(key, "Hz");
  if (band.size() != 2 || !(band[0] > 0.0) || !(band[1] > band[0]))
    table.fail(key, "must be two frequencies, 0 < low < high, such as [\"0.1 Hz\", \"2 Hz\"]");
  options.frequency_low_Hz = band[0];
  options.frequency_high_Hz = band[1];
}

void check(const StudyTable& table, IdentifyOptions& options) {
  if (table.has("profiles") && (table.is_array("profiles") || table.flag_or("profiles", false)))
    table.fail(
        "profiles",
        "is for studies of vehicles and muscles: an aircraft's parameters come from linear regressions, of which "
        "the profile likelihood is a parabola and gives the interval of the error bar again");
  if (table.has("candidates") && !options.structure)
    table.fail("candidates", "needs structure = \"stepwise\" or \"orthogonal\"");
  if (options.bootstrap != 0 && options.bootstrap < 50)
    table.fail("bootstrap", fmt::format("= {} must be 0 (none) or at least 50 replicates", options.bootstrap));
}

}  // namespace

std::string IdentifyOptions::method_name() const {
  if (choose_output_error) return kOutputError;
  return method ? std::string(estimation::to_string(*method)) : "auto";
}

const KeyTable<IdentifyOptions>& IdentifyOptions::keys() {
  using O = IdentifyOptions;
  static const auto table =
      KeyTable<O>("identify", "How the coefficients are identified, and what is demanded of the result.")
          .choices("coefficients", &O::coefficients, choices_of<Coefficient>(kCoefficientNames), "which are identified")
          .otherwise("all that the subject models")
          .other({"method", "", quoted_list(method_names(), "`"), "\"auto\"",
                  "`auto`: the regression that the comparison recommends; `output error` starts at it and takes its "
                  "own estimate"},
                 read_method)
          .flag("refit_significant", &O::refit_significant,
                "drops what fails its t-test and estimates once more; the constant is kept")
          .number("signal_to_noise", &O::signal_to_noise, "1", from_to(1.0, 10.0), "S/n of the excitation threshold")
          .number("significance", &O::significance, "1", between(0.0, 1.0), "of the t-tests; intervals are always 95 %")
          .number("min_holdout_r2", &O::min_holdout_r2, "1", kAnyNumber,
                  "a coefficient that explains a smaller share of the hold-out's variance is rejected")
          .number("max_unmodelled", &O::max_unmodelled, "1", kAnyNumber,
                  "largest share of a coefficient's variance that may be neither modelled nor noise of the sensors")
          .number("contradiction_level", &O::contradiction_level, "1", kAnyNumber,
                  "p of the chi-square test below which identification and hold-out, estimated separately, contradict "
                  "each other")
          .choice(
              "structure", &O::structure,
              {{"given", {}}, {"stepwise", StructureMethod::kStepwise}, {"orthogonal", StructureMethod::kOrthogonal}},
              "`given`: the subject's terms; else they are chosen among candidates first")
          .other({"candidates", "", "`CL = [\"1\", \"alpha\", \"alpha*q_n\"]`, for each coefficient",
                  "see docs/aircraft.md, section 9", "terms to choose among; a table, needs `structure`", true},
                 read_candidates)
          .flag("output_error", &O::output_error, "output-error maximum likelihood alongside regression")
          .flag("output_error_gusts", &O::output_error_gusts,
                "its simulation is driven by the reconstructed gust; `false` takes the air to be calm")
          .otherwise("`true` with a ground velocity, against which a gust can be told from motion")
          .flag("output_error_biases", &O::output_error_biases,
                "and has constant biases of the accelerometers, per segment")
          .other({"frequency_band", "Hz", "two frequencies, `[\"0.1 Hz\", \"2 Hz\"]`", "none",
                  "equation error in the frequency domain alongside regression", true},
                 read_band)
          .count("bootstrap", &O::bootstrap, 0, 1000000,
                 "replicates of a block bootstrap of the chosen regression, at least 50; 0: none")
          .check(check);
  return table;
}

}  // namespace veridyn::aircraft
