#include "veridyn/vehicle/identification/structure/tried_structure.hpp"

#include <cmath>

namespace veridyn::vehicle {
namespace {

/// Whether it has more unknowns: of two structures that were tried one contains the other.
bool is_richer(const TriedStructure& a, const TriedStructure& b) {
  return a.structure > b.structure || (a.structure == b.structure && a.effects > b.effects);
}

}  // namespace

double probability_against(const TriedStructure& other, const TriedStructure& taken) {
  if (!other.usable || (other.at_bound && is_richer(other, taken))) return 0.0;
  const double gain = taken.negative_log_likelihood - other.negative_log_likelihood;
  // Of the richer one, which leaves less to be correlated.
  const double inflation = (is_richer(other, taken) ? other : taken).inflation;
  return 1.0 / (1.0 + std::exp(-gain / inflation - (other.log_prior_volume - taken.log_prior_volume)));
}

std::size_t choose_structure(std::span<const TriedStructure> tried) {
  std::size_t chosen = 0;
  while (chosen < tried.size() && !tried[chosen].usable) ++chosen;
  if (chosen == tried.size()) return 0;
  for (std::size_t i = chosen + 1; i < tried.size(); ++i) {
    if (!tried[i].usable || tried[i].at_bound) continue;
    const double gain = tried[chosen].negative_log_likelihood - tried[i].negative_log_likelihood;
    const bool lags = tried[i].structure == DriveStructure::kRelaxation &&
                      tried[chosen].structure == DriveStructure::kRoll && tried[i].effects == tried[chosen].effects;
    const bool likelier = probability_against(tried[i], tried[chosen]) > (lags ? 1.0 - kProbable : kProbable) &&
                          (has_roll(tried[chosen].structure) || gain > kLikelier * tried[i].inflation);
    const bool worse = tried[i].holdout_misfit > tried[chosen].holdout_misfit + kNoWorse;
    if (likelier && !worse) chosen = i;
  }
  return chosen;
}

}  // namespace veridyn::vehicle
