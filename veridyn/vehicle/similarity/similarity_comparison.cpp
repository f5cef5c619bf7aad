#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {

namespace {

double mismatch_percent(double prototype, double model) {
  if (prototype == model) return 0.0;
  if (prototype == 0.0 || !std::isfinite(prototype) || !std::isfinite(model)) return kInfinity;
  return (model / prototype - 1.0) * 100.0;
}

/// One way of saying how a vehicle behaves.
struct Behaviour {
  const char* name;
  const char* unit;
  double value;
};

/// Angular frequency of mass on spring [rad/s].
double frequency(double stiffness, double inertia) { return std::sqrt(stiffness / inertia); }
double in_series(double one, double other) { return one * other / (one + other); }

/// Numbers from closed forms, one mode at a time: the handling of the linear bicycle, and ride, roll and pitch as
/// uncoupled oscillators on suspension and tyre in series.
std::vector<Behaviour> behaviour_of(const SimilaritySubject& subject) {
  const VehicleParameters<double>& p = subject.parameters;
  const LinearBicycle<double> bicycle{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, subject.speed};
  const BicycleCharacteristics<double> c = characteristics(bicycle);
  const double sprung = p.mass - 4.0 * p.unsprung_mass;
  const double ride_f = in_series(p.K_sf, p.K_tf);
  const double ride_r = in_series(p.K_sr, p.K_tr);
  const auto roll_of = [](double track, double spring, double bar, double tyre) {
    return 0.5 * track * track * in_series(spring + 2.0 * bar, tyre);
  };
  const double roll = roll_of(p.track_f, p.K_sf, p.K_bf, p.K_tf) + roll_of(p.track_r, p.K_sr, p.K_br, p.K_tr);
  const double pitch = 2.0 * (p.a * p.a * ride_f + p.b * p.b * ride_r);
  std::vector<Behaviour> list{
      {"understeer gradient", "rad s^2/m", c.understeer_gradient},
      {"yaw rate gain", "1/s", c.yaw_rate_gain},
      {"lateral acceleration gain", "m/s^2/rad", c.lateral_acceleration_gain},
      {"sideslip gain", "1", c.sideslip_gain},
      {"yaw natural frequency", "rad/s", c.natural_frequency},
      {"yaw damping ratio", "1", c.damping_ratio},
      {"yaw rate bandwidth", "rad/s", c.bandwidth},
      {"heave frequency", "rad/s", frequency(2.0 * (ride_f + ride_r), sprung)},
      {"roll frequency", "rad/s", frequency(roll, p.I_x)},
      {"pitch frequency", "rad/s", frequency(pitch, p.I_y)},
      {"front wheel hop frequency", "rad/s", frequency(p.K_sf + p.K_tf, p.unsprung_mass)},
      {"rear wheel hop frequency", "rad/s", frequency(p.K_sr + p.K_tr, p.unsprung_mass)},
      {"roll angle per lateral acceleration", "rad s^2/m", sprung * p.cg_height / roll},
  };
  if (p.cg_height > 0.0) {
    list.push_back({"lateral acceleration at lift-off of a rigid vehicle", "m/s^2",
                    subject.gravity * 0.5 * std::min(p.track_f, p.track_r) / p.cg_height});
  }
  list.push_back({"sinking of the front axle under static load", "m",
                  p.mass * subject.gravity * p.b / (2.0 * p.wheelbase() * ride_f)});
  if (std::isfinite(p.mu)) {
    list.push_back({"lateral acceleration at the friction limit", "m/s^2", p.mu * subject.gravity});
  }
  return list;
}

std::string ratio_text(double factor) {
  return factor < 1.0 ? fmt::format("1/{:.4g}", 1.0 / factor) : fmt::format("{:.4g}", factor);
}

std::vector<std::string> what_gravity_changes(const ScaleFactors& factors, const GroupComparison& gravity,
                                              double weight_factor) {
  const double relative = gravity.model / gravity.prototype;
  return {
      fmt::format(
          "forces scale by {} but weight by {}: compared with the forces of the motion the model is {:.4g} times as "
          "heavy as the prototype",
          ratio_text(factors.force()), ratio_text(weight_factor), relative),
      fmt::format("lift-off and rollover come at {:.4g} times the lateral acceleration, in the prototype's scale",
                  relative),
      fmt::format(
          "the friction limit at equal mu lies at {:.4g} times the lateral acceleration, in the prototype's scale",
          relative),
      fmt::format("static sinking of springs and tyres is {:.4g} times as large compared with the length of the "
                  "vehicle; suspension "
                  "travel scales about another rest position",
                  relative),
      fmt::format(
          "tyres whose forces depend on the load work at loads {:.4g} times too large: their nominal load must scale "
          "with weight, not with force, to keep the static point",
          relative),
      "motions of a linear vehicle about its rest position are not changed"};
}

}  // namespace

SimilarityReport compare(const SimilaritySubject& prototype, const SimilaritySubject& model,
                         std::span<const std::string> repeating, double tolerance_percent) {
  SimilarityReport report;
  report.tolerance_percent = tolerance_percent;
  report.factors = scale_factors(prototype, model);
  report.repeating.assign(repeating.begin(), repeating.end());
  const bool friction = std::isfinite(prototype.parameters.mu) || std::isfinite(model.parameters.mu);
  const std::vector<SimilarityParameter> ours = internal::similarity_parameters(prototype, friction);
  const std::vector<SimilarityParameter> theirs = internal::similarity_parameters(model, friction);
  report.parameters = ours.size();
  const internal::RankedGroups ranked = internal::similarity_groups(ours, repeating);
  report.rank = ranked.rank;
  const std::vector<SimilarityGroup>& left = ranked.groups;
  const std::vector<SimilarityGroup> right = internal::similarity_groups(theirs, repeating).groups;

  const auto affects = [](const std::vector<SimilarityParameter>& list, const std::string& name) {
    const auto found = std::ranges::find(list, name, &SimilarityParameter::name);
    return found == list.end() ? std::string() : found->affects;
  };
  constexpr double kNone = kNaN;
  for (const SimilarityGroup& group : left) {
    if (group.parameter == "gravity") continue;
    const auto found = std::ranges::find(right, group.parameter, &SimilarityGroup::parameter);
    const double value = found == right.end() ? kNone : found->value;
    // The same name with another dimension is another quantity.
    const bool comparable = found != right.end() && found->formula == group.formula;
    report.groups.push_back({group.parameter, group.formula, group.value, value,
                             comparable ? mismatch_percent(group.value, value) : kInfinity,
                             affects(ours, group.parameter)});
  }
  for (const SimilarityGroup& group : right) {
    if (group.parameter == "gravity" ||
        std::ranges::find(left, group.parameter, &SimilarityGroup::parameter) != left.end()) {
      continue;
    }
    report.groups.push_back(
        {group.parameter, group.formula, kNone, group.value, kInfinity, affects(theirs, group.parameter)});
  }

  const auto froude = [](const SimilaritySubject& s) {
    return s.gravity * s.parameters.wheelbase() / (s.speed * s.speed);
  };
  report.gravity = {"gravity",
                    "g L/u^2",
                    froude(prototype),
                    froude(model),
                    mismatch_percent(froude(prototype), froude(model)),
                    affects(ours, "gravity")};
  if (std::abs(report.gravity.mismatch_percent) > tolerance_percent) {
    report.gravity_changes =
        what_gravity_changes(report.factors, report.gravity, report.factors.mass * model.gravity / prototype.gravity);
  }

  const std::vector<Behaviour> of_prototype = behaviour_of(prototype);
  const std::vector<Behaviour> of_model = behaviour_of(model);
  const ScaleFactors back = report.factors.inverse();
  for (const Behaviour& one : of_prototype) {
    const auto found = std::ranges::find_if(
        of_model, [&](const Behaviour& other) { return std::string_view(other.name) == one.name; });
    if (found == of_model.end()) continue;
    const double value = found->value * back.of(one.unit);
    report.behaviour.push_back({one.name, one.unit, one.value, value, mismatch_percent(one.value, value)});
  }
  return report;
}

std::vector<GroupComparison> SimilarityReport::mismatches() const {
  std::vector<GroupComparison> found;
  for (const GroupComparison& group : groups) {
    if (!(std::abs(group.mismatch_percent) <= tolerance_percent)) found.push_back(group);
  }
  std::ranges::stable_sort(found, std::greater<>(),
                           [](const GroupComparison& g) { return std::abs(g.mismatch_percent); });
  return found;
}

bool SimilarityReport::similar_without_gravity() const { return mismatches().empty(); }

bool SimilarityReport::similar() const {
  return similar_without_gravity() && std::abs(gravity.mismatch_percent) <= tolerance_percent;
}

std::string SimilarityReport::message() const {
  const std::vector<GroupComparison> found = mismatches();
  std::string text =
      found.empty()
          ? fmt::format("all {} groups without gravity agree within {:g} %", groups.size(), tolerance_percent)
          : fmt::format("{} of {} groups differ by more than {:g} %:", found.size(), groups.size(), tolerance_percent);
  for (std::size_t i = 0; i < found.size(); ++i) {
    text += fmt::format("{} {} {:+.1f} %", i == 0 ? "" : ",", found[i].parameter, found[i].mismatch_percent);
  }
  if (std::abs(gravity.mismatch_percent) > tolerance_percent) {
    text += fmt::format("; gravity {:+.4g} % ({} is {:.4f}, of the model {:.4f})", gravity.mismatch_percent,
                        gravity.formula, gravity.prototype, gravity.model);
  }
  return text;
}

}  // namespace veridyn::vehicle
