#include "veridyn/estimation/search/black_box_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::estimation {

bool SearchValues::finite() const {
  return std::isfinite(objective) &&
         std::all_of(constraints.begin(), constraints.end(), [](double c) { return std::isfinite(c); });
}

double SearchValues::violation() const {
  if (!finite()) return kInfinity;
  double sum = 0.0;
  for (const double c : constraints) sum += c > 0.0 ? c * c : 0.0;
  // The square of a small violation may vanish; it is one nevertheless.
  const bool holds = std::all_of(constraints.begin(), constraints.end(), [](double c) { return c <= 0.0; });
  return holds ? 0.0 : std::max(sum, std::numeric_limits<double>::min());
}

bool better(const SearchValues& a, const SearchValues& b) {
  const double va = a.violation(), vb = b.violation();
  if (va != vb) return va < vb;
  return va == 0.0 && a.objective < b.objective;
}

void BlackBoxProblem::validate() const {
  const auto n = at(low.size());
  if (n == 0) throw InputError(name, "has no parameters to search for");
  if (high.size() != low.size() || names.size() != n)
    throw InputError(name, fmt::format("{} lower bounds, {} upper bounds, {} names", n, high.size(), names.size()));
  for (std::size_t i = 0; i < n; ++i) {
    const double from = low(i), to = high(i);
    if (!(std::isfinite(from) && std::isfinite(to) && from < to))
      throw InputError(name, fmt::format("{} is to be searched from {} to {}; bounds must be finite and increase",
                                         names[i], from, to));
  }
}

std::string SearchResult::message() const {
  const auto reason = [&]() -> std::string {
    switch (termination) {
      case SearchTermination::kConverged:
        return "converged";
      case SearchTermination::kFeasible:
        return "found a feasible point";
      case SearchTermination::kIterations:
        return "used up its iterations";
      case SearchTermination::kEvaluations:
        return "used up its evaluations";
      case SearchTermination::kInterrupted:
        return "was interrupted";
    }
    return "ended";
  }();
  std::string text =
      fmt::format("the search {} after {} iterations and {} evaluations", reason, iterations, evaluations);
  if (failed > 0) text += fmt::format(", of which {} could not be computed", failed);
  if (!values.finite()) return text + "; nothing could be computed";
  text += fmt::format("; objective {:.6g}", values.objective);
  if (!usable()) text += fmt::format(", constraints do not hold (violation {:.3g})", values.violation());
  return text;
}

}  // namespace veridyn::estimation
