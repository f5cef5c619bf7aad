#include "veridyn/muscle/identification/normalised_fiber_lengths.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"

namespace veridyn::muscle {
namespace {

/// A coordinate that moves in both models, and the range that they share.
struct SharedCoordinate {
  std::size_t in_reference, in_subject;  ///< of the free coordinates
  double low, high;
};

std::vector<SharedCoordinate> shared_coordinates(const MusculoskeletalSystem& reference,
                                                 const MusculoskeletalSystem& subject) {
  std::vector<SharedCoordinate> shared;
  const std::span<const int> of_reference = reference.reduction().free(), of_subject = subject.reduction().free();
  for (std::size_t r = 0; r < of_reference.size(); ++r) {
    const Coordinate& a = reference.model().coordinates[of_reference[r]];
    for (std::size_t s = 0; s < of_subject.size(); ++s) {
      const Coordinate& b = subject.model().coordinates[of_subject[s]];
      if (a.name != b.name) continue;
      const double low = std::max(a.low, b.low), high = std::min(a.high, b.high);
      if (low <= high) shared.push_back({r, s, low, high});
    }
  }
  return shared;
}

/// Path lengths of all muscles at poses: poses x muscles.
Eigen::MatrixXd path_lengths(const MusculoskeletalSystem& system, const Eigen::MatrixXd& points,
                             const std::vector<SharedCoordinate>& shared, std::size_t SharedCoordinate::*which) {
  const std::span<const int> free = system.reduction().free();
  std::vector<double> z(free.size()), zdot(free.size(), 0.0);
  for (std::size_t i = 0; i < free.size(); ++i) z[i] = system.model().coordinates[free[i]].default_value;
  SystemEvaluator<double> evaluator(system);
  Eigen::MatrixXd length(points.rows(), system.muscles().size());
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    for (std::size_t c = 0; c < shared.size(); ++c)
      z[shared[c].*which] = shared[c].low + points(p, c) * (shared[c].high - shared[c].low);
    evaluator.set_motion(z.data(), zdot.data());
    const std::span<const double> found = evaluator.path_length();
    for (std::size_t m = 0; m < found.size(); ++m) length(p, m) = found[m];
  }
  return length;
}

/// A muscle at rest.
struct NormalisedState {
  double fiber = 0.0;   ///< l/L0
  double along = 0.0;   ///< l/L0 cos(phi)
  double tendon = 0.0;  ///< lT/LS
};

/// Fully active; none where the tendon is slack or the fibre far from its optimal length.
std::optional<NormalisedState> rest(const Musculotendon<double>& muscle, const MusculotendonParameters<double>& p,
                                    double path_length) {
  constexpr double kShortest = 0.5, kLongest = 1.5;
  const MuscleEquilibrium<double> found = muscle.equilibrium(1.0, path_length);
  if (found.end != EquilibriumEnd::kFound) return std::nullopt;
  NormalisedState s{.fiber = found.fiber_length / p.optimal_fiber_length};
  if (!(s.fiber >= kShortest && s.fiber <= kLongest)) return std::nullopt;
  const double sine = std::sin(p.pennation_angle_at_optimal) / s.fiber;
  if (!(sine < 1.0)) return std::nullopt;
  s.along = s.fiber * std::sqrt(1.0 - sine * sine);
  s.tendon = (path_length - s.along * p.optimal_fiber_length) / p.tendon_slack_length;
  // A rigid tendon is as long as it is slack.
  if (!(s.tendon >= 1.0 - 1e-9)) return std::nullopt;
  return s;
}

/// Two columns with a smaller sine between them are parallel: L0 and LS cannot be distinguished.
constexpr double kLeastSine = 1e-4;

/// x of min |A x - b| with two columns; none where they are parallel or a length is not positive.
std::optional<Eigen::Vector2d> positive_solution(const Eigen::MatrixX2d& A, const Eigen::VectorXd& b) {
  const double aa = A.col(0).squaredNorm(), ab = A.col(0).dot(A.col(1)), bb = A.col(1).squaredNorm();
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > kLeastSine * kLeastSine * aa * bb)) return std::nullopt;
  const double u = A.col(0).dot(b), v = A.col(1).dot(b);
  const Eigen::Vector2d x((bb * u - ab * v) / determinant, (aa * v - ab * u) / determinant);
  if (!(x.array() > 0.0).all()) return std::nullopt;
  return x;
}

MatchedFiber match(const MuscleParameters& reference, const MuscleParameters& subject,
                   const Eigen::VectorXd& reference_path, const Eigen::VectorXd& subject_path) {
  constexpr std::size_t kFewestPoses = 10;
  const Musculotendon<double> model(reference);
  std::vector<NormalisedState> states;
  std::vector<double> paths;
  for (Eigen::Index p = 0; p < reference_path.size(); ++p) {
    const auto state = rest(model, reference.musculotendon, reference_path(p));
    if (!state || !std::isfinite(subject_path(p))) continue;
    states.push_back(*state);
    paths.push_back(subject_path(p));
  }
  MatchedFiber result{.poses = states.size()};
  if (states.size() < kFewestPoses) {
    result.obstacle =
        fmt::format("the reference's tendon is taut and its fibre between 0.5 and 1.5 L0 at {} of {} poses",
                    states.size(), reference_path.size());
    return result;
  }
  Eigen::MatrixX2d A(states.size(), 2);
  for (std::size_t i = 0; i < states.size(); ++i) {
    // The subject's pennation, at the reference's normalised length.
    const double sine = std::sin(subject.musculotendon.pennation_angle_at_optimal) / states[i].fiber;
    A(i, 0) = sine < 1.0 ? states[i].fiber * std::sqrt(1.0 - sine * sine) : states[i].along;
    A(i, 1) = states[i].tendon;
  }
  const Eigen::Map<const Eigen::VectorXd> b(paths.data(), paths.size());
  const std::optional<Eigen::Vector2d> x = positive_solution(A, b);
  if (!x) {
    result.obstacle = "no positive lengths fit: its path does not change as the reference's does";
    return result;
  }
  result.optimal_fiber_length = (*x)(0);
  result.tendon_slack_length = (*x)(1);
  MuscleParameters fitted = subject;
  fitted.musculotendon.optimal_fiber_length = (*x)(0);
  fitted.musculotendon.tendon_slack_length = (*x)(1);
  const Musculotendon<double> matched(fitted);
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double difference = matched.equilibrium(1.0, paths[i]).fiber_length / (*x)(0) - states[i].fiber;
    sum += difference * difference;
  }
  result.error = std::sqrt(sum / static_cast<double>(states.size()));
  return result;
}

}  // namespace

std::vector<MatchedFiber> match_fiber_lengths(const MusculoskeletalSystem& reference,
                                              const MusculoskeletalSystem& subject, std::size_t poses) {
  const std::vector<SharedCoordinate> shared = shared_coordinates(reference, subject);
  const Eigen::MatrixXd points = numerics::plain_sobol_points(poses, std::max<std::size_t>(shared.size(), 1));
  const Eigen::MatrixXd of_reference = path_lengths(reference, points, shared, &SharedCoordinate::in_reference);
  const Eigen::MatrixXd of_subject = path_lengths(subject, points, shared, &SharedCoordinate::in_subject);
  std::vector<MatchedFiber> result;
  for (std::size_t m = 0; m < subject.muscles().size(); ++m) {
    const std::string& name = subject.model().muscles[m].name();
    const int counterpart = reference.model().muscle(name);
    MatchedFiber fiber;
    if (counterpart < 0) {
      fiber.obstacle = "the reference has no muscle of that name";
    } else {
      fiber = match(reference.muscles().settings(at(counterpart)), subject.muscles().settings(m),
                    of_reference.col(counterpart), of_subject.col(m));
    }
    fiber.muscle = static_cast<int>(m);
    result.push_back(std::move(fiber));
  }
  return result;
}

}  // namespace veridyn::muscle
