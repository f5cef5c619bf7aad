#include "apps/veridyn/results/posterior_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv_text.hpp"

namespace veridyn::app {
namespace {

using estimation::PosteriorParameter;
using estimation::PosteriorSample;

/// At most so many draws go into the file: neighbours of a chain repeat each other.
constexpr Eigen::Index kMostDraws = 20000;

std::string draws_csv(const PosteriorSample& posterior) {
  std::string text = "step,walker,log_density";
  for (const PosteriorParameter& p : posterior.parameters) text += "," + io::csv_text(p.name);
  text += "\n";
  const estimation::EnsembleSample& e = posterior.ensemble;
  const auto walkers = signed_index(e.walkers);
  const Eigen::Index every = std::max<Eigen::Index>(1, (e.draws.rows() + kMostDraws - 1) / kMostDraws);
  for (Eigen::Index row = 0; row < e.draws.rows(); ++row) {
    if (row / walkers % every != 0) continue;
    text += fmt::format("{},{},{}", signed_index(e.warm_up) + row / walkers + 1, row % walkers + 1,
                        io::csv_number(e.log_density(row)));
    for (std::size_t i = 0; i < posterior.parameters.size(); ++i) text += "," + io::csv_number(e.draws(row, i));
    text += "\n";
  }
  return text;
}

std::string intervals_csv(const PosteriorSample& posterior) {
  std::string text = "parameter,unit,mean,sd,low95,median,high95,autocorrelation_steps\n";
  for (std::size_t i = 0; i < posterior.parameters.size(); ++i) {
    const PosteriorParameter& p = posterior.parameters[i];
    text += fmt::format("{},{},{},{},{},{},{},{}\n", io::csv_text(p.name), io::csv_text(p.unit), io::csv_number(p.mean),
                        io::csv_number(p.sd), io::csv_number(p.low), io::csv_number(p.median), io::csv_number(p.high),
                        io::csv_number(posterior.ensemble.autocorrelation_steps(i)));
  }
  return text;
}

}  // namespace

void write_posterior(OutputFolder& folder, const PosteriorSample& posterior) {
  if (!posterior.usable()) return;
  folder.write("posterior.csv", draws_csv(posterior));
  folder.write("posterior_intervals.csv", intervals_csv(posterior));
}

std::vector<std::string> posterior_lines(const PosteriorSample& posterior) {
  std::vector<std::string> lines;
  if (!posterior.usable()) return lines;
  for (const PosteriorParameter& p : posterior.parameters)
    lines.push_back(fmt::format("  posterior    {}: {:.5g} .. {:.5g} {}", p.name, p.low, p.high, p.unit));
  lines.push_back(
      fmt::format("{}posterior: {}", posterior.ensemble.converged ? "  " : "warning: ", posterior.ensemble.message));
  return lines;
}

Summary posterior_summary(const PosteriorSample& posterior) {
  Summary s = Summary::object({{"converged", posterior.ensemble.converged},
                               {"independent_draws", posterior.ensemble.effective},
                               {"message", posterior.ensemble.message}});
  s["intervals"] = Summary::object();
  for (const PosteriorParameter& p : posterior.parameters)
    s["intervals"][p.name] =
        Summary::object({{"low95", p.low}, {"median", p.median}, {"high95", p.high}, {"mean", p.mean}, {"sd", p.sd}});
  return s;
}

}  // namespace veridyn::app
