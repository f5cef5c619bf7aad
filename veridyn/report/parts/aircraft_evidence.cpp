#include "veridyn/report/parts/aircraft_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "veridyn/report/figures/aircraft_figures.hpp"
#include "veridyn/report/parts/aircraft_estimates.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"

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
  section.blocks.emplace_back(List{.items = {analysis.segments.longitudinal.text, analysis.segments.lateral.text}});
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
  Table table{
      .title = "Honesty checks",
      .caption =
          "What would make an estimate look better than it is. A coefficient whose check fails is not recommended.",
      .columns = {{.name = "Coefficient"}, {.name = "Check"}, {.name = "Result"}, {.name = "Finding"}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    for (const estimation::HonestyCheck& check : r.comparison.checks) {
      Row row{.cells = check_cells(check, Status::kCaution)};
      row.cells.insert(row.cells.begin(), text_cell(r.name));
      table.rows.push_back(std::move(row));
    }
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
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
  Table table{
      .title = "Prediction",
      .caption =
          "MAE: mean absolute error, RMSE: root mean square error, R2: share of the variance explained, Theil: "
          "inequality "
          "coefficient (0 perfect). Coefficients are compared sample by sample; airspeed, alpha and beta are flown.",
      .columns = {{.name = "Quantity"},
                  {.name = "MAE", .digits = 3},
                  {.name = "RMSE", .digits = 3},
                  {.name = "R2", .digits = 3},
                  {.name = "Theil", .digits = 3},
                  {.name = "Unit"},
                  {.name = "Samples"}}};
  const auto row = [&](std::string name, const numerics::FitMeasures& fit, const std::string& unit, Status status) {
    table.rows.push_back(
        {.cells = {text_cell(std::move(name)), number_cell(fit.mae), number_cell(fit.rmse), number_cell(fit.r2),
                   number_cell(fit.theil), text_cell(unit), number_cell(static_cast<double>(fit.count), 0)},
         .status = status});
  };
  for (const PredictedQuantity& q : v.quantities) row(q.name, q.fit, q.unit, Status::kNone);
  for (const CoefficientResult& r : analysis.coefficients) {
    if (r.holdout_fit.count > 0) row(r.name, r.holdout_fit, "1", status_of(r.verdict));
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (TimeSeries& figure : validation_figures(v)) section.blocks.emplace_back(std::move(figure));
  return section;
}

}  // namespace veridyn::report
