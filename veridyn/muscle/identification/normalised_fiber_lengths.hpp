#pragma once

#include <string>
#include <vector>

#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// Optimal fibre length and tendon slack length of one muscle, matched to a reference.
struct MatchedFiber {
  int muscle = 0;                     ///< of the subject
  double optimal_fiber_length = 0.0;  ///< [m]
  double tendon_slack_length = 0.0;   ///< [m]
  std::size_t poses = 0;              ///< at which both were compared
  /// Root mean square over the poses of the difference of normalised fibre lengths that is left.
  double error = 0.0;
  std::string obstacle = {};  ///< why it has no match; empty: it has one

  [[nodiscard]] bool usable() const { return obstacle.empty(); }
};

/// A first guess of a person's muscles: L0 and LS with which each muscle, fully active and at rest, has at the same
/// joint angles the normalised fibre length and tendon strain that the reference's muscle of that name has (Modenese,
/// Ceseracciu, Reggiani & Lloyd 2016, J Biomech 49:141). A model that is the reference scaled gets back the reference's
/// curves.
///
/// At poses drawn over the common ranges of the coordinates that move in both models, l/L0 cos(phi) and lT/LS of the
/// reference give path length = L0 (l/L0 cos phi) + LS (lT/LS), solved for both by least squares. Poses at which the
/// reference's fibre is outside 0.5 to 1.5 L0, or its tendon slack, do not count. Lengths of the subject's own paths;
/// pennation at L0 is the subject's.
/// @returns an entry for each muscle of the subject, in its order.
[[nodiscard]] std::vector<MatchedFiber> match_fiber_lengths(const MusculoskeletalSystem& reference,
                                                            const MusculoskeletalSystem& subject,
                                                            std::size_t poses = 500);

}  // namespace veridyn::muscle
