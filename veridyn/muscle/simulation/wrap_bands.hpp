#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// What makes a muscle's moment arms doubtful along a motion.
enum class WrapBandKind {
  kEnds,        ///< the path lets go of a cylinder beyond its end, where OpenSim's jumps: arms are those of letting go
  kSideChange,  ///< the path changes the side of a wrap object, or a point of it comes or goes: its arms jump
  kNotFound,    ///< a wrap was not found although it should be there: straight
};

/// A muscle's path at poses of a motion where its arms are to be doubted.
struct WrapBandVisit {
  int muscle = 0;
  WrapBandKind kind = WrapBandKind::kEnds;
  std::size_t poses = 0;           ///< how many of those given; of a side change 1
  double first = 0.0, last = 0.0;  ///< times of the first and last of them [s]
  double jump = 0.0;               ///< of the moment arm at a side change [m or 1]
  double length_jump = 0.0;  ///< of the length there [m]: 0 unless a point passes a quadrant's wall or objects cross
  Eigen::VectorXd pose;      ///< at the first; all coordinates
};

/// Such muscles and poses of a motion (rows of `q`: all coordinates). With the exact paths, whatever the system's
/// simulations take; none for paths as OpenSim's. Between two rows a side change is found by halving.
[[nodiscard]] std::vector<WrapBandVisit> wrap_band_visits(const MusculoskeletalSystem& system,
                                                          std::span<const double> time, const estimation::RowMatrix& q);

/// One sentence with muscle, pose and times.
[[nodiscard]] std::string wrap_band_text(const MusculoskeletalSystem& system, const WrapBandVisit& visit);

}  // namespace veridyn::muscle
