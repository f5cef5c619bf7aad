#include "veridyn/muscle/simulation/wrap_bands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/path/pose_text.hpp"

namespace veridyn::muscle {
namespace {

/// The paths' gradients pose after pose.
class ArmsAlongMotion {
 public:
  explicit ArmsAlongMotion(const MusculoskeletalSystem& system)
      : system_(system), kinematics_(system.mechanism()), workspace_(system.paths()) {}

  const PathWorkspace<double>& at_pose(const Eigen::VectorXd& q) {
    update_positions(system_.mechanism(), q.data(), kinematics_);
    system_.paths().evaluate(kinematics_, q.data(), workspace_);
    return workspace_;
  }

  /// Largest difference of a muscle's arms.
  [[nodiscard]] double difference(int muscle, const std::vector<double>& a, const std::vector<double>& b) const {
    double largest = 0.0;
    for (std::size_t k = system_.paths().first_pair(muscle); k < system_.paths().end_pair(muscle); ++k)
      largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
  }

  struct Jump {
    double arm = 0.0;     ///< 0: arms only change
    double length = 0.0;  ///< what a continuous length does not explain
    double part = 0.0;    ///< where: 0 at the first pose, 1 at the second
  };

  /// Where between two poses a muscle's arms jump.
  Jump jump(int muscle, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    double low = 0.0, high = 1.0;
    std::vector<double> below = at_pose(from).gradient;
    double length_below = workspace_.length[muscle];
    std::vector<double> above = at_pose(to).gradient;
    double length_above = workspace_.length[muscle];
    const double whole = difference(muscle, below, above);
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      const std::vector<double>& now = at_pose(from + middle * (to - from)).gradient;
      if (difference(muscle, below, now) > difference(muscle, now, above)) {
        high = middle;
        above = now;
        length_above = workspace_.length[muscle];
      } else {
        low = middle;
        below = now;
        length_below = workspace_.length[muscle];
      }
    }
    const double left = difference(muscle, below, above);
    if (!(left > 0.5 * whole)) return {};
    const double apart = std::abs(length_above - length_below);
    return {left, apart > kLeastLengthJump ? apart : 0.0, 0.5 * (low + high)};
  }

 private:
  static constexpr int kHalvings = 20;
  static constexpr double kLeastLengthJump = 1e-5;  // [m], far above what a motion does in 2^-20 of a step
  const MusculoskeletalSystem& system_;
  Kinematics<double> kinematics_;
  PathWorkspace<double> workspace_;
};

/// Changes between two rows that are looked into [m].
constexpr double kLeastJump = 2e-3;

}  // namespace

std::vector<WrapBandVisit> wrap_band_visits(const MusculoskeletalSystem& system, std::span<const double> time,
                                            const estimation::RowMatrix& q) {
  std::vector<WrapBandVisit> visits;
  if (system.path_source() == PathSource::kAsOpenSim) return visits;
  ArmsAlongMotion arms(system);
  std::vector<int> visit_of(system.muscles().size(), -1);
  std::vector<double> before, now;
  const auto time_of = [&](Eigen::Index row) { return at(row) < time.size() ? time[row] : 0.0; };
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const Eigen::VectorXd pose = q.row(i).transpose();
    const PathWorkspace<double>& workspace = arms.at_pose(pose);
    now = workspace.gradient;
    for (std::size_t m = 0; m < visit_of.size(); ++m) {
      if (workspace.flag[m] == PathFlag::kFine) continue;
      const WrapBandKind kind = workspace.flag[m] == PathFlag::kFading ? WrapBandKind::kEnds : WrapBandKind::kNotFound;
      if (visit_of[m] < 0) {
        visit_of[m] = static_cast<int>(visits.size());
        visits.push_back({static_cast<int>(m), kind, 0, time_of(i), time_of(i), 0.0, 0.0, pose});
      }
      WrapBandVisit& visit = visits[visit_of[m]];
      visit.kind = std::max(visit.kind, kind);
      ++visit.poses;
      visit.last = time_of(i);
    }
    for (int m = 0; i > 0 && m < static_cast<int>(visit_of.size()); ++m) {
      if (!system.paths().can_wrap(m) || arms.difference(m, before, now) < kLeastJump) continue;
      const Eigen::VectorXd last = q.row(i - 1).transpose();
      const ArmsAlongMotion::Jump jump = arms.jump(m, last, pose);
      if (jump.arm < kLeastJump) continue;
      const double t = time_of(i - 1) + jump.part * (time_of(i) - time_of(i - 1));
      visits.push_back(
          {m, WrapBandKind::kSideChange, 1, t, t, jump.arm, jump.length, last + jump.part * (pose - last)});
    }
    before = now;
  }
  return visits;
}

std::string wrap_band_text(const MusculoskeletalSystem& system, const WrapBandVisit& visit) {
  const std::string pose = pose_text(system.model(), system.paths(), visit.muscle, visit.pose);
  const std::string& name = system.model().muscles[visit.muscle].name();
  if (visit.kind == WrapBandKind::kSideChange)
    return fmt::format(
        "muscle '{}' changes the side of a wrap object at {:.4g} s ({}): its moment arm jumps by {:.3g} mm{}", name,
        visit.first, pose, visit.jump * 1e3,
        visit.length_jump > 0.0 ? fmt::format(", its length by {:.3g} mm", visit.length_jump * 1e3) : "");
  const char* what = visit.kind == WrapBandKind::kEnds
                         ? "lets go of a cylinder of its path beyond its end, where its moment arm may be up to about "
                           "three times that of "
                           "the path before and after"
                         : "has a wrap that was not found, and its path is straight there";
  return fmt::format("muscle '{}' {}: {:.4g} to {:.4g} s, {} samples, first at {}", name, what, visit.first, visit.last,
                     visit.poses, pose);
}

}  // namespace veridyn::muscle
