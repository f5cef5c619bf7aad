#include "veridyn/report/parts/aircraft_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/report/figures/aircraft_figures.hpp"
#include "veridyn/report/parts/aircraft_estimates.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;
using estimation::Method;
using estimation::RegressionEstimate;

std::string unexcited_text(const RegressionEstimate& e) {
  std::vector<std::string> texts;
  for (const estimation::Direction& d : e.unexcited) texts.push_back(d.text);
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace

Section excitation_section(const FlightAnalysis& analysis) {
  Section section{.title = "Excitation", .id = "excitation", .folded = true};
  section.blocks.emplace_back(List{.items = {segments_text(analysis.flights, Axis::kLongitudinal),
                                             segments_text(analysis.flights, Axis::kLateral)}});
  Table table{.title = "Excited directions",
              .caption =
                  "Singular values of the regressors in units of their noise; a direction counts as excited above the "
                  "threshold "
                  "(S/n + 1) sqrt(N - n). Combinations of parameters that are not excited keep a wide error bar.",
              .columns = {{.name = "Coefficient"},
                          {.name = "Samples"},
                          {.name = "Threshold", .digits = 3},
                          {.name = "Singular values"},
                          {.name = "Not excited"},
                          {.name = "Condition", .digits = 3}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    const RegressionEstimate* e = r.comparison.find(Method::kPcaGtls);
    if (e == nullptr) continue;
    std::vector<std::string> values;
    for (const double s : e->singular_values) values.push_back(fmt::format("{:.3g}", s));
    table.rows.push_back({.cells = {text_cell(r.name), number_cell(static_cast<double>(e->rows), 0),
                                    number_cell(e->threshold), text_cell(fmt::format("{}", fmt::join(values, ", "))),
                                    text_cell(unexcited_text(*e)), number_cell(e->condition_number)}});
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!identified(r)) continue;
    const Eigen::MatrixXd& P = r.chosen->covariance;
    Matrix matrix{.title = fmt::format("{}: correlation of the parameters", r.name)};
    for (const auto& p : r.chosen->parameters) matrix.row_names.push_back(p.name);
    matrix.column_names = matrix.row_names;
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
      std::vector<double> row;
      for (Eigen::Index j = 0; j < P.cols(); ++j) row.push_back(P(i, j) / std::sqrt(P(i, i) * P(j, j)));
      matrix.values.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(matrix));
  }
  return section;
}

Section residual_section(const FlightAnalysis& analysis) {
  Section section{.title = "Residuals", .id = "residuals", .folded = true};
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.chosen || r.residual_autocorrelation.value.empty()) continue;
    section.blocks.emplace_back(residual_autocorrelation_plot(r));
    section.blocks.emplace_back(residual_normal_plot(r));
  }
  return section;
}

Section validation_section(const FlightAnalysis& analysis) {
  Section section{.title = "Validation on held-out data", .id = "validation", .folded = true};
  const Validation& v = analysis.validation;
  section.blocks.emplace_back(Paragraph{v.text, v.available() ? Tone::kPlain : Tone::kNote});
  Table table = prediction_table(analysis.predictions, "Prediction");
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (TimeSeries& figure : validation_figures(v)) section.blocks.emplace_back(std::move(figure));
  return section;
}

}  // namespace veridyn::report
