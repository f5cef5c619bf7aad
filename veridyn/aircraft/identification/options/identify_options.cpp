#include "veridyn/aircraft/identification/options/identify_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;
using estimation::StructureMethod;

/// What `method` may be besides a regression.
constexpr const char* kOutputError = "output error";

void read_method(const StudyTable& table, IdentifyOptions& options) {
  constexpr std::array kMethods{Method::kOls, Method::kTls, Method::kGtls, Method::kPcaGtls};
  std::vector<std::string> choices{"auto"};
  for (const Method method : kMethods) choices.emplace_back(estimation::to_string(method));
  choices.emplace_back(kOutputError);
  const std::string chosen = table.choice_or("method", choices, "auto");
  for (const Method method : kMethods)
    if (estimation::to_string(method) == chosen) options.method = method;
  options.choose_output_error = chosen == kOutputError;
}

/// Nothing for "given".
std::optional<StructureMethod> read_structure(const StudyTable& table) {
  const std::vector<std::string> choices{"given", "stepwise", "orthogonal"};
  const std::string chosen = table.choice_or("structure", choices, "given");
  if (chosen == "given") return std::nullopt;
  return chosen == "stepwise" ? StructureMethod::kStepwise : StructureMethod::kOrthogonal;
}

}  // namespace

std::string IdentifyOptions::method_name() const {
  if (choose_output_error) return kOutputError;
  return method ? std::string(estimation::to_string(*method)) : "auto";
}

IdentifyOptions IdentifyOptions::read(const StudyTable& table) {
  IdentifyOptions options;
  if (table.has("coefficients")) {
    const std::vector<std::string> names(kCoefficientNames.begin(), kCoefficientNames.end());
    for (const std::string& name : table.texts("coefficients")) {
      const std::optional<Coefficient> c = find_coefficient(name);
      if (!c) table.fail("coefficients", fmt::format("'{}' is not a coefficient{}", name, suggestion(name, names)));
      options.coefficients.push_back(*c);
    }
  }
  if (table.has("profiles") && (table.is_array("profiles") || table.flag_or("profiles", false)))
    table.fail(
        "profiles",
        "is for studies of vehicles and muscles: an aircraft's parameters come from linear regressions, of which "
        "the profile likelihood is a parabola and gives the interval of the error bar again");
  read_method(table, options);
  options.refit_significant = table.flag_or("refit_significant", options.refit_significant);
  options.signal_to_noise = table.number_or("signal_to_noise", "1", options.signal_to_noise);
  if (!(options.signal_to_noise >= 1.0 && options.signal_to_noise <= 10.0)) {
    table.fail("signal_to_noise", fmt::format("= {} must be from 1 to 10", options.signal_to_noise));
  }
  options.significance = table.number_or("significance", "1", options.significance);
  if (!(options.significance > 0.0 && options.significance < 1.0)) {
    table.fail("significance", fmt::format("= {} must be between 0 and 1", options.significance));
  }
  options.min_holdout_r2 = table.number_or("min_holdout_r2", "1", options.min_holdout_r2);
  options.max_unmodelled = table.number_or("max_unmodelled", "1", options.max_unmodelled);
  options.contradiction_level = table.number_or("contradiction_level", "1", options.contradiction_level);
  options.structure = read_structure(table);
  const StudyTable candidates = table.table_or_empty("candidates");
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
  if (table.has("candidates") && !options.structure)
    table.fail("candidates", "needs structure = \"stepwise\" or \"orthogonal\"");
  options.output_error = table.flag_or("output_error", options.output_error);
  if (table.has("output_error_gusts")) options.output_error_gusts = table.flag_or("output_error_gusts", true);
  options.output_error_biases = table.flag_or("output_error_biases", options.output_error_biases);
  if (table.has("frequency_band")) {
    const std::vector<double> band = table.numbers("frequency_band", "Hz");
    if (band.size() != 2 || !(band[0] > 0.0) || !(band[1] > band[0]))
      table.fail("frequency_band", "must be two frequencies, 0 < low < high, such as [\"0.1 Hz\", \"2 Hz\"]");
    options.frequency_low_Hz = band[0];
    options.frequency_high_Hz = band[1];
  }
  const long long replicates = table.integer_or("bootstrap", 0);
  if (replicates != 0 && (replicates < 50 || replicates > 1000000))
    table.fail("bootstrap", fmt::format("= {} must be 0 (none) or from 50 to 1000000 replicates", replicates));
  options.bootstrap = static_cast<std::size_t>(replicates);
  return options;
}

}  // namespace veridyn::aircraft
