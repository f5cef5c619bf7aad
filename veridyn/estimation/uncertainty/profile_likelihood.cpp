#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/quiet_progress.hpp"
#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

/// The root of the statistic at the threshold is found to this share of it; interpolation does the rest.
constexpr double kRootTolerance = 0.02;
/// A statistic that falls so far below zero is another minimum, from which profiles begin again.
constexpr double kLower = 0.05;
constexpr int kRestarts = 3;

/// View of a model with one parameter fixed, and its segments' unknowns starting where an estimate left them.
class WithOneFixed final : public ModelView {
 public:
  /// @param parameter none: all free, only the starts are those of the estimate
  WithOneFixed(const ParametricModel& model, std::optional<std::size_t> parameter, double value,
               const std::vector<std::vector<ModelParameter>>& initial)
      : ModelView(model), parameters_(model.parameters().begin(), model.parameters().end()), initial_(initial) {
    if (!parameter) return;
    parameters_[*parameter].fixed = true;
    parameters_[*parameter].start = value;
  }
  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t s) const override { return initial_[s]; }

 private:
  std::vector<ModelParameter> parameters_;
  const std::vector<std::vector<ModelParameter>>& initial_;
};

/// One side of a profile: points ordered away from the estimate, of the signed root r of the statistic.
struct Side {
  std::vector<ProfilePoint> points;
  double end = kNaN;
  ProfileEnd how = ProfileEnd::kNotFound;
  int fits = 0;
};

double root_of(const ProfilePoint& point) { return std::sqrt(std::max(0.0, point.statistic)); }

/// View of one call's arguments, with where profiles begin.
class Profiling {
 public:
  Profiling(const ParametricModel& model, const std::vector<RowMatrix>& measured, const OutputErrorEstimate& estimate,
            const ProfileOptions& options, Progress& progress)
      : model_(model), measured_(measured), options_(options), progress_(progress) {
    fit_ = options.output_error;
    fit_.covariance = CovarianceKind::kWhite;
    fit_.hold_undetermined = false;
    covariance_ = estimate.covariance_white;
    theta_ = estimate.theta;
    take_starts(estimate);
    threshold_ = numerics::chi_square_quantile(options.confidence, 1.0);
  }

  ProfileResult run(const std::vector<std::size_t>& parameters) {
    ProfileResult result;
    result.threshold = threshold_;
    if (!settle(result)) return result;
    const double first = cost_;
    for (int round = 0; round <= kRestarts; ++round) {
      const std::vector<Side> sides = follow(parameters);
      for (const Side& side : sides) result.fits += side.fits;
      result.interrupted = progress_.interrupted();
      result.profiles = assembled(parameters, sides);
      const ProfilePoint* lowest = lowest_of(result.profiles);
      if (result.interrupted || lowest == nullptr || lowest->statistic > -kLower || round == kRestarts) break;
      theta_ = lowest->theta;
      if (!settle(result)) return result;
    }
    result.gain += 2.0 * (first - cost_) / options_.dispersion;
    result.theta = theta_;
    return result;
  }

 private:
  void take_starts(const OutputErrorEstimate& estimate) {
    initial_.clear();
    std::vector<SegmentParameter> left = estimate.segment_parameters;
    for (std::size_t s = 0; s < model_.segments(); ++s) {
      const auto initial = model_.initial_conditions(s);
      initial_.emplace_back(initial.begin(), initial.end());
      for (ModelParameter& p : initial_.back()) {
        const auto found = std::find_if(left.begin(), left.end(),
                                        [&](const SegmentParameter& q) { return q.segment == s && q.name == p.name; });
        // A prior is about the start, which then has to stay.
        if (found != left.end() && !std::isfinite(p.prior_sigma)) p.start = std::clamp(found->value, p.low, p.high);
      }
    }
  }

  /// All parameters free, from where they are: the statistic's zero. False when it does not work out.
  bool settle(ProfileResult& result) {
    const WithOneFixed all(model_, std::nullopt, 0.0, initial_);
    OutputErrorOptions o = fit_;
    o.threads = progress_.threads();
    o.search_start = theta_;
    QuietProgress watch(progress_, 0);
    // What the given estimate costs, by the same computation.
    o.max_steps = 0;
    const OutputErrorEstimate before = output_error(all, measured_, o, watch);
    o.max_steps = fit_.max_steps;
    const OutputErrorEstimate after = output_error(all, measured_, o, watch);
    ++result.fits;
    if (progress_.interrupted()) {
      result.interrupted = true;
      return false;
    }
    if (!after.usable() || !before.usable()) {
      result.message = fmt::format("no profile: {}", after.usable() ? before.message : after.message);
      return false;
    }
    samples_as_one_ = after.samples_as_one;
    const double old = cost(all, before, std::nullopt), now = cost(all, after, std::nullopt);
    if (now < old) {
      theta_ = after.theta;
      take_starts(after);
      if (estimates_noise()) fit_.noise_start = after.noise_covariance.diagonal().cwiseSqrt();
    }
    if (after.covariance_white.allFinite()) covariance_ = after.covariance_white;
    cost_ = std::min(old, now);
    if (result.profiles.empty()) result.gain = 2.0 * (old - cost_) / options_.dispersion;
    return true;
  }

  [[nodiscard]] double dispersion_of(std::size_t parameter) const {
    return options_.dispersion * (options_.inflation.empty() ? 1.0 : options_.inflation[parameter]);
  }

  [[nodiscard]] bool estimates_noise() const { return fit_.noise != OutputNoise::kGiven; }

  /// Negative log posterior; `fixed` has its prior too, which the estimator does not count.
  [[nodiscard]] double cost(const ParametricModel& model, const OutputErrorEstimate& e,
                            std::optional<std::size_t> fixed) const {
    double sum = e.negative_log_likelihood;
    const auto add = [&](double value, const ModelParameter& p) {
      if (std::isfinite(p.prior_sigma)) sum += 0.5 * samples_as_one_ * std::pow((value - p.start) / p.prior_sigma, 2);
    };
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      const ModelParameter& p = model_.parameters()[i];
      if (!p.fixed || fixed == i) add(e.theta(i), p);
    }
    for (const SegmentParameter& q : e.segment_parameters) {
      for (const ModelParameter& p : model.initial_conditions(q.segment))
        if (p.name == q.name) add(q.value, p);
    }
    return sum;
  }

  /// The best fit with `parameter` at `value`, begun at `from`.
  std::optional<ProfilePoint> fit(std::size_t parameter, double value, Eigen::VectorXd from, int threads) const {
    const WithOneFixed model(model_, parameter, value, initial_);
    for (Eigen::Index i = 0; i < from.size(); ++i) {
      const ModelParameter& p = model.parameters()[i];
      from(i) = p.fixed ? p.start : std::clamp(from(i), p.low, p.high);
    }
    OutputErrorOptions o = fit_;
    o.threads = threads;
    o.search_start = std::move(from);
    QuietProgress watch(progress_, 0);
    const OutputErrorEstimate e = output_error(model, measured_, o, watch);
    if (!e.usable()) return std::nullopt;
    return ProfilePoint{value, 2.0 * (cost(model, e, parameter) - cost_) / dispersion_of(parameter), e.theta};
  }

  /// Where the other parameters are expected at `value`: on the line through the last two points, or that of the
  /// covariance.
  [[nodiscard]] Eigen::VectorXd expected(std::size_t parameter, double value, const Side& side) const {
    const auto i = signed_index(parameter);
    const ProfilePoint* last = nullptr;
    const ProfilePoint* before = nullptr;
    for (const ProfilePoint& p : side.points) {
      if (last == nullptr || std::abs(p.value - value) < std::abs(last->value - value)) last = &p;
    }
    for (const ProfilePoint& p : side.points) {
      if (&p == last) continue;
      if (before == nullptr || std::abs(p.value - value) < std::abs(before->value - value)) before = &p;
    }
    if (before != nullptr)
      return last->theta + (value - last->value) / (last->value - before->value) * (last->theta - before->theta);
    const double variance = covariance_(i, i);
    if (!(variance > 0.0 && std::isfinite(variance))) return last->theta;
    return last->theta + (value - last->value) / variance * covariance_.col(i);
  }

  /// The first step: to half the interval that the covariance says, within the bounds.
  [[nodiscard]] double first_step(std::size_t parameter, double sign) const {
    const ModelParameter& p = model_.parameters()[parameter];
    const double sigma = std::sqrt(covariance_(parameter, parameter) * dispersion_of(parameter));
    const double room = sign > 0.0 ? p.high - theta_(parameter) : theta_(parameter) - p.low;
    const double wanted = std::isfinite(sigma) && sigma > 0.0
                              ? 0.5 * std::sqrt(threshold_) * sigma
                              : (std::isfinite(room) ? 0.25 * room : 0.1 * std::max(1e-3, std::abs(p.start)));
    return std::min(wanted, room);
  }

  /// Outwards until the threshold is passed or the bound reached, then inwards.
  Side follow_side(std::size_t parameter, double sign, int threads) const {
    const ModelParameter& p = model_.parameters()[parameter];
    const double centre = theta_(parameter), goal = std::sqrt(threshold_);
    const double bound = sign > 0.0 ? p.high : p.low;
    Side side;
    side.points.push_back({centre, 0.0, theta_});
    double distance = first_step(parameter, sign);
    double diverged = kInfinity;  // distance at which a simulation did
    if (!(distance > 0.0)) {
      side.how = ProfileEnd::kOpen;
      return side;
    }
    std::optional<ProfilePoint> beyond;
    while (side.fits < options_.max_fits && !progress_.interrupted()) {
      const double room = std::abs(bound - centre);
      distance = std::min(distance, room);
      // Rounding may not leave the bounds.
      const double value = distance >= room ? bound : centre + sign * distance;
      ++side.fits;
      const std::optional<ProfilePoint> found = fit(parameter, value, expected(parameter, value, side), threads);
      if (!found) {
        diverged = distance;
        distance = 0.5 * (distance + std::abs(side.points.back().value - centre));
        continue;
      }
      const double r = root_of(*found);
      if (r >= goal) {
        if (!beyond || std::abs(found->value - centre) < std::abs(beyond->value - centre)) beyond = found;
      } else {
        side.points.push_back(*found);
        if (value == bound) {
          side.how = ProfileEnd::kOpen;
          return side;
        }
      }
      if (beyond && done(side, *beyond, centre)) break;
      distance = next_distance(side, beyond, centre, goal);
      if (distance >= diverged) distance = 0.5 * (diverged + std::abs(side.points.back().value - centre));
    }
    if (beyond && !progress_.interrupted() && done(side, *beyond, centre)) {
      side.how = ProfileEnd::kClosed;
      side.end = crossing(side, *beyond, goal);
    }
    if (beyond) side.points.push_back(*beyond);
    return side;
  }

  /// Whether one of the two points around the threshold is on it, or both are next to each other.
  [[nodiscard]] bool done(const Side& side, const ProfilePoint& beyond, double centre) const {
    const double goal = std::sqrt(threshold_);
    const ProfilePoint& inside = side.points.back();
    const double width = std::abs(beyond.value - inside.value) / std::abs(beyond.value - centre);
    return root_of(beyond) - goal <= kRootTolerance * goal || goal - root_of(inside) <= kRootTolerance * goal ||
           width < 0.25 * kRootTolerance;
  }

  [[nodiscard]] double next_distance(const Side& side, const std::optional<ProfilePoint>& beyond, double centre,
                                     double goal) const {
    const ProfilePoint& inside = side.points.back();
    const double d = std::abs(inside.value - centre);
    if (beyond) {
      const double to = std::abs(crossing(side, *beyond, goal) - centre);
      // Never next to an end of the bracket, where it would hardly shrink.
      const double outer = std::abs(beyond->value - centre), margin = 0.1 * (outer - d);
      return std::clamp(to, d + margin, outer - margin);
    }
    const double r = root_of(inside);
    double slope = d > 0.0 ? r / d : 0.0;
    if (side.points.size() > 2) {
      const ProfilePoint& before = side.points[side.points.size() - 2];
      slope = (r - root_of(before)) / std::abs(inside.value - before.value);
    }
    // A flat profile is left in growing steps.
    const double most = 3.0 * d;
    return slope > 0.0 ? std::clamp(d + (goal - r) / slope, 1.05 * d, most) : most;
  }

  /// Where the line through the two points around the threshold crosses it; a parabola with the point before them.
  [[nodiscard]] static double crossing(const Side& side, const ProfilePoint& beyond, double goal) {
    const ProfilePoint& inside = side.points.back();
    const double r0 = root_of(inside), r1 = root_of(beyond);
    const double line = inside.value + (goal - r0) / (r1 - r0) * (beyond.value - inside.value);
    if (side.points.size() < 2) return line;
    const ProfilePoint& before = side.points[side.points.size() - 2];
    const double r2 = root_of(before);
    if (!(r2 < r0)) return line;
    // Inverse quadratic interpolation: value as a function of the root.
    const double parabola = inside.value * (goal - r1) * (goal - r2) / ((r0 - r1) * (r0 - r2)) +
                            beyond.value * (goal - r0) * (goal - r2) / ((r1 - r0) * (r1 - r2)) +
                            before.value * (goal - r0) * (goal - r1) / ((r2 - r0) * (r2 - r1));
    const double low = std::min(inside.value, beyond.value), high = std::max(inside.value, beyond.value);
    return parabola >= low && parabola <= high ? parabola : line;
  }

  std::vector<Side> follow(const std::vector<std::size_t>& parameters) {
    std::vector<Side> sides(2 * parameters.size());
    const int threads = progress_.threads();
    // Few sides leave threads to the segments of each.
    const int inner = threads > 0 ? std::max(1, threads / static_cast<int>(std::max<std::size_t>(1, sides.size()))) : 1;
    numerics::parallel_for(
        sides.size(), threads,
        [&](std::size_t k) { sides[k] = follow_side(parameters[k / 2], k % 2 == 0 ? -1.0 : 1.0, inner); },
        [&](std::size_t done) {
          return progress_.update(static_cast<double>(done) / static_cast<double>(sides.size()));
        });
    return sides;
  }

  [[nodiscard]] std::vector<ParameterProfile> assembled(const std::vector<std::size_t>& parameters,
                                                        const std::vector<Side>& sides) const {
    std::vector<ParameterProfile> profiles;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const ModelParameter& p = model_.parameters()[parameters[k]];
      const Side &low = sides[2 * k], &high = sides[2 * k + 1];
      ParameterProfile profile{.parameter = parameters[k],
                               .name = p.name,
                               .unit = p.unit,
                               .value = theta_(parameters[k]),
                               .low_bound = p.low,
                               .high_bound = p.high,
                               .low = low.end,
                               .high = high.end,
                               .low_end = low.how,
                               .high_end = high.how};
      profile.points = low.points;
      if (!high.points.empty()) profile.points.insert(profile.points.end(), high.points.begin() + 1, high.points.end());
      std::sort(profile.points.begin(), profile.points.end(),
                [](const ProfilePoint& a, const ProfilePoint& b) { return a.value < b.value; });
      profiles.push_back(std::move(profile));
    }
    return profiles;
  }

  static const ProfilePoint* lowest_of(const std::vector<ParameterProfile>& profiles) {
    const ProfilePoint* lowest = nullptr;
    for (const ParameterProfile& profile : profiles) {
      for (const ProfilePoint& point : profile.points)
        if (lowest == nullptr || point.statistic < lowest->statistic) lowest = &point;
    }
    return lowest;
  }

  const ParametricModel& model_;
  const std::vector<RowMatrix>& measured_;
  const ProfileOptions& options_;
  Progress& progress_;
  OutputErrorOptions fit_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd theta_;
  std::vector<std::vector<ModelParameter>> initial_;
  double samples_as_one_ = 1.0;  // of the estimate, for priors
  double cost_ = 0.0;
  double threshold_ = 0.0;
};

}  // namespace

void ProfileOptions::validate() const {
  if (!(confidence > 0.0 && confidence < 1.0))
    throw InputError("profile.confidence", fmt::format("is {}; must be in (0, 1)", confidence));
  if (!(dispersion >= 1.0)) throw InputError("profile.dispersion", fmt::format("is {}; must be >= 1", dispersion));
  for (const double i : inflation) {
    if (!(i >= 1.0 && i < kInfinity))
      throw InputError("profile.inflation", fmt::format("has {}; must be finite and >= 1", i));
  }
  if (max_fits < 2) throw InputError("profile.max_fits", fmt::format("is {}; must be >= 2", max_fits));
}

std::string_view to_string(ProfileEnd end) {
  switch (end) {
    case ProfileEnd::kClosed:
      return "closed";
    case ProfileEnd::kOpen:
      return "open";
    case ProfileEnd::kNotFound:
      return "not found";
  }
  return "";
}

std::string ParameterProfile::text() const {
  const auto end = [](ProfileEnd how, double at, const char* side) {
    return how == ProfileEnd::kClosed ? fmt::format("{:.5g}", at) : fmt::format("{} {}", to_string(how), side);
  };
  return fmt::format("{} .. {}", end(low_end, low, "below"), end(high_end, high, "above"));
}

ProfileResult profile_likelihood(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                 const OutputErrorEstimate& estimate, const std::vector<std::size_t>& parameters,
                                 const ProfileOptions& options, Progress& progress) {
  options.validate();
  options.output_error.validate(model);
  if (!options.inflation.empty() && options.inflation.size() != model.parameters().size())
    throw InputError("profile.inflation", fmt::format("has {} values for {} parameters", options.inflation.size(),
                                                      model.parameters().size()));
  for (const std::size_t i : parameters) {
    if (i >= model.parameters().size())
      throw InputError("profile.parameters", fmt::format("{} is not one of {}", i, model.parameters().size()));
    if (model.parameters()[i].fixed)
      throw InputError("profile.parameters",
                       fmt::format("'{}' is fixed and has no profile", model.parameters()[i].name));
  }
  if (!estimate.usable()) {
    ProfileResult none;
    none.message = "no profile: there is no estimate to begin at";
    return none;
  }
  return Profiling(model, measured, estimate, options, progress).run(parameters);
}

}  // namespace veridyn::estimation
