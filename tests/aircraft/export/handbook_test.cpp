#include "veridyn/aircraft/export/handbook.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

double estimated(const Subject& s, const HandbookFlight& flight, Coefficient c, const char* term,
                 const SurfaceSigns& signs = {}) {
  const auto value = handbook_value(s, flight, signs, c, parse_term(term, "test"));
  EXPECT_TRUE(value) << term;
  return value ? value->value : kNaN;
}

// An unswept wing of infinite aspect ratio has 2 pi; one of aspect ratio 6 has 4.53 1/rad by the same formula, which
// Anderson (Fundamentals of Aerodynamics, eq. 5.81) gives with another approximation as 4.36.
TEST(Handbook, LiftSlopeIsThatOfAStraightWing) {
  Subject s = builtin_subject("thor");
  s.span = 1.0, s.wing_area = 1.0 / 6.0;
  EXPECT_NEAR(estimated(s, {}, Coefficient::kCL, "alpha"), kFullTurn * 6.0 / (2.0 + std::sqrt(40.0)), 1e-12);
  s.wing_area = 1e-6;
  EXPECT_NEAR(estimated(s, {}, Coefficient::kCL, "alpha"), kFullTurn, 1e-4);
}

TEST(Handbook, DragIsAParabolaInLift) {
  const Subject s = builtin_subject("thor");
  const HandbookFlight flight{.CL = 0.5, .CL_alpha = 4.0, .alpha = 0.1};
  const auto drag = [&](double alpha) {
    return estimated(s, flight, Coefficient::kCD, "1") + estimated(s, flight, Coefficient::kCD, "alpha") * alpha +
           estimated(s, flight, Coefficient::kCD, "alpha^2") * alpha * alpha;
  };
  const double without_lift = -0.1 / 4.0;  // CL = 0.1 + 4 alpha
  EXPECT_NEAR(drag(without_lift), 0.0055 * 4.5, 1e-12);
  EXPECT_NEAR(drag(0.1) - drag(without_lift), std::pow(0.5 / 0.9, 2) * (drag(0.2) - drag(without_lift)), 1e-12);
}

TEST(Handbook, SignsFollowTheConvention) {
  const Subject s = builtin_subject("thor");
  const SurfaceSigns other{.elevator = -1.0, .aileron = -1.0, .rudder = -1.0};
  for (const auto& [c, term] :
       {std::pair{Coefficient::kCL, "de"}, std::pair{Coefficient::kCm, "de"}, std::pair{Coefficient::kCl, "da"},
        std::pair{Coefficient::kCY, "dr"}, std::pair{Coefficient::kCn, "dr"}})
    EXPECT_EQ(estimated(s, {}, c, term), -estimated(s, {}, c, term, other)) << term;
  // The textbooks': down, left is positive (see `thor`).
  EXPECT_LT(estimated(s, {}, Coefficient::kCm, "de"), 0.0);
  EXPECT_LT(estimated(s, {}, Coefficient::kCl, "da"), 0.0);
  EXPECT_LT(estimated(s, {}, Coefficient::kCn, "dr"), 0.0);
  EXPECT_GT(estimated(s, {}, Coefficient::kCY, "dr"), 0.0);
}

TEST(Handbook, HasNoValueForWhatNoSimpleMethodGives) {
  for (const char* term : {"alpha*q_n", "spline(alpha, 5 deg, 2)", "CT", "abs(de)"})
    EXPECT_FALSE(handbook_value(builtin_subject("thor"), {}, {}, Coefficient::kCL, parse_term(term, "test"))) << term;
}

// Published derivatives of built-in aircraft (docs/aircraft.md has the whole table): an estimate that has the wrong
// sign or order fails here.
TEST(Handbook, EstimatesAreOfTheSizeOfPublishedDerivatives) {
  for (const char* name : {"aerosonde", "thor", "unatrap"}) {
    const Subject s = builtin_subject(name);
    const double flip = s.model.at(Coefficient::kCm).value_of("de").value() < 0.0 ? 1.0 : -1.0;
    const SurfaceSigns signs{.elevator = flip, .aileron = flip, .rudder = flip};
    const HandbookFlight flight{.CL = 0.5, .CL_alpha = *s.model.at(Coefficient::kCL).value_of("alpha"), .alpha = 0.05};
    for (const auto& [c, term, factor] :
         {std::tuple{Coefficient::kCL, "alpha", 2.0}, std::tuple{Coefficient::kCD, "alpha^2", 3.0},
          std::tuple{Coefficient::kCm, "alpha", 3.0}, std::tuple{Coefficient::kCm, "q_n", 3.0},
          std::tuple{Coefficient::kCm, "de", 3.0}, std::tuple{Coefficient::kCl, "p_n", 3.0},
          std::tuple{Coefficient::kCl, "da", 3.0}, std::tuple{Coefficient::kCY, "beta", 4.0},
          std::tuple{Coefficient::kCl, "beta", 4.0}, std::tuple{Coefficient::kCn, "beta", 4.0},
          std::tuple{Coefficient::kCn, "dr", 4.0}}) {
      const double published = *s.model.at(c).value_of(term), ours = estimated(s, flight, c, term, signs);
      EXPECT_GT(ours / published, 1.0 / factor) << name << " " << name_of(c) << " " << term << ": " << published;
      EXPECT_LT(ours / published, factor) << name << " " << name_of(c) << " " << term << ": " << published;
    }
  }
}

TEST(Handbook, InertiaIsThatOfABodyOfThisSize) {
  Subject s = builtin_subject("thor");
  const Inertia thor = handbook_inertia(s);
  EXPECT_TRUE(thor.inadmissible().empty()) << thor.inadmissible();
  EXPECT_GT(thor.Jx / s.inertia->Jx, 0.5);
  EXPECT_LT(thor.Jz / s.inertia->Jz, 2.0);
  // m L^2: twice the size with eight times the mass has 32 times the inertia.
  s.span *= 2.0, s.mass *= 8.0;
  EXPECT_NEAR(handbook_inertia(s).Jy, 32.0 * thor.Jy, 1e-12);
}

}  // namespace
}  // namespace veridyn::aircraft
