#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/units.hpp"

namespace veridyn::numerics {

/// An exact fraction in lowest terms, denominator > 0. Exponents of dimensional analysis are small: products that do
/// not fit into 64 bits are a broken invariant.
class Fraction {
 public:
  Fraction(long long numerator = 0, long long denominator = 1);  // NOLINT: whole numbers are fractions

  [[nodiscard]] long long numerator() const { return numerator_; }
  [[nodiscard]] long long denominator() const { return denominator_; }
  [[nodiscard]] double value() const { return static_cast<double>(numerator_) / static_cast<double>(denominator_); }
  [[nodiscard]] bool is_zero() const { return numerator_ == 0; }
  /// "2", "-1/2"
  [[nodiscard]] std::string text() const;

  friend Fraction operator+(const Fraction& p, const Fraction& q);
  friend Fraction operator-(const Fraction& p, const Fraction& q);
  friend Fraction operator*(const Fraction& p, const Fraction& q);
  /// q must not be 0.
  friend Fraction operator/(const Fraction& p, const Fraction& q);
  friend bool operator==(const Fraction&, const Fraction&) = default;

 private:
  long long numerator_;
  long long denominator_;
};

using FractionMatrix = std::vector<std::vector<Fraction>>;  ///< rows of equal length

/// A matrix after exact Gauss-Jordan elimination.
struct ReducedMatrix {
  FractionMatrix rows;              ///< reduced row echelon form; as many rows as the rank
  std::vector<std::size_t> pivots;  ///< column of the leading 1 of each row, ascending
  [[nodiscard]] std::size_t rank() const { return pivots.size(); }
};
/// Gauss-Jordan elimination, exact.
[[nodiscard]] ReducedMatrix reduced_row_echelon(FractionMatrix matrix);

/// A basis of {x: matrix x = 0}, exact: one vector for each column without a pivot, in which that column is 1.
[[nodiscard]] FractionMatrix null_space(const FractionMatrix& matrix, std::size_t columns);

/// Something with a unit that a phenomenon depends on.
struct DimensionalQuantity {
  std::string symbol;  ///< as it stands in formulas; unique
  Unit unit;           ///< only its dimension counts; angles are plain numbers here
};

/// One dimensionless product.
struct PiGroup {
  std::size_t quantity = 0;         ///< of the list; its exponent is 1
  std::vector<Fraction> exponents;  ///< of the repeating variables, in their order
  std::string formula;              ///< "C_f L/(m u^2)"
};

/// The dimensionless groups of a list of quantities.
struct PiGroups {
  std::size_t rank = 0;                ///< of the dimension matrix (rows m, kg, s, K, A; a column a quantity)
  std::vector<std::size_t> repeating;  ///< of the list, as chosen: as many as the rank
  std::vector<PiGroup> groups;         ///< one for each other quantity, in their order: quantities less rank
};

/// Buckingham's theorem (1914, Phys. Rev. 4:345) with chosen repeating variables: the basis of the null space of the
/// dimension matrix in which every other quantity stands in exactly one group, with exponent 1. Exact.
/// @throws InputError (place "repeating variables") when one is unknown (with the nearest symbol) or named twice, when
/// they are not independent (naming the product that is dimensionless), or when they cannot express the dimension of a
/// quantity (naming it); for symbols that appear twice.
[[nodiscard]] PiGroups pi_groups(std::span<const DimensionalQuantity> quantities,
                                 std::span<const std::string> repeating);

/// "m u^2/L" for the exponents (1, -1, 2) of (m, L, u); "1" when all are zero.
[[nodiscard]] std::string product_formula(std::span<const std::string> symbols, std::span<const Fraction> exponents);

}  // namespace veridyn::numerics
