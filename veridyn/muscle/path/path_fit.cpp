#include "veridyn/muscle/path/path_fit.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numeric>

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

struct Sampler {
  const Mechanism& mechanism;
  const MusclePaths& exact;
  Kinematics<double> kinematics;
  PathWorkspace<double> workspace;

  void at(const Eigen::VectorXd& q) {
    update_positions(mechanism, q.data(), kinematics);
    exact.evaluate(kinematics, q.data(), workspace);
  }
  [[nodiscard]] double slope(int muscle, int coordinate) const {
    for (std::size_t k = exact.first_pair(muscle); k < exact.end_pair(muscle); ++k)
      if (exact.pairs()[k].coordinate == coordinate) return workspace.gradient[k];
    return 0.0;
  }
};

/// Exponents of all monomials of `n` variables up to total degree `degree`; for n <= 2 in the order of rows.
std::vector<std::array<unsigned char, 8>> exponents(int n, int degree) {
  std::vector<std::array<unsigned char, 8>> found;
  std::array<unsigned char, 8> power{};
  // Counts with the last variable slowest.
  const auto fill = [&](const auto& self, int axis, int left) -> void {
    if (axis < 0) {
      found.push_back(power);
      return;
    }
    for (int i = 0; i <= left; ++i) {
      power[static_cast<std::size_t>(axis)] = static_cast<unsigned char>(i);
      self(self, axis - 1, left - i);
    }
    power[static_cast<std::size_t>(axis)] = 0;
  };
  fill(fill, n - 1, degree);
  return found;
}

double power_of(double x, int n) {
  double v = 1.0;
  for (int i = 0; i < n; ++i) v *= x;
  return v;
}

}  // namespace

FittedPaths::FittedPaths(const Model& model, const Mechanism& mechanism, const MusclePaths& exact,
                         const PathFitOptions& options) {
  Sampler sampler{mechanism, exact, Kinematics<double>(mechanism), PathWorkspace<double>(exact)};
  const int coordinates = exact.coordinates();
  const Eigen::VectorXd rest = model.default_pose();
  std::vector<double> low(static_cast<std::size_t>(coordinates)), high(low.size());
  for (int c = 0; c < coordinates; ++c) {
    const Coordinate& k = model.coordinates[static_cast<std::size_t>(c)];
    const bool range = k.high > k.low && k.high - k.low < 20.0;
    low[static_cast<std::size_t>(c)] = range ? k.low : rest[c] - 0.5;
    high[static_cast<std::size_t>(c)] = range ? k.high : rest[c] + 0.5;
  }
  const auto pose = [&](const std::vector<int>& of, int index) {
    Eigen::VectorXd q = rest;
    for (std::size_t a = 0; a < of.size(); ++a) {
      const auto c = static_cast<std::size_t>(of[a]);
      q[of[a]] = low[c] + (high[c] - low[c]) * halton(index, static_cast<int>(a));
    }
    return q;
  };
  std::vector<int> axis_of(static_cast<std::size_t>(coordinates), -1);
  const auto axis = [&](int c) {
    int& known = axis_of[static_cast<std::size_t>(c)];
    if (known < 0) {
      known = static_cast<int>(axes_.size());
      const double a = low[static_cast<std::size_t>(c)], b = high[static_cast<std::size_t>(c)];
      axes_.push_back({c, 0.5 * (a + b), 2.0 / (b - a)});
    }
    return known;
  };

  // One exact path costs the whole machinery of exact paths: where all straight ones are cheap to fit, none is left.
  constexpr std::size_t kFew = 2;
  bool few = true;
  for (int m = 0; m < exact.muscles(); ++m) {
    few = few && (exact.can_wrap(m) || exact.end_pair(m) - exact.first_pair(m) <= kFew);
  }
  for (int m = 0; m < exact.muscles(); ++m) {
    fitted_.push_back(options.mixed && !few && !exact.can_wrap(m) ? 0 : 1);
    if (fitted_.back() == 0) {
      constant_.push_back(0.0);
      PathFitError none;
      none.muscle = model.muscles[static_cast<std::size_t>(m)].name();
      none.fitted = false;
      errors_.push_back(none);
      continue;
    }
    // Coordinates that matter.
    std::vector<int> candidates, used;
    for (std::size_t k = exact.first_pair(m); k < exact.end_pair(m); ++k)
      candidates.push_back(exact.pairs()[k].coordinate);
    std::vector<double> greatest(candidates.size(), 0.0);
    for (int i = 0; i < 64; ++i) {
      sampler.at(pose(candidates, 1000 + i));
      for (std::size_t a = 0; a < candidates.size(); ++a)
        greatest[a] = std::max(greatest[a], std::abs(sampler.slope(m, candidates[a])));
    }
    for (std::size_t a = 0; a < candidates.size(); ++a)
      if (greatest[a] > 1e-9) used.push_back(candidates[a]);
    if (used.size() > kMostCoordinates) used.resize(kMostCoordinates);

    // Two coordinates belong together where the slope about one changes with the other.
    std::vector<int> group(used.size());
    std::iota(group.begin(), group.end(), 0);
    for (std::size_t a = 0; a < used.size(); ++a) {
      for (std::size_t b = 0; b < used.size(); ++b) {
        if (a == b || group[a] == group[b]) continue;
        double change = 0.0;
        for (int i = 0; i < 24; ++i) {
          Eigen::VectorXd q = pose(used, 2000 + i);
          sampler.at(q);
          const double before = sampler.slope(m, used[a]);
          const auto c = static_cast<std::size_t>(used[b]);
          q[used[b]] = low[c] + (high[c] - low[c]) * halton(i, 5);
          sampler.at(q);
          change = std::max(change, std::abs(sampler.slope(m, used[a]) - before));
        }
        if (change > 1e-7) {
          const int from = group[b], to = group[a];
          for (int& g : group)
            if (g == from) g = to;
        }
      }
    }

    // A sum: L(q) = L(rest) + sum over groups (L(rest but for the group) - L(rest)).
    sampler.at(rest);
    const double at_rest = sampler.workspace.length[static_cast<std::size_t>(m)];
    constant_.push_back(at_rest);
    PathFitError error;
    error.muscle = model.muscles[static_cast<std::size_t>(m)].name();
    error.coordinates = used;
    const std::size_t first_pair = pairs_.size();
    for (const int c : used) pairs_.push_back({m, c});

    for (int g = 0; g < static_cast<int>(used.size()); ++g) {
      std::vector<int> of;
      Part part;
      part.muscle = m;
      for (std::size_t a = 0; a < used.size(); ++a) {
        if (group[a] != g) continue;
        part.axes[of.size()] = axis(used[a]);
        part.pair[of.size()] = first_pair + a;
        of.push_back(used[a]);
      }
      if (of.empty()) continue;
      const int n = static_cast<int>(of.size());
      part.coordinates = n;
      const int most_degree = std::clamp(options.max_degree - (n > 3 ? 6 : (n == 3 ? 3 : 0)), 1, kMostDegree);
      const int most_terms = static_cast<int>(exponents(n, most_degree).size());
      const int fit_poses = std::max(48, 3 * most_terms), all = fit_poses + 200;
      Eigen::MatrixXd x(all, n), slope(all, n);
      Eigen::VectorXd value(all);
      for (int i = 0; i < all; ++i) {
        Eigen::VectorXd q = rest;
        for (int a = 0; a < n; ++a) {
          // Denser towards the ends, as Chebyshev's points, for the fit; even for the check.
          const double u = halton(i + (i < fit_poses ? 0 : 5000), a);
          x(i, a) = i < fit_poses ? -std::cos(3.14159265358979 * u) : 2.0 * u - 1.0;
          const Axis& scaled = axes_[static_cast<std::size_t>(part.axes[a])];
          q[scaled.coordinate] = scaled.middle + x(i, a) / scaled.scale;
        }
        sampler.at(q);
        value[i] = sampler.workspace.length[static_cast<std::size_t>(m)] - at_rest;
        for (int a = 0; a < n; ++a) slope(i, a) = sampler.slope(m, of[static_cast<std::size_t>(a)]);
      }
      Eigen::VectorXd best;
      std::vector<std::array<unsigned char, 8>> best_powers;
      double best_error = 1e300;
      int best_degree = 1;
      for (int degree = 1; degree <= most_degree; ++degree) {
        const auto powers = exponents(n, degree);
        const auto terms = static_cast<Eigen::Index>(powers.size());
        Eigen::MatrixXd all_rows((n + 1) * all, terms);
        Eigen::VectorXd all_values((n + 1) * all);
        for (int i = 0; i < all; ++i) {
          for (Eigen::Index t = 0; t < terms; ++t) {
            const auto& p = powers[static_cast<std::size_t>(t)];
            double product = 1.0;
            for (int a = 0; a < n; ++a) product *= power_of(x(i, a), p[static_cast<std::size_t>(a)]);
            all_rows(i * (n + 1), t) = product;
            for (int a = 0; a < n; ++a) {
              double d = p[static_cast<std::size_t>(a)] * axes_[static_cast<std::size_t>(part.axes[a])].scale;
              for (int b = 0; b < n && d != 0.0; ++b)
                d *= power_of(x(i, b), p[static_cast<std::size_t>(b)] - (a == b ? 1 : 0));
              all_rows(i * (n + 1) + 1 + a, t) = d;
            }
          }
          all_values[i * (n + 1)] = value[i];
          for (int a = 0; a < n; ++a) all_values[i * (n + 1) + 1 + a] = slope(i, a);
        }
        const Eigen::Index fitted = (n + 1) * fit_poses;
        const Eigen::VectorXd coefficient = all_rows.topRows(fitted).householderQr().solve(all_values.head(fitted));
        const double worst =
            (all_rows.bottomRows((n + 1) * 200) * coefficient - all_values.tail((n + 1) * 200)).cwiseAbs().maxCoeff();
        if (worst < best_error) {
          best_error = worst;
          best = coefficient;
          best_powers = powers;
          best_degree = degree;
        }
        if (worst < 0.5 * options.tolerance) break;
      }
      if (n == 1 && best_error > 0.5 * options.tolerance) {
        part.degree = -1;
        part.first = pieces_.size();
        const Axis scaled = axes_[static_cast<std::size_t>(part.axes[0])];
        std::vector<double> l, d;
        for (int i = 0; i <= options.panels; ++i) {
          Eigen::VectorXd q = rest;
          q[scaled.coordinate] = scaled.middle + (2.0 * i / options.panels - 1.0) / scaled.scale;
          sampler.at(q);
          l.push_back(sampler.workspace.length[static_cast<std::size_t>(m)] - at_rest);
          d.push_back(sampler.slope(m, of[0]) * 2.0 / (options.panels * scaled.scale));
        }
        for (std::size_t i = 0; i + 1 < l.size(); ++i) {
          const double rise = l[i + 1] - l[i];
          pieces_.insert(pieces_.end(), {l[i], d[i], 3.0 * rise - 2.0 * d[i] - d[i + 1], d[i] + d[i + 1] - 2.0 * rise});
        }
        part.end = pieces_.size();
      } else {
        part.degree = best_degree;
        if (n <= 2) {
          part.first = rows_.size();
          rows_.insert(rows_.end(), best.data(), best.data() + best.size());
          part.end = rows_.size();
        } else {
          part.first = terms_.size();
          for (Eigen::Index t = 0; t < best.size(); ++t) {
            Term term;
            term.factor = best[t];
            std::copy_n(best_powers[static_cast<std::size_t>(t)].begin(), kMostCoordinates, term.power);
            terms_.push_back(term);
          }
          part.end = terms_.size();
        }
      }
      error.terms += static_cast<int>(part.end - part.first);
      parts_.push_back(part);
    }
    errors_.push_back(error);
  }

  // Errors of the whole, on poses of its own.
  std::vector<double> length(static_cast<std::size_t>(muscles())), gradient(pairs_.size());
  std::vector<int> all_coordinates;
  for (const Axis& a : axes_) all_coordinates.push_back(a.coordinate);
  std::vector<int> above(errors_.size(), 0);
  for (int i = 0; i < options.check_poses; ++i) {
    const Eigen::VectorXd q = pose(all_coordinates, 20000 + i);
    sampler.at(q);
    evaluate(q.data(), length.data(), gradient.data());
    std::vector<double> worst(errors_.size(), 0.0);
    for (std::size_t m = 0; m < errors_.size(); ++m)
      if (fitted_[m] != 0)
        errors_[m].length = std::max(errors_[m].length, std::abs(length[m] - sampler.workspace.length[m]));
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto m = static_cast<std::size_t>(pairs_[k].muscle);
      worst[m] = std::max(worst[m], std::abs(gradient[k] - sampler.slope(pairs_[k].muscle, pairs_[k].coordinate)));
    }
    for (std::size_t m = 0; m < worst.size(); ++m) {
      errors_[m].moment_arm = std::max(errors_[m].moment_arm, worst[m]);
      if (worst[m] > options.tolerance) ++above[m];
    }
  }
  for (std::size_t m = 0; m < above.size(); ++m)
    errors_[m].above_tolerance = static_cast<double>(above[m]) / options.check_poses;
  if (!options.mixed) return;
  for (std::size_t m = 0; m < errors_.size(); ++m) {
    if (fitted_[m] == 0) continue;
    errors_[m].fitted = errors_[m].length <= options.tolerance && errors_[m].above_tolerance <= options.most_above;
    fitted_[m] = errors_[m].fitted ? 1 : 0;
  }
  keep_exact(exact);
}

void FittedPaths::keep_exact(const MusclePaths& exact) {
  std::erase_if(parts_, [&](const Part& part) { return fitted_[static_cast<std::size_t>(part.muscle)] == 0; });
  std::vector<MusclePaths::Pair> pairs;
  std::vector<std::size_t> place(pairs_.size());
  std::size_t k = 0;
  for (int m = 0; m < muscles(); ++m) {
    const bool is_fitted = fitted_[static_cast<std::size_t>(m)] != 0;
    for (; k < pairs_.size() && pairs_[k].muscle == m; ++k) {
      place[k] = pairs.size();
      if (is_fitted) pairs.push_back(pairs_[k]);
    }
    if (is_fitted) continue;
    constant_[static_cast<std::size_t>(m)] = 0.0;
    exact_.push_back(m);
    for (std::size_t from = exact.first_pair(m); from < exact.end_pair(m); ++from) {
      exact_pairs_.push_back({from, pairs.size()});
      pairs.push_back(exact.pairs()[from]);
    }
  }
  pairs_ = pairs;
  std::vector<Axis> axes;
  std::vector<int> axis_place(axes_.size(), -1);
  for (Part& part : parts_) {
    for (int a = 0; a < part.coordinates; ++a) {
      part.pair[a] = place[part.pair[a]];
      int& now = axis_place[static_cast<std::size_t>(part.axes[a])];
      if (now < 0) {
        now = static_cast<int>(axes.size());
        axes.push_back(axes_[static_cast<std::size_t>(part.axes[a])]);
      }
      part.axes[a] = now;
    }
  }
  axes_ = axes;
}

}  // namespace veridyn::muscle
