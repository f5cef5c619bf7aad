#include "veridyn/muscle/model/expression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

double formula_value(const std::string& text, double q = 0.0, double qdot = 0.0) {
  const std::array values{q, qdot};
  return Expression(text, {"q", "qdot"})(values);
}

TEST(Expression, SignsPowersAndProductsBindAsInMathematics) {
  EXPECT_EQ(formula_value("2+3*4"), 14.0);
  EXPECT_EQ(formula_value("-q^2", 3.0), -9.0);
  EXPECT_EQ(formula_value("2^3^2"), 512.0);
  EXPECT_EQ(formula_value("2^-1"), 0.5);
  EXPECT_EQ(formula_value("8/4/2"), 1.0);
  EXPECT_EQ(formula_value("1-2-3"), -4.0);
  EXPECT_EQ(formula_value(" - ( q - 1 ) * 1.5e1 ", 3.0), -30.0);
  EXPECT_EQ(formula_value("q*qdot", 3.0, 0.5), 1.5);
}

TEST(Expression, FunctionsAreThoseOfOpenSim) {
  const double x = 0.37;
  EXPECT_DOUBLE_EQ(formula_value("exp(sin(q))", x), std::exp(std::sin(x)));
  EXPECT_DOUBLE_EQ(formula_value("log(q)+ln(q)", x), 2.0 * std::log(x));
  EXPECT_DOUBLE_EQ(formula_value("sec(q)*csc(q)*cot(q)", x), 1.0 / (std::cos(x) * std::sin(x) * std::tan(x)));
  EXPECT_DOUBLE_EQ(formula_value("square(q)+cube(q)+recip(q)", x), x * x + x * x * x + 1.0 / x);
  EXPECT_DOUBLE_EQ(formula_value("atan2(q,2)+min(q,1)+max(q,1)", x), std::atan2(x, 2.0) + x + 1.0);
  EXPECT_EQ(formula_value("step(q)", -1e-9), 0.0);
  EXPECT_EQ(formula_value("step(q)", 0.0), 1.0);
  EXPECT_EQ(formula_value("delta(q)", 0.0) + formula_value("delta(q)", 1.0), 1.0);
  EXPECT_EQ(formula_value("select(q,3,4)", 0.0), 4.0);
  EXPECT_EQ(formula_value("select(q,3,4)", 0.1), 3.0);
  EXPECT_EQ(formula_value("floor(2.7)+ceil(2.2)+abs(-1)"), 6.0);
}

TEST(Expression, DefinitionsFollowTheFormula) {
  EXPECT_EQ(formula_value("a*q; a = b + 1; b = 2", 5.0), 15.0);
  EXPECT_EQ(formula_value("k*q; k = 4;", 2.0), 8.0);
}

TEST(Expression, CopiesAreIndependent) {
  const Expression one("q^2", {"q"});
  const Expression two(one);
  const std::array a{2.0}, b{3.0};
  EXPECT_EQ(one(a), 4.0);
  EXPECT_EQ(two(b), 9.0);
  EXPECT_EQ(one(a), 4.0);
}

TEST(Expression, WhatIsWrongIsSaid) {
  const auto error = [](const std::string& text) {
    try {
      static_cast<void>(formula_value(text));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  using testing::HasSubstr;
  EXPECT_THAT(error("-10*theta"), testing::AllOf(HasSubstr("'-10*theta'"), HasSubstr("theta")));
  EXPECT_THAT(error("sin(q"), HasSubstr("parenthesis"));
  EXPECT_THAT(error(""), HasSubstr("'': "));
  EXPECT_THAT(error("q,2"), HasSubstr("is a list of formulas"));
  EXPECT_THAT(error("q; 3"), HasSubstr("'3' defines nothing"));
  EXPECT_THAT(error("_pi*q"), HasSubstr("_pi"));
}

}  // namespace
}  // namespace veridyn::muscle
