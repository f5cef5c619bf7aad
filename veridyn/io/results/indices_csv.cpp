#include "veridyn/io/results/indices_csv.hpp"

#include <fmt/format.h>

#include "veridyn/io/tables/csv_text.hpp"

namespace veridyn::io {

std::string indices_csv(std::span<const estimation::ResultIndices> results, std::span<const std::string> inputs,
                        estimation::IndexMethod method) {
  using estimation::wide_interval;
  const bool morris = method == estimation::IndexMethod::kMorris;
  std::string text = morris ? "result,input,mu,mu_star,sigma\n"
                            : "result,input,first,first_low,first_high,first_wide,total,total_low,total_high,"
                              "total_wide\n";
  for (const estimation::ResultIndices& r : results) {
    for (std::size_t i = 0; i < r.morris.size(); ++i) {
      const numerics::MorrisEffect& e = r.morris[i];
      text += fmt::format("{},{},{},{},{}\n", csv_text(r.result), csv_text(inputs[i]), csv_number(e.mean),
                          csv_number(e.absolute), csv_number(e.sd));
    }
    for (std::size_t i = 0; i < r.variance.inputs.size(); ++i) {
      const numerics::SensitivityIndex& x = r.variance.inputs[i];
      text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_text(r.result), csv_text(inputs[i]),
                          csv_number(x.first), csv_number(x.first_low), csv_number(x.first_high),
                          wide_interval(x.first, x.first_low, x.first_high) ? "yes" : "no", csv_number(x.total),
                          csv_number(x.total_low), csv_number(x.total_high),
                          wide_interval(x.total, x.total_low, x.total_high) ? "yes" : "no");
    }
  }
  return text;
}

}  // namespace veridyn::io
