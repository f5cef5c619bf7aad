#include "veridyn/camera/tracking/pose_tables.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/tables/table.hpp"

namespace veridyn::camera {
namespace {

constexpr const char* kPoseColumns =
    "x[m],y[m],heading[rad],cov_xx[m^2],cov_xy[m^2],cov_xh[m rad],cov_yy[m^2],cov_yh[m rad],cov_hh[rad^2]";

std::string pose_cells(const Eigen::Vector3d& pose, const Eigen::Matrix3d& P) {
  return fmt::format("{},{},{},{},{},{},{},{},{}", pose(0), pose(1), pose(2), P(0, 0), P(0, 1), P(0, 2), P(1, 1),
                     P(1, 2), P(2, 2));
}

}  // namespace

std::string poses_csv(std::span<const TrackedPose> poses) {
  std::string text = fmt::format("time[s],seen,{},velocity_x[m/s],velocity_y[m/s],yaw_rate[rad/s]\n", kPoseColumns);
  for (const TrackedPose& p : poses) {
    if (p.status == TrackStatus::kLost) continue;
    text += fmt::format("{},{},{},{},{},{}\n", p.time, p.status == TrackStatus::kMeasured ? 1 : 0,
                        pose_cells(p.pose, p.covariance), p.velocity(0), p.velocity(1), p.velocity(2));
  }
  return text;
}

std::string measured_poses_csv(std::span<const TrackedPose> poses) {
  std::string text = fmt::format("time[s],{},markers\n", kPoseColumns);
  for (const TrackedPose& p : poses) {
    if (!p.measured) continue;
    text +=
        fmt::format("{},{},{}\n", p.time, pose_cells(p.measured->pose, p.measured->covariance()), p.measured->markers);
  }
  return text;
}

std::vector<TimedPose> parse_poses(std::string_view text, std::string source) {
  const io::Table table = io::parse_table(text, std::move(source));
  const auto column = [&](const char* name) -> const std::vector<double>& { return table.at(name).value; };
  const auto &t = column("time"), &x = column("x"), &y = column("y"), &heading = column("heading");
  const auto &xx = column("cov_xx"), &xy = column("cov_xy"), &xh = column("cov_xh"), &yy = column("cov_yy"),
             &yh = column("cov_yh"), &hh = column("cov_hh");
  std::vector<TimedPose> poses;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    TimedPose p{.time = t[i], .pose = {x[i], y[i], heading[i]}, .covariance = {}};
    p.covariance << xx[i], xy[i], xh[i], xy[i], yy[i], yh[i], xh[i], yh[i], hh[i];
    const std::string place = fmt::format("{}:{}", table.source, table.lines[i]);
    if (!std::isfinite(p.time) || !p.pose.allFinite() || !p.covariance.allFinite())
      throw InputError(place, "a cell is missing or not a finite number");
    if (!poses.empty() && !(p.time > poses.back().time))
      throw InputError(place, fmt::format("its time {} s does not follow {} s", p.time, poses.back().time));
    if (p.covariance.llt().info() != Eigen::Success) throw InputError(place, "its covariance is not positive definite");
    poses.push_back(p);
  }
  return poses;
}

std::vector<TimedPose> read_poses(const std::filesystem::path& path) {
  return parse_poses(read_file(path), path.string());
}

}  // namespace veridyn::camera
