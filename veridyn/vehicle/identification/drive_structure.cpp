#include "veridyn/vehicle/identification/drive_structure.hpp"

#include <algorithm>

namespace veridyn::vehicle {

std::size_t choose_structure(std::span<const TriedStructure> tried) {
  std::size_t chosen = 0;
  while (chosen < tried.size() && !tried[chosen].usable) ++chosen;
  if (chosen == tried.size()) return 0;
  for (std::size_t i = chosen + 1; i < tried.size(); ++i) {
    if (!tried[i].usable || tried[i].at_bound) continue;
    const double gain = tried[chosen].negative_log_likelihood - tried[i].negative_log_likelihood;
    const bool likelier = gain > kLikelier * tried[i].inflation;
    const double allowed = std::clamp(0.25 * gain / std::max(1.0, tried[i].holdout_samples), kNoWorse, kMostWorse);
    const bool worse = tried[i].holdout_misfit > tried[chosen].holdout_misfit + allowed;
    if (likelier && !worse) chosen = i;
  }
  return chosen;
}

}  // namespace veridyn::vehicle
