#include "veridyn/muscle/simulation/external_load_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/muscle/dynamics/external_forces.hpp"

namespace veridyn::muscle {
namespace {

double root_mean_square(const Eigen::VectorXd& v) {
  return v.size() > 0 ? std::sqrt(v.squaredNorm() / static_cast<double>(v.size())) : 0.0;
}

/// What a factor may come from.
std::string explanation(double factor) {
  struct Unit {
    double factor;
    const char* text;
  };
  constexpr std::array<Unit, 5> kUnits{{{1000.0, "kilonewtons"},
                                        {1e-3, "millinewtons"},
                                        {kGravity, "kilograms"},
                                        {4.4482216, "pounds"},
                                        {1.0, "newtons"}}};
  const std::string sign = factor < 0.0 ? "the opposite sign" : "";
  for (const Unit& unit : kUnits) {
    if (std::abs(std::abs(factor) / unit.factor - 1.0) > 0.15) continue;
    if (unit.factor == 1.0) return factor < 0.0 ? ": have they the opposite sign?" : "";
    return fmt::format(": are they in {}{}{}?", unit.text, sign.empty() ? "" : " and of ", sign);
  }
  return sign.empty() ? "" : fmt::format(": have they {}?", sign);
}

/// Median distance of a load's line of action from the origin of its body where it presses [m].
double distance_from_body(const MusculoskeletalSystem& system, const ExternalLoad& load,
                          const MotionAnalysis& analysis) {
  const Mechanism& mechanism = system.mechanism();
  Kinematics<double> kinematics(mechanism);
  std::vector<double> force, distance;
  for (Eigen::Index i = 0; i < analysis.q.rows(); ++i) {
    const Eigen::VectorXd q = analysis.q.row(i);
    update_positions(mechanism, q.data(), kinematics);
    const SpatialVector<double> wrench = external_wrench(load, analysis.time[i], mechanism, kinematics);
    const Eigen::Vector3d origin = body_pose(mechanism, kinematics, load.body).position;
    const Eigen::Vector3d moment = wrench.angular - origin.cross(wrench.linear);
    const double size = wrench.linear.norm();
    force.push_back(size);
    distance.push_back(size > 0.0 ? moment.cross(wrench.linear).norm() / (size * size) : 0.0);
  }
  const double greatest = force.empty() ? 0.0 : *std::max_element(force.begin(), force.end());
  std::vector<double> pressing;
  for (std::size_t i = 0; i < force.size(); ++i)
    if (force[i] > 0.1 * greatest) pressing.push_back(distance[i]);
  return pressing.empty() ? 0.0 : upper_median(pressing);
}

double weight_of(const Model& model) {
  double weight = 0.0;
  for (std::size_t b = 1; b < model.bodies.size(); ++b) weight += model.bodies[b].mass * model.gravity.norm();
  return weight;
}

}  // namespace

int lifting_coordinate(const MusculoskeletalSystem& system) {
  const Model& model = system.model();
  if (!(model.gravity.norm() > 0.0)) return -1;
  const Eigen::Vector3d up = -model.gravity.normalized();
  for (const int c : system.reduction().free()) {
    const Joint& joint = model.joints[model.coordinates[c].joint];
    if (joint.parent != 0) continue;
    for (const TransformAxis& axis : joint.translation) {
      if (axis.coordinate != c || !axis.function.is_linear() || axis.function.is_constant()) continue;
      if ((joint.parent_frame.rotation * axis.axis).dot(up) > 0.99) return c;
    }
  }
  return -1;
}

ExternalLoadFit external_load_fit(const MusculoskeletalSystem& system, const MotionAnalysis& analysis) {
  ExternalLoadFit fit;
  fit.coordinate = lifting_coordinate(system);
  fit.weight = weight_of(system.model());
  if (fit.coordinate < 0 || analysis.external.size() == 0) return fit;
  const Eigen::VectorXd loads = analysis.external.col(fit.coordinate), left = analysis.moment.col(fit.coordinate);
  const Eigen::VectorXd needed = left + loads;
  fit.without = root_mean_square(needed);
  fit.with = root_mean_square(left);
  if (loads.squaredNorm() > 0.0) fit.factor = needed.dot(loads) / loads.squaredNorm();
  return fit;
}

std::vector<std::string> external_load_warnings(const MusculoskeletalSystem& system, const ExternalLoads& loads,
                                                const MotionAnalysis& analysis) {
  std::vector<std::string> warnings;
  const ExternalLoadFit fit = external_load_fit(system, analysis);
  if (fit.coordinate >= 0) {
    const std::string& name = system.model().coordinates[fit.coordinate].name;
    const double share = 100.0 * fit.with / fit.weight;
    if (fit.with > fit.without) {
      warnings.push_back(fmt::format(
          "the external loads do not fit the motion: '{}' lacks {:.3g} N ({:.3g} % of the weight) with them, {:.3g} N "
          "without; times {:.3g} they would fit best{}",
          name, fit.with, share, fit.without, fit.factor, explanation(fit.factor)));
    } else if (share > 10.0) {
      warnings.push_back(
          fmt::format("the external loads leave {:.3g} N ({:.3g} % of the weight) at '{}'; times {:.3g} they would fit "
                      "best{}",
                      fit.with, share, name, fit.factor, explanation(fit.factor)));
    }
  }
  constexpr double kFarFromBody_m = 1.0;
  for (const ExternalLoad& load : loads.loads) {
    const double distance = distance_from_body(system, load, analysis);
    if (distance > kFarFromBody_m)
      warnings.push_back(fmt::format(
          "external load '{}' acts {:.3g} m from body '{}' (median): is its point in millimetres, or in another frame?",
          load.name, distance, system.model().bodies[load.body].name));
  }
  return warnings;
}

std::string lifting_reserve_warning(const MusculoskeletalSystem& system, const estimation::RowMatrix& reserve) {
  const int c = lifting_coordinate(system);
  const double weight = weight_of(system.model());
  if (c < 0 || reserve.size() == 0 || !(weight > 0.0)) return {};
  const double greatest = reserve.col(c).cwiseAbs().maxCoeff();
  if (!(greatest > 0.05 * weight)) return {};
  return fmt::format(
      "the reserve of '{}' carries up to {:.3g} N ({:.3g} % of the weight), which only the surroundings "
      "could: external loads are missing or do not fit",
      system.model().coordinates[c].name, greatest, 100.0 * greatest / weight);
}

}  // namespace veridyn::muscle
