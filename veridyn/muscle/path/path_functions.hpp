#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// The paths of a model that are given as functions of coordinates: lengths [m], and dL/dq, which are their
/// derivatives. Shared by exact and by fitted paths. Evaluation does not allocate or throw.
class PathFunctions {
 public:
  /// Adds the function of a muscle of the model, whose dL/dq are at first_pair, first_pair + 1, ... of a gradient in
  /// the order of the coordinates that are returned: ascending. @throws InputError naming the muscle when the
  /// function's arguments are not coordinates of the model, each once.
  std::vector<int> add(const Model& model, int muscle, std::size_t first_pair);
  /// Pair i becomes place[i].
  void move_pairs(std::span<const std::size_t> place);
  /// Coefficients of a muscle's polynomial; 0 for other functions and muscles.
  [[nodiscard]] int terms(int muscle) const;

  /// Sets the lengths of the muscles that were added, but those of `skip` (by muscle, may be empty), and their
  /// gradients.
  template <bool kGradient, typename Scalar>
  void evaluate(const Scalar* q, Scalar* length, Scalar* gradient, std::span<const std::uint8_t> skip = {}) const;
  /// Whether all coordinates that they depend on are in their ranges.
  template <typename Scalar>
  [[nodiscard]] bool inside(const Scalar* q) const;

 private:
  static constexpr int kMostCoordinates = numerics::MultivariatePolynomial::kMostArguments;
  struct Argument {
    int coordinate = 0;
    std::size_t pair = 0;
    double low = 0.0, high = 0.0;  ///< of the coordinate's range
  };
  struct Entry {
    int muscle = 0;
    std::vector<Argument> arguments;
    std::variant<numerics::PiecewisePolynomial, numerics::MultivariatePolynomial> function;
  };

  std::vector<Entry> entries_;
};

// Details ------------------------------------------------------------------------------------------------------------

template <bool kGradient, typename Scalar>
void PathFunctions::evaluate(const Scalar* q, Scalar* length, Scalar* gradient,
                             std::span<const std::uint8_t> skip) const {
  for (const Entry& entry : entries_) {
    if (!skip.empty() && skip[entry.muscle] != 0) continue;
    if (const auto* of_one = std::get_if<numerics::PiecewisePolynomial>(&entry.function)) {
      const numerics::FunctionValue<Scalar> f = of_one->evaluate(q[entry.arguments[0].coordinate]);
      length[entry.muscle] = f.value;
      if constexpr (kGradient) gradient[entry.arguments[0].pair] = f.slope;
      continue;
    }
    const auto& polynomial = *std::get_if<numerics::MultivariatePolynomial>(&entry.function);
    Scalar x[kMostCoordinates], slope[kMostCoordinates];
    for (std::size_t i = 0; i < entry.arguments.size(); ++i) x[i] = q[entry.arguments[i].coordinate];
    if constexpr (kGradient) {
      length[entry.muscle] = polynomial.evaluate(x, slope);
      for (std::size_t i = 0; i < entry.arguments.size(); ++i) gradient[entry.arguments[i].pair] = slope[i];
    } else {
      length[entry.muscle] = polynomial.value(x);
    }
  }
}

template <typename Scalar>
bool PathFunctions::inside(const Scalar* q) const {
  return std::all_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return std::all_of(entry.arguments.begin(), entry.arguments.end(), [&](const Argument& a) {
      const double value = value_of(q[a.coordinate]), slack = 1e-9 * (1.0 + a.high - a.low);
      return value >= a.low - slack && value <= a.high + slack;
    });
  });
}

}  // namespace veridyn::muscle
