#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_functions.hpp"
#include "veridyn/numerics/multivariate_polynomial.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// How `FittedPaths` fits, and how well it has to.
struct PathFitOptions {
  double tolerance = 1.0e-4;  ///< of lengths [m] and moment arms [m/rad or 1], on the check poses
  int max_degree = 12;        ///< total degree of a polynomial; three less with three coordinates, six less with more
  int check_poses = 200;      ///< independent of those of the fit
  /// Leave exact what is better left so: paths without wraps, which cost less than polynomials of many coordinates
  /// (unless all of them depend on two at most), and those whose fit misses the tolerance: in a length, or in moment
  /// arms at more than `most_above` of the check poses or by more than `largest` at one. To be evaluated with
  /// kinematics.
  bool mixed = false;
  double most_above = 0.05;
  double largest = 1.0e-3;  ///< [m/rad or 1]
};

/// How well one muscle's path is fitted, on poses that the fit did not use.
struct PathFitError {
  std::string muscle;
  bool fitted = true;            ///< false: left exact; the figures are those of the fit that was not good enough, or 0
  bool given = false;            ///< by the model as a function, which is used as it is; fitted, without error
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
/// A path's length is first divided into sums of functions of fewer coordinates where it is such a sum (the shoulder
/// and the elbow part of a biceps). Each part becomes a total-degree polynomial in coordinates scaled to -1..1, of the
/// least degree that meets the tolerance, by least squares on lengths and moment arms at Halton points of the
/// coordinates' ranges; a part of one coordinate that would need more becomes a chain of cubic pieces through lengths
/// and moment arms at their ends, halved until they follow: where a path changes sides, its length or its arms jump
/// between two pieces. Moment arms are the exact derivatives of the fitted lengths.
///
/// Paths that the model gives as functions of coordinates are those functions.
///
/// `evaluate` is compiled for double and `SimulationJet`.
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
  /// No path is left exact: `evaluate` needs no kinematics.
  [[nodiscard]] bool all_fitted() const { return exact_.empty(); }

  /// Lengths [m] by muscle and dL/dq by pair; zero for those that are left exact. False if a coordinate that matters
  /// lies outside its range: polynomials are then extrapolated, pieces continue straight. Does not allocate or throw.
  template <typename Scalar>
  bool evaluate(const Scalar* q, Scalar* length, Scalar* gradient) const;
  /// The same with the exact ones too, from the paths that the fit was made of.
  template <typename Scalar>
  bool evaluate(const MusclePaths& exact, const Kinematics<Scalar>& kinematics, const Scalar* q,
                PathWorkspace<Scalar>& workspace, Scalar* length, Scalar* gradient) const;

 private:
  class Builder;

  FittedPaths() = default;

  static constexpr int kMostCoordinates = 8;
  struct Axis {  // x = (q - middle) * scale
    int coordinate = 0;
    double middle = 0.0;
    double scale = 1.0;
  };
  struct Part {
    int muscle = 0;
    int axes[kMostCoordinates] = {};  ///< in the order of the polynomial's arguments
    std::size_t pair[kMostCoordinates] = {};
    int coordinates = 0;
    numerics::MultivariatePolynomial polynomial{};  ///< of no argument: pieces
    std::size_t first = 0;                          ///< in pieces_
    [[nodiscard]] bool in_pieces() const { return polynomial.arguments() == 0; }
  };

  /// Along `axis`, -1..1 within its range.
  template <typename Scalar>
  [[nodiscard]] static Scalar along(const Axis& axis, const Scalar* q) {
    return (q[axis.coordinate] - Scalar(axis.middle)) * Scalar(axis.scale);
  }
  template <typename Scalar>
  void add_pieces(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const;
  template <typename Scalar>
  void add_polynomial(const Part& part, const Scalar* q, Scalar& length, Scalar* gradient) const;

  std::vector<Axis> axes_;
  std::vector<double> constant_;
  std::vector<MusclePaths::Pair> pairs_;
  std::vector<Part> parts_;
  std::vector<numerics::PiecewisePolynomial> pieces_;  ///< of their coordinate
  PathFunctions functions_;                            ///< that the model gives
  std::vector<PathFitError> errors_;
  std::vector<std::uint8_t> fitted_;                     ///< by muscle
  std::vector<int> exact_;                               ///< the other muscles
  std::vector<std::array<std::size_t, 2>> exact_pairs_;  ///< their pairs: of the exact paths, here
};

}  // namespace veridyn::muscle
