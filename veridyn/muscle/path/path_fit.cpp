#include "veridyn/muscle/path/path_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/multivariate_polynomial.hpp"

namespace veridyn::muscle {
namespace {

/// Halton's sequence: point `index` of dimension `axis`, in 0..1.
double halton(int index, int axis) {
  constexpr std::array<int, 12> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  const int base = kPrimes[static_cast<std::size_t>(axis) % kPrimes.size()];
  double fraction = 1.0, value = 0.0;
  for (int i = index + 1; i > 0; i /= base) {
    fraction /= base;
    value += fraction * (i % base);
  }
  return value;
}

double power_of(double x, int n) {
  double v = 1.0;
  for (int i = 0; i < n; ++i) v *= x;
  return v;
}

}  // namespace

/// View of a model, its mechanism and its exact paths, which must outlive it: makes `FittedPaths` of them.
class FittedPaths::Builder {
 public:
  Builder(const Model& model, const Mechanism& mechanism, const MusclePaths& exact, const PathFitOptions& options);

  [[nodiscard]] FittedPaths build();

 private:
  /// Lengths (less that at rest) and slopes of one part: the poses of the fit, then those of its check.
  struct Samples {
    Eigen::MatrixXd x, slope;  ///< poses x coordinates of the part; x scaled to -1..1
    Eigen::VectorXd value;
    Eigen::Index fitted = 0;
    Eigen::Index all = 0;
  };
  using Powers = std::vector<numerics::MultivariatePolynomial::Powers>;
  struct Polynomial {
    Eigen::VectorXd coefficient;
    double error = 1e300;
    int degree = 1;
  };

  void choose_muscles();
  void fit(int muscle);
  void take_over(int muscle);
  /// Errors of the whole, on check poses that no part of the fit used.
  void check();
  /// Leaves exact what was fitted badly.
  void drop_misfits();

  /// Exact paths at a pose, into `workspace_`: of one muscle, or of all.
  void evaluate_exact(const Eigen::VectorXd& q, int muscle = -1);
  /// dL/dq at the pose of the last `evaluate_exact`.
  [[nodiscard]] double exact_slope(int muscle, int coordinate) const;
  [[nodiscard]] Eigen::VectorXd pose(const std::vector<int>& of, int index) const;
  [[nodiscard]] int axis(int coordinate);
  [[nodiscard]] std::vector<int> coordinates_that_matter(int muscle);
  [[nodiscard]] std::vector<int> groups(int muscle, const std::vector<int>& used);
  [[nodiscard]] int most_degree(int coordinates) const;
  [[nodiscard]] Samples sample(const Part& part, const std::vector<int>& of, double at_rest);
  [[nodiscard]] Polynomial fit_polynomial(const Part& part, const Samples& samples) const;
  /// Misfit of the best polynomial with `powers` on the poses of the check; its coefficients.
  [[nodiscard]] double fit_powers(const Part& part, const Samples& samples, const Powers& powers,
                                  Eigen::VectorXd& coefficient) const;
  void fit_part(Part& part, const std::vector<int>& of, double at_rest);
  /// Length (less that at rest) and slope of a part of one coordinate at a value of it.
  struct AtPose {
    double at = 0.0, length = 0.0, slope = 0.0;
  };
  [[nodiscard]] AtPose along(const Part& part, int coordinate, double value, double at_rest);
  [[nodiscard]] static std::array<double, 4> cubic(const AtPose& first, const AtPose& last);
  void store_pieces(Part& part, int coordinate, double at_rest);
  void store(Part& part, const Polynomial& polynomial);
  void keep_exact();

  /// Of a part; of one coordinate fewer tell whether a polynomial follows, and pieces check themselves.
  [[nodiscard]] static int check_poses(int coordinates) { return coordinates == 1 ? 40 : 200; }

  const Model& model_;
  const Mechanism& mechanism_;
  const MusclePaths& exact_;
  PathFitOptions options_;
  FittedPaths result_;
  Kinematics<double> kinematics_;
  PathWorkspace<double> workspace_;
  Eigen::VectorXd rest_;
  std::vector<double> low_, high_;
  std::vector<int> axis_of_;
  std::vector<std::uint8_t> skip_;  ///< all but one muscle
};

FittedPaths::Builder::Builder(const Model& model, const Mechanism& mechanism, const MusclePaths& exact,
                              const PathFitOptions& options)
    : model_(model),
      mechanism_(mechanism),
      exact_(exact),
      options_(options),
      kinematics_(mechanism),
      workspace_(exact),
      rest_(model.default_pose()),
      low_(static_cast<std::size_t>(exact.coordinates())),
      high_(low_.size()),
      axis_of_(low_.size(), -1),
      skip_(static_cast<std::size_t>(exact.muscles()), 1) {
  for (int c = 0; c < exact.coordinates(); ++c) {
    const Coordinate& k = model.coordinates[c];
    const bool range = k.high > k.low && k.high - k.low < 20.0;
    low_[c] = range ? k.low : rest_[c] - 0.5;
    high_[c] = range ? k.high : rest_[c] + 0.5;
  }
}

FittedPaths FittedPaths::Builder::build() {
  choose_muscles();
  for (int m = 0; m < exact_.muscles(); ++m) fit(m);
  check();
  if (options_.mixed) drop_misfits();
  return std::move(result_);
}

void FittedPaths::Builder::evaluate_exact(const Eigen::VectorXd& q, int muscle) {
  update_positions(mechanism_, q.data(), kinematics_);
  if (muscle < 0) return exact_.evaluate(kinematics_, q.data(), workspace_);
  skip_[muscle] = 0;
  exact_.evaluate(kinematics_, q.data(), workspace_, skip_);
  skip_[muscle] = 1;
}

double FittedPaths::Builder::exact_slope(int muscle, int coordinate) const {
  for (std::size_t k = exact_.first_pair(muscle); k < exact_.end_pair(muscle); ++k)
    if (exact_.pairs()[k].coordinate == coordinate) return workspace_.gradient[k];
  return 0.0;
}

Eigen::VectorXd FittedPaths::Builder::pose(const std::vector<int>& of, int index) const {
  Eigen::VectorXd q = rest_;
  for (std::size_t a = 0; a < of.size(); ++a) {
    const auto c = static_cast<std::size_t>(of[a]);
    q[of[a]] = low_[c] + (high_[c] - low_[c]) * halton(index, static_cast<int>(a));
  }
  return q;
}

int FittedPaths::Builder::axis(int coordinate) {
  if (axis_of_[coordinate] < 0) {
    axis_of_[coordinate] = static_cast<int>(result_.axes_.size());
    const double a = low_[coordinate], b = high_[coordinate];
    result_.axes_.push_back({coordinate, 0.5 * (a + b), 2.0 / (b - a)});
  }
  return axis_of_[coordinate];
}

/// A single exact path needs all that exact paths need (kinematics, points): where all straight ones are cheap to fit,
/// none stays exact.
void FittedPaths::Builder::choose_muscles() {
  constexpr std::size_t kCheapCoordinates = 2;
  bool all_cheap = true;
  for (int m = 0; m < exact_.muscles(); ++m)
    all_cheap = all_cheap && (exact_.can_wrap(m) || exact_.by_function(m) ||
                              exact_.end_pair(m) - exact_.first_pair(m) <= kCheapCoordinates);
  for (int m = 0; m < exact_.muscles(); ++m) {
    const bool given = exact_.by_function(m);
    result_.fitted_.push_back(options_.mixed && !all_cheap && !exact_.can_wrap(m) && !given ? 0 : 1);
    PathFitError error;
    error.muscle = model_.muscles[m].name();
    error.given = given;
    error.fitted = result_.fitted_.back() != 0;
    result_.errors_.push_back(error);
    result_.constant_.push_back(0.0);
  }
}

std::vector<int> FittedPaths::Builder::coordinates_that_matter(int muscle) {
  std::vector<int> candidates, used;
  for (std::size_t k = exact_.first_pair(muscle); k < exact_.end_pair(muscle); ++k)
    candidates.push_back(exact_.pairs()[k].coordinate);
  std::vector<double> greatest(candidates.size(), 0.0);
  for (int i = 0; i < 64; ++i) {
    evaluate_exact(pose(candidates, 1000 + i), muscle);
    for (std::size_t a = 0; a < candidates.size(); ++a)
      greatest[a] = std::max(greatest[a], std::abs(exact_slope(muscle, candidates[a])));
  }
  for (std::size_t a = 0; a < candidates.size(); ++a)
    if (greatest[a] > 1e-9) used.push_back(candidates[a]);
  if (used.size() > kMostCoordinates) used.resize(kMostCoordinates);
  return used;
}

/// Two coordinates belong together where the slope about one changes with the other.
std::vector<int> FittedPaths::Builder::groups(int muscle, const std::vector<int>& used) {
  std::vector<int> group(used.size());
  std::iota(group.begin(), group.end(), 0);
  for (std::size_t a = 0; a < used.size(); ++a) {
    for (std::size_t b = 0; b < used.size(); ++b) {
      if (a == b || group[a] == group[b]) continue;
      double change = 0.0;
      for (int i = 0; i < 24; ++i) {
        Eigen::VectorXd q = pose(used, 2000 + i);
        evaluate_exact(q, muscle);
        const double before = exact_slope(muscle, used[a]);
        const auto c = static_cast<std::size_t>(used[b]);
        q[used[b]] = low_[c] + (high_[c] - low_[c]) * halton(i, 5);
        evaluate_exact(q, muscle);
        change = std::max(change, std::abs(exact_slope(muscle, used[a]) - before));
      }
      if (change > 1e-7) {
        const int from = group[b], to = group[a];
        for (int& g : group)
          if (g == from) g = to;
      }
    }
  }
  return group;
}

/// The function that the model gives.
void FittedPaths::Builder::take_over(int muscle) {
  PathFitError& error = result_.errors_[muscle];
  error.coordinates = result_.functions_.add(model_, muscle, result_.pairs_.size());
  error.terms = result_.functions_.terms(muscle);
  for (const int c : error.coordinates) result_.pairs_.push_back({muscle, c});
}

/// A sum: L(q) = L(rest) + sum over groups (L(rest but for the group) - L(rest)).
void FittedPaths::Builder::fit(int muscle) {
  const auto m = static_cast<std::size_t>(muscle);
  if (result_.fitted_[m] == 0) return;
  if (exact_.by_function(muscle)) return take_over(muscle);
  const std::vector<int> used = coordinates_that_matter(muscle);
  const std::vector<int> group = groups(muscle, used);
  evaluate_exact(rest_, muscle);
  const double at_rest = workspace_.length[m];
  result_.constant_[m] = at_rest;
  result_.errors_[m].coordinates = used;
  const std::size_t first_pair = result_.pairs_.size();
  for (const int c : used) result_.pairs_.push_back({muscle, c});
  for (int g = 0; g < static_cast<int>(used.size()); ++g) {
    std::vector<int> of;
    Part part;
    part.muscle = muscle;
    for (std::size_t a = 0; a < used.size(); ++a) {
      if (group[a] != g) continue;
      part.axes[of.size()] = axis(used[a]);
      part.pair[of.size()] = first_pair + a;
      of.push_back(used[a]);
    }
    if (of.empty()) continue;
    part.coordinates = static_cast<int>(of.size());
    fit_part(part, of, at_rest);
    if (!part.in_pieces()) result_.errors_[m].terms += static_cast<int>(part.polynomial.coefficients().size());
    result_.parts_.push_back(part);
  }
}

int FittedPaths::Builder::most_degree(int n) const {
  return std::clamp(options_.max_degree - (n > 3 ? 6 : (n == 3 ? 3 : 0)), 1,
                    numerics::MultivariatePolynomial::kMostOrder);
}

FittedPaths::Builder::Samples FittedPaths::Builder::sample(const Part& part, const std::vector<int>& of,
                                                           double at_rest) {
  const int n = part.coordinates;
  const int most_terms = static_cast<int>(numerics::MultivariatePolynomial::terms(n, most_degree(n)));
  const int fit_poses = std::max(48, 3 * most_terms), all = fit_poses + check_poses(n);
  Samples s{Eigen::MatrixXd(all, n), Eigen::MatrixXd(all, n), Eigen::VectorXd(all), fit_poses, all};
  for (int i = 0; i < all; ++i) {
    Eigen::VectorXd q = rest_;
    for (int a = 0; a < n; ++a) {
      // Of the fit denser towards the ends, as Chebyshev's points; of the check evenly spread.
      const double u = halton(i + (i < fit_poses ? 0 : 5000), a);
      s.x(i, a) = i < fit_poses ? -std::cos(kPi * u) : 2.0 * u - 1.0;
      const Axis& scaled = result_.axes_[part.axes[a]];
      q[scaled.coordinate] = scaled.middle + s.x(i, a) / scaled.scale;
    }
    evaluate_exact(q, part.muscle);
    s.value[i] = workspace_.length[part.muscle] - at_rest;
    for (int a = 0; a < n; ++a) s.slope(i, a) = exact_slope(part.muscle, of[a]);
  }
  return s;
}

double FittedPaths::Builder::fit_powers(const Part& part, const Samples& s, const Powers& powers,
                                        Eigen::VectorXd& coefficient) const {
  const int n = part.coordinates;
  const auto terms = signed_index(powers.size());
  Eigen::MatrixXd rows((n + 1) * s.all, terms);
  Eigen::VectorXd values((n + 1) * s.all);
  for (Eigen::Index i = 0; i < s.all; ++i) {
    for (Eigen::Index t = 0; t < terms; ++t) {
      // The first coordinate is the polynomial's last argument.
      const auto p = [&](int a) { return static_cast<int>(powers[t][n - 1 - a]); };
      double product = 1.0;
      for (int a = 0; a < n; ++a) product *= power_of(s.x(i, a), p(a));
      rows(i * (n + 1), t) = product;
      for (int a = 0; a < n; ++a) {
        double d = p(a) * result_.axes_[part.axes[a]].scale;
        for (int b = 0; b < n && d != 0.0; ++b) d *= power_of(s.x(i, b), p(b) - (a == b ? 1 : 0));
        rows(i * (n + 1) + 1 + a, t) = d;
      }
    }
    values[i * (n + 1)] = s.value[i];
    for (int a = 0; a < n; ++a) values[i * (n + 1) + 1 + a] = s.slope(i, a);
  }
  const Eigen::Index fitted = (n + 1) * s.fitted, checked = (n + 1) * check_poses(n);
  coefficient = numerics::HouseholderQr(rows.topRows(fitted)).solve(Eigen::VectorXd(values.head(fitted)));
  return (rows.bottomRows(checked) * coefficient - values.tail(checked)).cwiseAbs().maxCoeff();
}

/// Of the least degree that meets half the tolerance, or the best of all.
FittedPaths::Builder::Polynomial FittedPaths::Builder::fit_polynomial(const Part& part, const Samples& samples) const {
  Polynomial best;
  for (int degree = 1; degree <= most_degree(part.coordinates); ++degree) {
    const Powers powers = numerics::MultivariatePolynomial::powers(part.coordinates, degree);
    Eigen::VectorXd coefficient;
    const double worst = fit_powers(part, samples, powers, coefficient);
    if (worst < best.error) best = {coefficient, worst, degree};
    if (worst < 0.5 * options_.tolerance) break;
  }
  return best;
}

void FittedPaths::Builder::fit_part(Part& part, const std::vector<int>& of, double at_rest) {
  const Polynomial best = fit_polynomial(part, sample(part, of, at_rest));
  if (part.coordinates == 1 && best.error > 0.5 * options_.tolerance) {
    store_pieces(part, of[0], at_rest);
  } else {
    store(part, best);
  }
}

FittedPaths::Builder::AtPose FittedPaths::Builder::along(const Part& part, int coordinate, double value,
                                                         double at_rest) {
  Eigen::VectorXd q = rest_;
  q[coordinate] = value;
  evaluate_exact(q, part.muscle);
  return {value, workspace_.length[part.muscle] - at_rest, exact_slope(part.muscle, coordinate)};
}

/// The cubic through lengths and slopes at both ends of a piece, of the distance from its first.
std::array<double, 4> FittedPaths::Builder::cubic(const AtPose& first, const AtPose& last) {
  const double h = last.at - first.at, mean = (last.length - first.length) / h;
  return {first.length, first.slope, (3.0 * mean - 2.0 * first.slope - last.slope) / h,
          (first.slope + last.slope - 2.0 * mean) / (h * h)};
}

/// Cubics through lengths and slopes at their ends, each halved until it meets a part of the tolerance a quarter from
/// both ends and in the middle: a small one, since the slopes' own slopes, which estimation needs, jump from cubic to
/// cubic. What is still off when a piece is narrower than a millionth of the range jumps: such a piece goes on straight
/// from its first end, so that arms are those of both sides and none is that of the jump.
void FittedPaths::Builder::store_pieces(Part& part, int coordinate, double at_rest) {
  constexpr int kFirstPieces = 32;
  constexpr double kPart = 0.02;
  constexpr std::size_t kMostPieces = 4096;
  const Axis scaled = result_.axes_[part.axes[0]];
  const double low = scaled.middle - 1.0 / scaled.scale, range = 2.0 / scaled.scale;
  std::vector<double> breaks;
  std::vector<std::array<double, 4>> coefficients;
  const auto split = [&](const auto& self, const AtPose& first, const AtPose& middle, const AtPose& last) -> void {
    const double h = last.at - first.at;
    std::array<double, 4> c = cubic(first, last);
    const auto off = [&](const AtPose& exact) {
      const double s = exact.at - first.at;
      const double length = ((c[3] * s + c[2]) * s + c[1]) * s + c[0], slope = (3.0 * c[3] * s + 2.0 * c[2]) * s + c[1];
      return std::max(std::abs(length - exact.length), std::abs(slope - exact.slope)) > kPart * options_.tolerance;
    };
    const AtPose before = along(part, coordinate, first.at + 0.25 * h, at_rest),
                 after = along(part, coordinate, first.at + 0.75 * h, at_rest);
    if (off(before) || off(middle) || off(after)) {
      if (h > 1e-6 * range && breaks.size() < kMostPieces) {
        self(self, first, before, middle);
        self(self, middle, after, last);
        return;
      }
      c = {first.length, first.slope, 0.0, 0.0};
    }
    breaks.push_back(first.at);
    coefficients.push_back(c);
  };
  AtPose first = along(part, coordinate, low, at_rest);
  for (int i = 0; i < kFirstPieces; ++i) {
    const AtPose middle = along(part, coordinate, low + range * (i + 0.5) / kFirstPieces, at_rest),
                 last = along(part, coordinate, low + range * (i + 1.0) / kFirstPieces, at_rest);
    split(split, first, middle, last);
    first = last;
  }
  part.first = result_.pieces_.size();
  result_.errors_[part.muscle].terms += 4 * static_cast<int>(breaks.size());
  result_.pieces_.push_back(numerics::PiecewisePolynomial::continued_pieces(breaks, coefficients, low + range));
}

void FittedPaths::Builder::store(Part& part, const Polynomial& polynomial) {
  const Eigen::VectorXd& c = polynomial.coefficient;
  part.polynomial = {part.coordinates, polynomial.degree, {c.data(), c.data() + c.size()}};
  std::reverse(part.axes, part.axes + part.coordinates);
  std::reverse(part.pair, part.pair + part.coordinates);
}

void FittedPaths::Builder::check() {
  std::vector<PathFitError>& errors = result_.errors_;
  const std::vector<MusclePaths::Pair>& pairs = result_.pairs_;
  std::vector<double> length(errors.size()), gradient(pairs.size());
  std::vector<int> all_coordinates;
  for (const Axis& a : result_.axes_) all_coordinates.push_back(a.coordinate);
  std::vector<int> above(errors.size(), 0);
  for (int i = 0; i < options_.check_poses; ++i) {
    const Eigen::VectorXd q = pose(all_coordinates, 20000 + i);
    evaluate_exact(q);
    result_.evaluate(q.data(), length.data(), gradient.data());
    std::vector<double> worst(errors.size(), 0.0);
    for (std::size_t m = 0; m < errors.size(); ++m)
      if (result_.fitted_[m] != 0)
        errors[m].length = std::max(errors[m].length, std::abs(length[m] - workspace_.length[m]));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto m = static_cast<std::size_t>(pairs[k].muscle);
      worst[m] = std::max(worst[m], std::abs(gradient[k] - exact_slope(pairs[k].muscle, pairs[k].coordinate)));
    }
    for (std::size_t m = 0; m < worst.size(); ++m) {
      errors[m].moment_arm = std::max(errors[m].moment_arm, worst[m]);
      if (worst[m] > options_.tolerance) ++above[m];
    }
  }
  for (std::size_t m = 0; m < above.size(); ++m)
    errors[m].above_tolerance = static_cast<double>(above[m]) / options_.check_poses;
}

void FittedPaths::Builder::drop_misfits() {
  for (std::size_t m = 0; m < result_.errors_.size(); ++m) {
    if (result_.fitted_[m] == 0) continue;
    PathFitError& error = result_.errors_[m];
    error.fitted = error.length <= options_.tolerance && error.above_tolerance <= options_.most_above &&
                   error.moment_arm <= options_.largest;
    result_.fitted_[m] = error.fitted ? 1 : 0;
  }
  keep_exact();
}

void FittedPaths::Builder::keep_exact() {
  std::erase_if(result_.parts_, [&](const Part& part) { return result_.fitted_[part.muscle] == 0; });
  std::vector<MusclePaths::Pair> pairs;
  std::vector<std::size_t> place(result_.pairs_.size());
  std::size_t k = 0;
  for (int m = 0; m < result_.muscles(); ++m) {
    const bool is_fitted = result_.fitted_[m] != 0;
    for (; k < result_.pairs_.size() && result_.pairs_[k].muscle == m; ++k) {
      place[k] = pairs.size();
      if (is_fitted) pairs.push_back(result_.pairs_[k]);
    }
    if (is_fitted) continue;
    result_.constant_[m] = 0.0;
    result_.exact_.push_back(m);
    for (std::size_t from = exact_.first_pair(m); from < exact_.end_pair(m); ++from) {
      result_.exact_pairs_.push_back({from, pairs.size()});
      pairs.push_back(exact_.pairs()[from]);
    }
  }
  result_.pairs_ = pairs;
  result_.functions_.move_pairs(place);
  std::vector<Axis> axes;
  std::vector<int> axis_place(result_.axes_.size(), -1);
  for (Part& part : result_.parts_) {
    for (int a = 0; a < part.coordinates; ++a) {
      part.pair[a] = place[part.pair[a]];
      int& now = axis_place[part.axes[a]];
      if (now < 0) {
        now = static_cast<int>(axes.size());
        axes.push_back(result_.axes_[part.axes[a]]);
      }
      part.axes[a] = now;
    }
  }
  result_.axes_ = axes;
}

FittedPaths::FittedPaths(const Model& model, const Mechanism& mechanism, const MusclePaths& exact,
                         const PathFitOptions& options)
    : FittedPaths(Builder(model, mechanism, exact, options).build()) {}

}  // namespace veridyn::muscle
