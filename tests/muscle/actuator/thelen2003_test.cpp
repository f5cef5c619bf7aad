#include "veridyn/muscle/actuator/thelen2003.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/actuator/curve_checks.hpp"
#include "tests/muscle/arm26_muscles.hpp"

namespace veridyn::muscle {
namespace {

TEST(Thelen2003, MatchesPrintedValuesOfItsCurves) {
  const Thelen2003 defaults, arm26(arm26_thelen());
  const auto fL = [](const Thelen2003& t) { return [&](double l) { return t.active_length(l); }; };
  const auto fP = [](const Thelen2003& t) { return [&](double l) { return t.passive_force(l); }; };
  const auto fT = [](const Thelen2003& t) { return [&](double l) { return t.tendon_force(l); }; };
  expect_points(
      std::array<Point, 4>{
          {{0.5, 0.573753420737}, {0.75, 0.870324725833}, {1.2, 0.914947228730}, {1.5, 0.573753420737}}},
      fL(defaults), 2e-12);
  expect_points(
      std::array<Point, 4>{
          {{0.5, 0.606530659713}, {0.75, 0.882496902585}, {1.2, 0.923116346387}, {1.5, 0.606530659713}}},
      fL(arm26), 2e-12);
  expect_points(std::array<Point, 3>{{{0.75, 0.0}, {1.2, 0.0291323385009}, {1.5, 0.430762717870}}}, fP(defaults),
                2e-12);
  expect_points(std::array<Point, 3>{{{0.75, 0.0}, {1.2, 0.0521224686478}, {1.5, 0.504338766876}}}, fP(arm26), 2e-12);
  expect_points(std::array<Point, 5>{{{1.005, 0.0147279361341},
                                      {1.01, 0.0420009751365},
                                      {1.02, 0.186027557773},
                                      {1.033, 0.700422445583},
                                      {1.05, 1.42796793488}}},
                fT(defaults), 5e-12);
  expect_points(std::array<Point, 5>{{{1.005, 0.0191985126475},
                                      {1.01, 0.0597140020098},
                                      {1.02, 0.325653710074},
                                      {1.033, 1.0},
                                      {1.05, 1.88187332036}}},
                fT(arm26), 5e-12);
  EXPECT_NEAR(defaults.toe_strain() / 0.04, 0.60861553787588, 1e-14);
}

TEST(Thelen2003, MatchesPrintedValuesOfForceVelocity) {
  const Thelen2003 defaults, arm26(arm26_thelen());
  const auto fV = [](const Thelen2003& t, double a) {
    return [&t, a](double v) { return t.active_force(a, 1.0, v) / a; };
  };
  expect_points(std::array<Point, 4>{{{-0.2, 0.4444444444}, {-0.1, 0.6428571429}, {0.1, 1.285714286}, {0.3, 1.364125}}},
                fV(defaults, 1.0), 1e-9);
  expect_points(std::array<Point, 4>{{{-0.2, 0.48}, {-0.1, 0.675}, {0.1, 1.416}, {0.3, 1.611764706}}}, fV(arm26, 1.0),
                1e-9);
  expect_points(std::array<Point, 4>{{{-0.2, 0.2982456140}, {-0.1, 0.5121951220}, {0.1, 1.32}, {0.3, 1.41925}}},
                fV(defaults, 0.5), 1e-9);
  expect_points(
      std::array<Point, 4>{{{-0.2, 0.3290322581}, {-0.1, 0.5478260870}, {0.1, 1.507317073}, {0.3, 1.670967742}}},
      fV(arm26, 0.5), 1e-9);
}

TEST(Thelen2003, VelocityIsTheInverseOfForce) { expect_velocity_inverts_force(Thelen2003(arm26_thelen()), 0.0, 3.0); }

TEST(Thelen2003, SlopesAndEnergiesBelongToTheForces) {
  expect_consistent(Thelen2003());
  expect_consistent(Thelen2003(arm26_thelen()));
}

}  // namespace
}  // namespace veridyn::muscle
