#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"

namespace veridyn::muscle {

struct PathFitOptions {
  double tolerance = 1.0e-4;  ///< wanted of lengths [m] and moment arms [m/rad or 1], on the check poses
  int max_degree = 12;        ///< total degree of a polynomial; three less with three coordinates, six less with more
  int panels = 256;       ///< of a one-coordinate part that no polynomial up to `max_degree` meets the tolerance for
  int check_poses = 600;  ///< independent of those of the fit
  /// Leave exact what is better so: paths without wraps, which cost less than polynomials of many coordinates (unless
  /// all of them depend on two at most), and those whose fit misses the tolerance: in a length, or in moment arms at
  /// more than `most_above` of the check poses. To be evaluated with kinematics.
  bool mixed = false;
  double most_above = 0.05;
};

/// How well one muscle's path is fitted, on poses that the fit did not use.
struct PathFitError {
  std::string muscle;
  bool fitted = true;            ///< false: left exact; the figures are those of the fit that was not good enough, or 0
  std::vector<int> coordinates;  ///< that its length depends on
  int terms = 0;                 ///< coefficients
  double length = 0.0;           ///< largest difference [m]
  double moment_arm = 0.0;       ///< largest difference [m/rad or 1]
  /// Part of the check poses whose moment arms are off by more than the tolerance: at kinks (conditional points, a wrap
  /// that begins or changes sides) dL/dq jumps, and no smooth function follows.
  double above_tolerance = 0.0;
};

/// Paths as polynomials of the coordinates: what a simulation uses where exact wrapping costs too much (the idea is
/// common: van den Bogert et al. 2013; Meyer et al. 2017).
///
/// A path's length is first parted into sums of functions of fewer coordinates where it is such a sum (the shoulder and
/// the elbow part of a biceps). Each part becomes a total-degree polynomial in coordinates scaled to -1..1, of the
/// least degree that meets the tolerance, by least squares on lengths and moment arms at Halton points of the
/// coordinates' ranges; a part of one coordinate that would need more becomes a chain of cubic pieces through lengths
/// and moment arms at their ends. Moment arms are the exact derivatives of the fitted lengths.
class FittedPaths {
 public:
  /// Fits over the ranges of the model's coordinates, the others at their defaults. Coordinates are taken as
  /// independent, coupled ones too.
  FittedPaths(const Model& model, const Mechanism& mechanism, const MusclePaths& exact,
              const PathFitOptions& options = {});

  [[nodiscard]] int muscles() const { return static_cast<int>(constant_.size()); }
  /// All (muscle, coordinate) pairs of `gradient`, muscle after muscle.
  [[nodiscard]] std::span<const MusclePaths::Pair> pairs() const { return pairs_; }
  [[nodiscard]] const std::vector<PathFitError>& errors() const { return errors_; }

  /// Lengths [m] by muscle and dL/dq by pair; zero for those that are left exact. False if a coordinate that matters
  /// lies outside its range: polynomials are then extrapolated, pieces go on straight. Does not allocate or throw.
  template <typename Scalar>
  bool evaluate(const Scalar* q, Scalar* length, Scalar* gradient) const;
  /// The same with the exact ones too, from the paths that the fit was made of.
  template <typename Scalar>
  bool evaluate(const MusclePaths& exact, const Kinematics<Scalar>& kinematics, const Scalar* q,
                PathWorkspace<Scalar>& workspace, Scalar* length, Scalar* gradient) const;

 private:
  void keep_exact(const MusclePaths& exact);

  static constexpr int kMostCoordinates = 8;
  static constexpr int kMostDegree = 15;

  struct Axis {  // x = (q - middle) * scale
    int coordinate = 0;
    double middle = 0.0;
    double scale = 1.0;
  };
  struct Term {
    double factor = 0.0;
    unsigned char power[kMostCoordinates] = {};
  };
  struct Part {
    int muscle = 0;
    int axes[kMostCoordinates] = {};
    std::size_t pair[kMostCoordinates] = {};
    int coordinates = 0;
    int degree = 0;         ///< -1: cubic pieces
    std::size_t first = 0;  ///< in terms_, rows_ or pieces_
    std::size_t end = 0;
  };

  template <typename Scalar>
  [[nodiscard]] static double value_of_scalar(const Scalar& x) {
    return value_of(x);
  }

  std::vector<Axis> axes_;
  std::vector<double> constant_;
  std::vector<MusclePaths::Pair> pairs_;
  std::vector<Part> parts_;
  std::vector<Term> terms_;     ///< of parts with three coordinates and more
  std::vector<double> rows_;    ///< of parts with one or two: by power of the second, then of the first, ascending
  std::vector<double> pieces_;  ///< four coefficients a piece, of t = 0..1
  std::vector<PathFitError> errors_;
  std::vector<std::uint8_t> fitted_;                     ///< by muscle
  std::vector<int> exact_;                               ///< the other muscles
  std::vector<std::array<std::size_t, 2>> exact_pairs_;  ///< their pairs: of the exact paths, here
};

template <typename Scalar>
bool FittedPaths::evaluate(const MusclePaths& exact, const Kinematics<Scalar>& kinematics, const Scalar* q,
                           PathWorkspace<Scalar>& workspace, Scalar* length, Scalar* gradient) const {
  const bool inside = evaluate(q, length, gradient);
  if (exact_.empty()) return inside;
  exact.evaluate(kinematics, q, workspace, std::span<const std::uint8_t>(fitted_));
  for (const int m : exact_) length[m] = workspace.length[static_cast<std::size_t>(m)];
  for (const auto& [from, to] : exact_pairs_) gradient[to] = workspace.gradient[from];
  return inside;
}

template <typename Scalar>
bool FittedPaths::evaluate(const Scalar* q, Scalar* length, Scalar* gradient) const {
  bool inside = true;
  for (std::size_t m = 0; m < constant_.size(); ++m) length[m] = Scalar(constant_[m]);
  for (std::size_t k = 0; k < pairs_.size(); ++k) gradient[k] = Scalar(0.0);
  for (const Axis& axis : axes_) {
    const double x = (value_of(q[axis.coordinate]) - axis.middle) * axis.scale;
    inside = inside && x >= -1.0 - 1e-9 && x <= 1.0 + 1e-9;
  }
  for (const Part& part : parts_) {
    Scalar& total = length[part.muscle];
    const Axis& first_axis = axes_[static_cast<std::size_t>(part.axes[0])];
    const Scalar x = (q[first_axis.coordinate] - Scalar(first_axis.middle)) * Scalar(first_axis.scale);
    if (part.degree < 0) {
      const auto n = (part.end - part.first) / 4;
      const double at = (value_of(x) + 1.0) * 0.5 * static_cast<double>(n);
      const double clamped = std::clamp(at, 0.0, static_cast<double>(n) - 1e-9);
      const auto piece = static_cast<std::size_t>(clamped);
      const Scalar t = (x + Scalar(1.0)) * Scalar(0.5 * static_cast<double>(n)) - Scalar(static_cast<double>(piece));
      const double* c = pieces_.data() + part.first + 4 * piece;
      // Straight beyond the range.
      const double edge = value_of(t) < 0.0 ? 0.0 : 1.0;
      if (value_of(t) < 0.0 || value_of(t) > 1.0) {
        const double slope = c[1] + edge * (2.0 * c[2] + 3.0 * c[3]);
        total += Scalar(c[0] + edge * (c[1] + c[2] + c[3])) + (t - Scalar(edge)) * Scalar(slope);
        gradient[part.pair[0]] += Scalar(slope * 0.5 * static_cast<double>(n) * first_axis.scale);
      } else {
        total += ((Scalar(c[3]) * t + Scalar(c[2])) * t + Scalar(c[1])) * t + Scalar(c[0]);
        gradient[part.pair[0]] += ((Scalar(3.0 * c[3]) * t + Scalar(2.0 * c[2])) * t + Scalar(c[1])) *
                                  Scalar(0.5 * static_cast<double>(n) * first_axis.scale);
      }
      continue;
    }
    const int degree = part.degree;
    if (part.coordinates <= 2) {
      // Horner's rule in x for each row, in y over the rows.
      const bool two = part.coordinates == 2;
      const Axis& second_axis = axes_[static_cast<std::size_t>(part.axes[two ? 1 : 0])];
      const Scalar y =
          two ? Scalar((q[second_axis.coordinate] - Scalar(second_axis.middle)) * Scalar(second_axis.scale))
              : Scalar(0.0);
      Scalar value(0.0), by_x(0.0), by_y(0.0);
      const double* row = rows_.data() + part.end;
      for (int j = two ? degree : 0; j >= 0; --j) {
        const int most = degree - j;
        row -= most + 1;
        Scalar v(row[most]), d(0.0);
        for (int i = most - 1; i >= 0; --i) {
          d = d * x + v;
          v = v * x + Scalar(row[i]);
        }
        by_y = by_y * y + value;
        value = value * y + v;
        by_x = by_x * y + d;
      }
      total += value;
      gradient[part.pair[0]] += by_x * Scalar(first_axis.scale);
      if (two) gradient[part.pair[1]] += by_y * Scalar(second_axis.scale);
      continue;
    }
    Scalar power[kMostCoordinates][kMostDegree + 1];
    for (int a = 0; a < part.coordinates; ++a) {
      const Axis& axis = axes_[static_cast<std::size_t>(part.axes[a])];
      const Scalar u = (q[axis.coordinate] - Scalar(axis.middle)) * Scalar(axis.scale);
      power[a][0] = Scalar(1.0);
      for (int i = 1; i <= degree; ++i) power[a][i] = power[a][i - 1] * u;
    }
    Scalar value(0.0);
    Scalar slope[kMostCoordinates];
    for (int a = 0; a < part.coordinates; ++a) slope[a] = Scalar(0.0);
    for (std::size_t t = part.first; t < part.end; ++t) {
      const Term& term = terms_[t];
      // Products of all powers before and after each coordinate.
      Scalar before[kMostCoordinates + 1];
      before[0] = Scalar(term.factor);
      for (int a = 0; a < part.coordinates; ++a) before[a + 1] = before[a] * power[a][term.power[a]];
      value += before[part.coordinates];
      Scalar after(1.0);
      for (int a = part.coordinates - 1; a >= 0; --a) {
        if (term.power[a] > 0)
          slope[a] += before[a] * after * power[a][term.power[a] - 1] * Scalar(static_cast<double>(term.power[a]));
        after = after * power[a][term.power[a]];
      }
    }
    total += value;
    for (int a = 0; a < part.coordinates; ++a)
      gradient[part.pair[a]] += slope[a] * Scalar(axes_[static_cast<std::size_t>(part.axes[a])].scale);
  }
  return inside;
}

}  // namespace veridyn::muscle
