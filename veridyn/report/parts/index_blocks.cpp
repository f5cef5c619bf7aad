#include "veridyn/report/parts/index_blocks.hpp"

#include <fmt/format.h>

namespace veridyn::report {

IntervalPlot index_plot(const IndexedResult& result, double level) {
  const numerics::SensitivityIndices& v = result.indices.variance;
  IntervalPlot plot{
      .title = result.indices.result,
      .caption = fmt::format("Shares of the variance of {}; {:g} % bootstrap intervals. {} of {} "
                             "samples had a point that could not be simulated and do not count.",
                             result.quantity, 100.0 * level, v.dropped, v.evaluations / (result.inputs.size() + 2)),
      .methods = {"first order", "total order"},
      .shared_scale = true};
  for (std::size_t i = 0; i < v.inputs.size(); ++i) {
    const numerics::SensitivityIndex& x = v.inputs[i];
    plot.rows.push_back({.name = result.inputs[i],
                         .estimates = {{.value = x.first, .low = x.first_low, .high = x.first_high},
                                       {.value = x.total, .low = x.total_low, .high = x.total_high}}});
  }
  return plot;
}

Table morris_table(const IndexedResult& result) {
  Table table{
      .title = result.indices.result,
      .caption = fmt::format("Morris: change of {} over an input's whole range. mu* mean of the magnitudes, mu with "
                             "signs, sigma large where the effect depends on other inputs or is not linear.",
                             result.quantity),
      .columns = {{.name = "Input"},
                  {.name = "mu*", .unit = result.unit, .digits = 3},
                  {.name = "mu", .unit = result.unit, .digits = 3},
                  {.name = "sigma", .unit = result.unit, .digits = 3}}};
  const std::vector<numerics::MorrisEffect>& effects = result.indices.morris;
  for (std::size_t i = 0; i < effects.size(); ++i)
    table.rows.push_back(
        {.cells = {text_cell(result.inputs[i]), number_cell(result.factor * effects[i].absolute),
                   number_cell(result.factor * effects[i].mean), number_cell(result.factor * effects[i].sd)}});
  return table;
}

Paragraph index_explanation(bool variance) {
  return {
      .text = variance
                  ? "All inputs vary between their bounds at once. First order: what is gone of the variance when the "
                    "input is known. Total order: what is left when only it is not. What lies between is interaction."
                  : "Inputs vary between their bounds, one after the other, from points all over them (Morris).",
      .tone = Tone::kNote};
}

}  // namespace veridyn::report
