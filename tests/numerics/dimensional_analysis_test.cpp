#include "veridyn/numerics/dimensional_analysis.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/support/refusal.hpp"

namespace veridyn::numerics {
namespace {

TEST(DimensionalAnalysis, FractionsAreExactAndInLowestTerms) {
  EXPECT_EQ(Fraction(2, -4).text(), "-1/2");
  EXPECT_EQ(Fraction(1, 3) + Fraction(1, 6), Fraction(1, 2));
  EXPECT_EQ(Fraction(3, 4) * Fraction(8, 9), Fraction(2, 3));
  EXPECT_EQ(Fraction(3, 4) / Fraction(-3, 8), Fraction(-2));
  EXPECT_EQ(Fraction(1, 3) - Fraction(1, 3), Fraction());
}

// Products of the null space with the matrix are exactly zero, and rank + nullity is the number of columns.
TEST(DimensionalAnalysis, NullSpacesOfRandomMatricesAreExact) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const std::size_t rows = 1 + random() % 5, columns = 1 + random() % 8;
    FractionMatrix matrix(rows, std::vector<Fraction>(columns));
    for (auto& row : matrix) {
      for (Fraction& entry : row) entry = Fraction(static_cast<long long>(random() % 7) - 3);
    }
    const FractionMatrix null = null_space(matrix, columns);
    EXPECT_EQ(reduced_row_echelon(matrix).rank() + null.size(), columns);
    for (const auto& x : null) {
      for (const auto& row : matrix) {
        Fraction sum;
        for (std::size_t j = 0; j < columns; ++j) sum = sum + row[j] * x[j];
        EXPECT_TRUE(sum.is_zero());
      }
    }
  }
}

// The textbook example: drag D(rho, V, l, mu) has two groups, the drag coefficient and 1/Reynolds.
TEST(DimensionalAnalysis, FindsTheDragCoefficientAndTheReynoldsNumber) {
  const std::array<DimensionalQuantity, 5> quantities{{{"D", parse_unit("N")},
                                                       {"rho", parse_unit("kg/m^3")},
                                                       {"V", parse_unit("m/s")},
                                                       {"l", parse_unit("m")},
                                                       {"mu", parse_unit("Pa s")}}};
  const PiGroups pi = pi_groups(quantities, std::array<std::string, 3>{"rho", "V", "l"});
  EXPECT_EQ(pi.rank, 3U);
  ASSERT_EQ(pi.groups.size(), 2U);
  EXPECT_EQ(pi.groups[0].formula, "D/(rho V^2 l^2)");
  EXPECT_EQ(pi.groups[1].formula, "mu/(rho V l)");
  // Other repeating variables, a fractional exponent: V sqrt(rho/D) l.
  const PiGroups other = pi_groups(quantities, std::array<std::string, 3>{"rho", "D", "l"});
  EXPECT_EQ(other.groups[0].formula, "V rho^(1/2) l/D^(1/2)");
}

TEST(DimensionalAnalysis, CountsAnglesAsPlainNumbers) {
  const std::array<DimensionalQuantity, 5> quantities{{{"m", parse_unit("kg")},
                                                       {"L", parse_unit("m")},
                                                       {"u", parse_unit("m/s")},
                                                       {"C", parse_unit("N/rad")},
                                                       {"alpha", parse_unit("rad")}}};
  const PiGroups pi = pi_groups(quantities, std::array<std::string, 3>{"m", "L", "u"});
  ASSERT_EQ(pi.groups.size(), 2U);
  EXPECT_EQ(pi.groups[0].formula, "C L/(m u^2)");
  EXPECT_EQ(pi.groups[1].formula, "alpha");
}

TEST(DimensionalAnalysis, RefusesRepeatingVariablesThatCannotServe) {
  const std::array<DimensionalQuantity, 5> q{{{"m", parse_unit("kg")},
                                              {"L", parse_unit("m")},
                                              {"u", parse_unit("m/s")},
                                              {"a", parse_unit("m")},
                                              {"T", parse_unit("K")}}};
  const std::span<const DimensionalQuantity> mechanical(q.data(), 4);
  const auto with = [](std::span<const DimensionalQuantity> list, std::vector<std::string> names) {
    return why([&] { (void)pi_groups(list, names); });
  };
  EXPECT_EQ(with(mechanical, {"m", "L", "a"}),
            "repeating variables: m, L, a are not independent: a/L has no dimension");
  EXPECT_EQ(with(mechanical, {"m", "L"}), "repeating variables: m, L cannot express the dimension of u [m/s]");
  EXPECT_EQ(with(q, {"m", "L", "u"}), "repeating variables: m, L, u cannot express the dimension of T [K]");
  EXPECT_EQ(with(mechanical, {"m", "L", "L"}), "repeating variables: L is named twice");
  EXPECT_TRUE(with(mechanical, {"m", "L", "v"}).starts_with("repeating variables: no quantity is called v"));
}

}  // namespace
}  // namespace veridyn::numerics
