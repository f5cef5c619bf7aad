#include "veridyn/vehicle/tyre/tyre_laws.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace veridyn::vehicle {
namespace {

TEST(TyreLaws, AreTyreModelsAndThoseByNumbersHaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  AllTyres::for_each([&]<typename Tyre>() {
    static_assert(TyreModel<Tyre, double>);
    if constexpr (TyreByNumbers<Tyre>) {
      EXPECT_TRUE(names.insert(Tyre::kStudyName).second) << Tyre::kStudyName;
    }
  });
  EXPECT_TRUE(names.contains("linear"));  // that of a study which names none
  static_assert(!TyreByNumbers<MagicFormulaTyre<double>>);
}

// With forces f times as large a tyre at f times the load pushes with f times the force, at the same slip.
TEST(TyreLaws, ScaleWithForce) {
  constexpr double kForce = 0.125, kLoad = 3000.0;
  AllTyresByNumbers::for_each([&]<typename Tyre>() {
    SCOPED_TRACE(Tyre::kStudyName);
    Tyre tyre;
    tyre.mu = 0.9;
    tyre.pneumatic_trail = 0.03;
    const Tyre small = tyre.scaled(kForce, 0.5);
    EXPECT_DOUBLE_EQ(small.pneumatic_trail, 0.015);
    EXPECT_DOUBLE_EQ(small.cornering_stiffness(kForce * kLoad), kForce * tyre.cornering_stiffness(kLoad));
    for (const double slip_angle : {0.01, 0.05, 0.3}) {
      const TyreForces<double> large = tyre.forces(kLoad, 0.02, slip_angle, 0.0);
      const TyreForces<double> scaled = small.forces(kForce * kLoad, 0.02, slip_angle, 0.0);
      EXPECT_GT(large.Fy, 0.0);
      EXPECT_DOUBLE_EQ(scaled.Fx, kForce * large.Fx);
      EXPECT_DOUBLE_EQ(scaled.Fy, kForce * large.Fy);
    }
  });
}

// Numbers of its own that a study leaves out are admissible.
TEST(TyreLaws, HaveAdmissibleDefaults) {
  AllTyresByNumbers::for_each([&]<typename Tyre>() {
    if constexpr (requires { Tyre::study_keys(); }) {
      const Tyre tyre;
      for (const auto& key : Tyre::study_keys()) {
        if (key.is_admissible == nullptr) continue;
        EXPECT_TRUE(key.is_admissible(tyre.*key.value)) << key.name;
        EXPECT_FALSE(key.otherwise.empty()) << key.name;
      }
    }
  });
}

TEST(TyreLaws, OfTheMagicFormulaHaveLimitsOnTheirNumbers) {
  const auto keys = SimpleMagicFormulaTyre<double>::study_keys();
  ASSERT_EQ(keys.size(), 4U);
  EXPECT_FALSE(keys[0].is_admissible(0.99) || keys[0].is_admissible(2.0));   // C
  EXPECT_FALSE(keys[1].is_admissible(1.01));                                 // E
  EXPECT_FALSE(keys[2].is_admissible(-0.01) || keys[2].is_admissible(1.0));  // mu_load
}

}  // namespace
}  // namespace veridyn::vehicle
