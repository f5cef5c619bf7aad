#include "veridyn/numerics/dimensional_analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::string_view kPlace = "repeating variables";
/// m, kg, s, K, A: the radian, last of a unit's dimensions, counts as a plain number.
constexpr std::size_t kBase = Unit::kDimensions - 1;

long long product(long long a, long long b) {
  long long out = 0;
  VERIDYN_ASSERT(!__builtin_mul_overflow(a, b, &out));
  return out;
}

long long sum(long long a, long long b) {
  long long out = 0;
  VERIDYN_ASSERT(!__builtin_add_overflow(a, b, &out));
  return out;
}

FractionMatrix dimension_matrix(std::span<const DimensionalQuantity> quantities) {
  FractionMatrix matrix(kBase, std::vector<Fraction>(quantities.size()));
  for (std::size_t j = 0; j < quantities.size(); ++j) {
    for (std::size_t i = 0; i < kBase; ++i) matrix[i][j] = Fraction(quantities[j].unit.dimension[i]);
  }
  return matrix;
}

std::string dimension_name(const Unit& unit) {
  Unit plain = unit;
  plain.dimension.back() = 0;
  return plain.si_name();
}

/// Refuses a basis whose columns are not independent, naming a product of them that has no dimension.
void require_independent(std::span<const DimensionalQuantity> basis) {
  const FractionMatrix dependent = null_space(dimension_matrix(basis), basis.size());
  if (dependent.empty()) return;
  std::vector<std::string> symbols;
  for (const DimensionalQuantity& quantity : basis) symbols.push_back(quantity.symbol);
  throw InputError(kPlace, fmt::format("{} are not independent: {} has no dimension", fmt::join(symbols, ", "),
                                       product_formula(symbols, dependent.front())));
}

/// Exponents of `basis` (independent) that give the dimension of `unit`, where there are such.
std::optional<std::vector<Fraction>> solve(const Unit& unit, std::span<const DimensionalQuantity> basis) {
  std::vector<DimensionalQuantity> with(basis.begin(), basis.end());
  with.push_back({"", unit});
  const ReducedMatrix reduced = reduced_row_echelon(dimension_matrix(with));
  if (!reduced.pivots.empty() && reduced.pivots.back() == basis.size()) return std::nullopt;
  std::vector<Fraction> exponents;
  for (const std::vector<Fraction>& row : reduced.rows) exponents.push_back(row.back());
  return exponents;
}

std::vector<std::string> symbols_of(std::span<const DimensionalQuantity> quantities) {
  std::vector<std::string> symbols;
  for (const DimensionalQuantity& quantity : quantities) symbols.push_back(quantity.symbol);
  return symbols;
}

[[noreturn]] void refuse_dimension(const DimensionalQuantity& quantity, std::span<const DimensionalQuantity> basis) {
  throw InputError(kPlace, fmt::format("{} cannot express the dimension of {} [{}]", fmt::join(symbols_of(basis), ", "),
                                       quantity.symbol, dimension_name(quantity.unit)));
}

}  // namespace

Fraction::Fraction(long long numerator, long long denominator) : numerator_(numerator), denominator_(denominator) {
  VERIDYN_ASSERT(denominator != 0);
  if (denominator_ < 0) {
    numerator_ = product(numerator_, -1);
    denominator_ = product(denominator_, -1);
  }
  const long long common = std::gcd(numerator_, denominator_);
  numerator_ /= common;
  denominator_ /= common;
}

std::string Fraction::text() const {
  return denominator_ == 1 ? fmt::format("{}", numerator_) : fmt::format("{}/{}", numerator_, denominator_);
}

Fraction operator+(const Fraction& p, const Fraction& q) {
  return {sum(product(p.numerator_, q.denominator_), product(q.numerator_, p.denominator_)),
          product(p.denominator_, q.denominator_)};
}
Fraction operator-(const Fraction& p, const Fraction& q) { return p + Fraction(-1) * q; }
Fraction operator*(const Fraction& p, const Fraction& q) {
  // Reduced crosswise first, so that intermediate products stay small.
  const Fraction left(p.numerator_, q.denominator_);
  const Fraction right(q.numerator_, p.denominator_);
  return {product(left.numerator_, right.numerator_), product(left.denominator_, right.denominator_)};
}
Fraction operator/(const Fraction& p, const Fraction& q) {
  VERIDYN_ASSERT(!q.is_zero());
  return p * Fraction(q.denominator_, q.numerator_);
}

ReducedMatrix reduced_row_echelon(FractionMatrix matrix) {
  ReducedMatrix out;
  const std::size_t columns = matrix.empty() ? 0 : matrix.front().size();
  std::size_t rank = 0;
  for (std::size_t column = 0; column < columns && rank < matrix.size(); ++column) {
    std::size_t pivot = rank;
    while (pivot < matrix.size() && matrix[pivot][column].is_zero()) ++pivot;
    if (pivot == matrix.size()) continue;
    std::swap(matrix[rank], matrix[pivot]);
    const Fraction leading = matrix[rank][column];
    for (Fraction& entry : matrix[rank]) entry = entry / leading;
    for (std::size_t row = 0; row < matrix.size(); ++row) {
      const Fraction factor = matrix[row][column];
      if (row == rank || factor.is_zero()) continue;
      for (std::size_t j = 0; j < columns; ++j) matrix[row][j] = matrix[row][j] - factor * matrix[rank][j];
    }
    out.pivots.push_back(column);
    ++rank;
  }
  matrix.resize(rank);
  out.rows = std::move(matrix);
  return out;
}

FractionMatrix null_space(const FractionMatrix& matrix, std::size_t columns) {
  const ReducedMatrix reduced = reduced_row_echelon(matrix);
  FractionMatrix basis;
  for (std::size_t free = 0; free < columns; ++free) {
    if (std::ranges::binary_search(reduced.pivots, free)) continue;
    std::vector<Fraction> x(columns);
    x[free] = Fraction(1);
    for (std::size_t i = 0; i < reduced.rank(); ++i) x[reduced.pivots[i]] = Fraction(-1) * reduced.rows[i][free];
    basis.push_back(std::move(x));
  }
  return basis;
}

std::string product_formula(std::span<const std::string> symbols, std::span<const Fraction> exponents) {
  VERIDYN_ASSERT(symbols.size() == exponents.size());
  std::string above;
  std::string below;
  int below_count = 0;
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    const Fraction& exponent = exponents[i];
    if (exponent.is_zero()) continue;
    const bool positive = exponent.numerator() > 0;
    const Fraction size = positive ? exponent : Fraction(-1) * exponent;
    std::string& side = positive ? above : below;
    if (!side.empty()) side += ' ';
    side += symbols[i];
    if (size != Fraction(1)) side += size.denominator() == 1 ? "^" + size.text() : "^(" + size.text() + ")";
    if (!positive) ++below_count;
  }
  if (below.empty()) return above.empty() ? "1" : above;
  if (above.empty()) above = "1";
  return above + (below_count > 1 ? "/(" + below + ")" : "/" + below);
}

PiGroups pi_groups(std::span<const DimensionalQuantity> quantities, std::span<const std::string> repeating) {
  const std::vector<std::string> symbols = symbols_of(quantities);
  if (const std::set<std::string> unique(symbols.begin(), symbols.end()); unique.size() != symbols.size()) {
    for (std::size_t i = 0; i < symbols.size(); ++i) {
      if (std::ranges::count(symbols, symbols[i]) > 1) {
        throw InputError(kPlace, fmt::format("two quantities are called {}", symbols[i]));
      }
    }
  }
  PiGroups out;
  out.rank = reduced_row_echelon(dimension_matrix(quantities)).rank();
  std::vector<DimensionalQuantity> basis;
  for (const std::string& symbol : repeating) {
    const auto found = std::ranges::find(symbols, symbol);
    if (found == symbols.end()) {
      throw InputError(kPlace, fmt::format("no quantity is called {}{}", symbol, suggestion(symbol, symbols)));
    }
    const auto index = static_cast<std::size_t>(found - symbols.begin());
    if (std::ranges::find(out.repeating, index) != out.repeating.end()) {
      throw InputError(kPlace, fmt::format("{} is named twice", symbol));
    }
    out.repeating.push_back(index);
    basis.push_back(quantities[index]);
  }
  require_independent(basis);
  for (std::size_t j = 0; j < quantities.size(); ++j) {
    if (std::ranges::find(out.repeating, j) != out.repeating.end()) continue;
    const std::optional<std::vector<Fraction>> expressed = solve(quantities[j].unit, basis);
    if (!expressed) refuse_dimension(quantities[j], basis);
    PiGroup group{.quantity = j, .exponents = {}, .formula = {}};
    std::vector<std::string> factors{symbols[j]};
    std::vector<Fraction> powers{Fraction(1)};
    for (std::size_t i = 0; i < basis.size(); ++i) {
      group.exponents.push_back(Fraction(-1) * (*expressed)[i]);
      factors.push_back(basis[i].symbol);
      powers.push_back(group.exponents.back());
    }
    group.formula = product_formula(factors, powers);
    out.groups.push_back(std::move(group));
  }
  // Every quantity was expressed by an independent basis, so its size is the rank.
  VERIDYN_ASSERT(out.rank == out.repeating.size());
  return out;
}

}  // namespace veridyn::numerics
