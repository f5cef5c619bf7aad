#include "veridyn/report/figures/skeleton_figure.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/dynamics/skeleton.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::muscle;

/// The two ground axes of a picture: y is up in OpenSim's models, x forward, z to the right.
struct View {
  int across = 0;
  int up = 1;
};

constexpr std::array<const char*, 3> kAxisNames{"x, forward", "y, up", "z, to the right"};

/// View of a study and its result, both of which must outlive it: positions of the model row by row.
class Poses {
 public:
  Poses(const MuscleStudy& study, const MuscleResult& result)
      : study_(study), system_(*study.system), q_(result.trajectory.q), kinematics_(system_.mechanism()) {}

  void set(Eigen::Index row) {
    pose_ = q_.row(row);
    update_positions(system_.mechanism(), pose_.data(), kinematics_);
  }
  [[nodiscard]] std::vector<muscle::Polyline> sticks() const {
    // Without the loads, which would move a stick's far end.
    return bones(study_.written, system_.mechanism(), kinematics_);
  }
  [[nodiscard]] std::vector<Eigen::Vector3d> joints() const {
    std::vector<Eigen::Vector3d> centers;
    for (const Joint& j : system_.model().joints) {
      if (!j.coordinates.empty())
        centers.push_back(body_pose(system_.mechanism(), kinematics_, j.child) * j.child_frame.translation);
    }
    return centers;
  }
  [[nodiscard]] std::vector<Eigen::Vector3d> path(std::size_t m, int arc_points) const {
    return system_.paths().polyline(kinematics_, pose_.data(), static_cast<int>(m), arc_points);
  }

  [[nodiscard]] std::vector<Eigen::Vector3d> loads() const {
    std::vector<Eigen::Vector3d> places;
    for (const HeldLoad& load : study_.loads) {
      const int body = system_.model().body(load.body);
      places.push_back(body_pose(system_.mechanism(), kinematics_, body) * load.location);
    }
    return places;
  }

 private:
  const MuscleStudy& study_;
  const MusculoskeletalSystem& system_;
  const estimation::RowMatrix& q_;
  Kinematics<double> kinematics_;
  Eigen::VectorXd pose_;
};

void append(XYSeries& series, const std::vector<Eigen::Vector3d>& points, const View& view, bool gap) {
  if (gap && !series.x.empty()) {
    series.x.push_back(kNaN);
    series.y.push_back(kNaN);
  }
  for (const Eigen::Vector3d& p : points) {
    series.x.push_back(p(view.across));
    series.y.push_back(p(view.up));
  }
}

std::vector<Eigen::Index> rows_on_the_way(Eigen::Index rows, Eigen::Index poses) {
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < poses; ++i) {
    const Eigen::Index row = (rows - 1) * i / std::max<Eigen::Index>(1, poses - 1);
    if (chosen.empty() || row != chosen.back()) chosen.push_back(row);
  }
  return chosen;
}

/// Leaves out the axis along which the ends of the sticks move least.
View best_view(Poses& poses, const std::vector<Eigen::Index>& rows) {
  std::vector<Eigen::Vector3d> first;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (const Eigen::Index row : rows) {
    poses.set(row);
    std::size_t k = 0;
    for (const auto& stick : poses.sticks()) {
      for (const Eigen::Vector3d& p : stick.points) {
        if (k == first.size()) first.push_back(p);
        moved += (p - first[k]).cwiseAbs();
        ++k;
      }
    }
  }
  if (moved.y() < moved.x() && moved.y() < moved.z()) return {0, 2};
  return moved.z() > moved.x() ? View{2, 1} : View{0, 1};
}

}  // namespace

std::vector<XYPlot> skeleton_figure(const MuscleStudy& study, const MuscleResult& result, std::size_t most_names) {
  const Model& model = study.system->model();
  const Eigen::Index rows = result.trajectory.q.rows();
  if (rows == 0 || !result.trajectory.q.allFinite()) return {};
  Poses poses(study, result);
  const std::vector<Eigen::Index> way = rows_on_the_way(rows, 7);
  const View view = best_view(poses, way);
  const bool named = model.muscles.size() <= most_names;
  // Large models have many paths: the page has to stay small.
  const int arc_points = model.muscles.size() <= 20 ? 16 : 4;

  XYSeries ghosts{
      .name = "bones on the way", .role = Role::kMeasured, .style = Style::kLine, .width = 2.0, .opacity = 0.35};
  for (const Eigen::Index row : way) {
    poses.set(row);
    for (const auto& stick : poses.sticks()) append(ghosts, stick.points, view, true);
  }
  std::vector<XYPlot> plots;
  for (const Eigen::Index row : rows_on_the_way(rows, 2)) {
    poses.set(row);
    XYPlot plot{.title = fmt::format("Pose at {:.4g} s", result.trajectory.time[row]),
                .x = {.label = kAxisNames[view.across], .unit = "m"},
                .y = {.label = kAxisNames[view.up], .unit = "m"},
                .equal_scale = true,
                .height = 460};
    plot.series.push_back(ghosts);
    XYSeries sticks{.name = "bones", .role = Role::kMeasured, .style = Style::kLine, .width = 7.0, .opacity = 0.55};
    for (const auto& stick : poses.sticks()) append(sticks, stick.points, view, true);
    plot.series.push_back(std::move(sticks));
    if (named) {
      for (std::size_t m = 0; m < model.muscles.size(); ++m) {
        XYSeries line{.name = model.muscles[m].name(), .style = Style::kLine, .width = 2.4};
        append(line, poses.path(m, arc_points), view, false);
        if (!line.x.empty()) plot.series.push_back(std::move(line));  // a path by a function is nowhere
      }
    } else {
      XYSeries lines{.name = "muscles", .style = Style::kLine, .width = 1.2, .opacity = 0.7};
      for (std::size_t m = 0; m < model.muscles.size(); ++m) append(lines, poses.path(m, arc_points), view, true);
      plot.series.push_back(std::move(lines));
    }
    XYSeries joints{.name = "joint centres", .role = Role::kReference, .style = Style::kMarkers};
    append(joints, poses.joints(), view, false);
    plot.series.push_back(std::move(joints));
    if (!study.loads.empty()) {
      XYSeries loads{.name = "load", .role = Role::kReference, .style = Style::kMarkers, .width = 13.0};
      append(loads, poses.loads(), view, false);
      plot.series.push_back(std::move(loads));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace veridyn::report
