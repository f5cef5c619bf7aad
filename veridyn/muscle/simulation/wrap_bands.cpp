#include "veridyn/muscle/simulation/wrap_bands.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/path/pose_text.hpp"

namespace veridyn::muscle {

std::vector<WrapBandVisit> wrap_band_visits(const MusculoskeletalSystem& system, std::span<const double> time,
                                            const estimation::RowMatrix& q) {
  std::vector<WrapBandVisit> visits;
  if (system.path_source() == PathSource::kAsOpenSim) return visits;
  Kinematics<double> kinematics(system.mechanism());
  PathWorkspace<double> workspace(system.paths());
  std::vector<int> visit_of(system.muscles().size(), -1);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const double* pose = q.data() + i * q.cols();
    update_positions(system.mechanism(), pose, kinematics);
    system.paths().evaluate(kinematics, pose, workspace);
    const double t = at(i) < time.size() ? time[at(i)] : 0.0;
    for (std::size_t m = 0; m < visit_of.size(); ++m) {
      if (workspace.flag[m] == PathFlag::kFine) continue;
      if (visit_of[m] < 0) {
        visit_of[m] = static_cast<int>(visits.size());
        visits.push_back({static_cast<int>(m), workspace.flag[m], 0, t, t, q.row(i).transpose()});
      }
      WrapBandVisit& visit = visits[at(visit_of[m])];
      visit.flag = std::max(visit.flag, workspace.flag[m]);
      ++visit.poses;
      visit.last = t;
    }
  }
  return visits;
}

std::string wrap_band_text(const MusculoskeletalSystem& system, const WrapBandVisit& visit) {
  const char* what = visit.flag == PathFlag::kFading ? "passes a band where a wrap of its path fades out, and its "
                                                       "moment arm can be ten times too large"
                     : visit.flag == PathFlag::kInside
                         ? "has a path point inside a wrap object, where its path is straight"
                         : "has a wrap that was not found, and its path is straight there";
  return fmt::format("muscle '{}' {}: {:.4g} to {:.4g} s, {} samples, first at {}",
                     system.model().muscles[at(visit.muscle)].name(), what, visit.first, visit.last, visit.poses,
                     pose_text(system.model(), system.paths(), visit.muscle, visit.pose));
}

}  // namespace veridyn::muscle
