#include "veridyn/aircraft/identification/other_estimators.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/output_error_model.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/bootstrap.hpp"
#include "veridyn/estimation/regression/frequency_domain.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::ParameterEstimate;
using estimation::RegressionEstimate;

constexpr double kContradiction = 3.0;

class OtherMethods {
 public:
  OtherMethods(const FlightSignals& signals, const Segments& segments, const Subject& subject,
               std::span<const CoefficientResult> results, const IdentifyOptions& options, Progress& progress)
      : signals_(signals),
        segments_(segments),
        subject_(subject),
        results_(results),
        options_(options),
        progress_(progress) {}

  OtherEstimators run() {
    if (options_.output_error) {
      progress_.stage("output error");
      output_error(Axis::kLongitudinal);
      output_error(Axis::kLateral);
    }
    if (options_.frequency_high_Hz > 0.0) frequency();
    if (options_.bootstrap > 0) {
      progress_.stage("bootstrap");
      bootstrap();
    }
    note_contradictions();
    return std::move(out_);
  }

 private:
  void add(const CoefficientResult& result, const std::string& method, const ParameterEstimate& p) {
    OtherParameter row;
    row.coefficient = result.coefficient;
    row.estimate = {p.name, method, p.value, p.sigma, p.low95, p.high95, p.unit, p.status};
    const ParameterEstimate* regression = result.chosen ? result.chosen->find(p.name) : nullptr;
    row.apart_sigma =
        regression != nullptr ? (p.value - regression->value) / std::hypot(p.sigma, regression->sigma) : kNaN;
    if (!std::isfinite(p.sigma)) row.apart_sigma = kNaN;
    out_.parameters.push_back(std::move(row));
  }

  /// The parameters of a coefficient that a method sets beside regression by more than its errors allow.
  std::string contradictions(const std::string& method) const {
    std::vector<std::string> names;
    for (const OtherParameter& row : out_.parameters) {
      if (row.estimate.method == method && std::abs(row.apart_sigma) > kContradiction)
        names.push_back(fmt::format("{} ({:+.1f} sigma)", row.estimate.parameter, row.apart_sigma));
    }
    return names.empty() ? "" : fmt::format("{} contradicts regression in {}", method, fmt::join(names, ", "));
  }

  void output_error(Axis axis) {
    AxisOutputError run;
    run.axis = axis;
    std::vector<CoefficientModel> models;
    std::vector<std::string> names;
    for (const CoefficientResult& r : results_) {
      if (r.axis != axis || !r.chosen) continue;
      models.push_back(r.model);
      run.coefficients.push_back(r.coefficient);
      names.emplace_back(name_of(r.coefficient));
    }
    const std::string label = fmt::format("output error, {}", to_string(axis));
    const OutputErrorModel model(signals_, segments_.of(axis).identification, subject_, models,
                                 options_.output_error_gusts);
    if (models.empty() || model.segments() == 0) {
      run.text = fmt::format("{}: not tried, {}", label,
                             models.empty() ? "regression gave no coefficient to start from"
                                            : "no segment of at least 2 s has all signals");
    } else {
      run.attempted = true;
      estimation::OutputErrorOptions o;
      o.significance = options_.significance;
      o.max_relaxations = 40;
      // A hundredth of an error bar is nobody's concern, and a long flight is simulated for every further digit.
      o.tolerance = 0.01;
      if (options_.output_error_biases) {
        for (const estimation::ModelOutput& output : model.outputs()) {
          // A bias of a state that the model integrates freely is what it can tell; that of its initial value is not.
          if (output.name.starts_with("accel")) o.output_biases.push_back(output.name);
        }
      }
      run.estimate = estimation::output_error(model, model.measured(), o, progress_);
      const std::string method = "output error";
      for (const ParameterEstimate& p : run.estimate.parameters) {
        if (!run.estimate.usable()) break;
        for (const CoefficientResult& r : results_) {
          if (r.chosen && r.chosen->find(p.name) != nullptr) add(r, method, p);
        }
      }
      run.text = fmt::format("{} ({}): {}", label, fmt::join(names, ", "), run.estimate.message);
    }
    out_.notes.push_back(run.text);
    out_.output_error.push_back(std::move(run));
  }

  void frequency() {
    const std::string method = "frequency domain";
    for (const CoefficientResult& r : results_) {
      if (!r.chosen) continue;
      estimation::FrequencyOptions o;
      o.low_Hz = options_.frequency_low_Hz;
      o.high_Hz = options_.frequency_high_Hz;
      o.significance = options_.significance;
      const estimation::FrequencyEstimate f = estimation::frequency_equation_error(r.data, r.row_interval_s, o);
      if (f.estimate.usable()) {
        for (const ParameterEstimate& p : f.estimate.parameters) add(r, method, p);
      }
      out_.notes.push_back(fmt::format("{}, {}: {}", method, name_of(r.coefficient), f.estimate.message));
    }
  }

  void bootstrap() {
    for (const CoefficientResult& r : results_) {
      if (!r.chosen || progress_.interrupted()) continue;
      const RegressionEstimate& chosen = *r.chosen;
      estimation::RegressionOptions regression;
      regression.signal_to_noise = options_.signal_to_noise;
      estimation::BootstrapOptions o;
      o.replicates = options_.bootstrap;
      o.seed = options_.seed + static_cast<std::uint64_t>(r.coefficient) + 1;
      const estimation::Bootstrap b =
          estimation::block_bootstrap(r.data, estimation::point_estimator(chosen.method, regression), o, progress_);
      const std::string method = fmt::format("bootstrap of {}", estimation::to_string(chosen.method));
      if (b.usable()) {
        for (std::size_t i = 0; i < chosen.parameters.size(); ++i) {
          const auto at = static_cast<Eigen::Index>(i);
          ParameterEstimate p = chosen.parameters[i];
          p.sigma = b.sigma(at);
          p.low95 = b.low95(at);
          p.high95 = b.high95(at);
          add(r, method, p);
        }
      }
      out_.notes.push_back(fmt::format("{}, {}: {}", method, name_of(r.coefficient), b.message));
    }
  }

  void note_contradictions() {
    for (const char* method : {"output error", "frequency domain"}) {
      const std::string text = contradictions(method);
      if (!text.empty()) out_.notes.push_back(text);
    }
  }

  const FlightSignals& signals_;
  const Segments& segments_;
  const Subject& subject_;
  std::span<const CoefficientResult> results_;
  const IdentifyOptions& options_;
  Progress& progress_;
  OtherEstimators out_;
};

}  // namespace

OtherEstimators estimate_otherwise(const FlightSignals& signals, const Segments& segments, const Subject& subject,
                                   std::span<const CoefficientResult> results, const IdentifyOptions& options,
                                   Progress& progress) {
  return OtherMethods(signals, segments, subject, results, options, progress).run();
}

}  // namespace veridyn::aircraft
