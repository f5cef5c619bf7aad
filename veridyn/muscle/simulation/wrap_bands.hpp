#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// A muscle's path at poses where one of its wraps counts in part only, or not although it should (`PathFlag`). In the
/// bands in which a wrap fades out lengths stay continuous, but they change quickly: moment arms there can be ten times
/// those of the muscle.
struct WrapBandVisit {
  int muscle = 0;
  PathFlag flag = PathFlag::kFading;  ///< the worst
  std::size_t poses = 0;              ///< how many of those given
  double first = 0.0, last = 0.0;     ///< times of the first and last of them [s]
  Eigen::VectorXd pose;               ///< at the first; all coordinates
};

/// Muscles that are in such a band at some of the poses (rows of `q`: all coordinates). With the exact paths, whatever
/// the system's simulations take; none for paths as OpenSim's, which have no bands.
[[nodiscard]] std::vector<WrapBandVisit> wrap_band_visits(const MusculoskeletalSystem& system,
                                                          std::span<const double> time, const estimation::RowMatrix& q);

/// One sentence with muscle, pose and times.
[[nodiscard]] std::string wrap_band_text(const MusculoskeletalSystem& system, const WrapBandVisit& visit);

}  // namespace veridyn::muscle
