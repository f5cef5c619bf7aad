#include "veridyn/muscle/simulation/external_load_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/muscle/mass_on_slider.hpp"

namespace veridyn::muscle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The mass at rest half a metre above the ground, its 20 N carried by a load of `force` at a height.
struct CarriedMass {
  MusculoskeletalSystem system;
  ExternalLoads loads;
  MotionAnalysis analysis;

  explicit CarriedMass(double force, double point_x = 0.0) : system(on_a_slider("")) {
    const ExternalLoadSource source{.name = "plate",
                                    .body = "mass",
                                    .constant_force = {0.0, force, 0.0},
                                    .constant_point = {point_x, 0.0, 0.0},
                                    .has_constant_point = true};
    add_external_loads({&source, 1}, nullptr, system.model(), 0.0, loads);
    analysis.time = {0.0, 0.1, 0.2};
    analysis.q = estimation::RowMatrix::Constant(3, 1, 0.5);
    analysis.external = estimation::RowMatrix::Constant(3, 1, force);
    analysis.moment = estimation::RowMatrix::Constant(3, 1, 20.0 - force);
  }
  [[nodiscard]] std::vector<std::string> warnings() const { return external_load_warnings(system, loads, analysis); }
};

TEST(ExternalLoadCheck, FindsTheCoordinateThatLiftsTheModel) {
  EXPECT_EQ(lifting_coordinate(CarriedMass(20.0).system), 0);
  Model level = on_a_slider("");
  level.gravity = {-10.0, 0.0, 0.0};
  EXPECT_EQ(lifting_coordinate(MusculoskeletalSystem(std::move(level))), -1);
}

TEST(ExternalLoadCheck, FitsTheFactorThatCloses) {
  const CarriedMass carried(16.0);
  const ExternalLoadFit fit = external_load_fit(carried.system, carried.analysis);
  EXPECT_NEAR(fit.weight, 20.0, 1e-12);
  EXPECT_NEAR(fit.without, 20.0, 1e-12);
  EXPECT_NEAR(fit.with, 4.0, 1e-12);
  EXPECT_NEAR(fit.factor, 1.25, 1e-12);
}

TEST(ExternalLoadCheck, LoadsThatFitAreNotMentioned) {
  EXPECT_THAT(CarriedMass(20.0).warnings(), IsEmpty());
  EXPECT_THAT(CarriedMass(19.0).warnings(), IsEmpty()) << "5 % of the weight";
}

TEST(ExternalLoadCheck, NamesWhatLoadsThatDoNotFitMayBe) {
  EXPECT_THAT(CarriedMass(-20.0).warnings(), ElementsAre(HasSubstr("have they the opposite sign?")));
  EXPECT_THAT(CarriedMass(2.0).warnings(),
              ElementsAre(HasSubstr("times 10 they would fit best: are they in kilograms?")));
  EXPECT_THAT(CarriedMass(0.02).warnings(), ElementsAre(HasSubstr("are they in kilonewtons?")));
  EXPECT_THAT(CarriedMass(20.0 / 4.448).warnings(), ElementsAre(HasSubstr("are they in pounds?")));
  EXPECT_THAT(CarriedMass(14.0).warnings(), ElementsAre(HasSubstr("leave 6 N (30 % of the weight) at 'height'")));
}

TEST(ExternalLoadCheck, NamesAPointFarFromItsBody) {
  EXPECT_THAT(CarriedMass(20.0, 0.8).warnings(), IsEmpty());
  EXPECT_THAT(CarriedMass(20.0, 150.0).warnings(),
              ElementsAre(HasSubstr("external load 'plate' acts 150 m from body 'mass'")));
}

TEST(ExternalLoadCheck, AReserveThatCarriesTheModelIsNamed) {
  const CarriedMass carried(20.0);
  estimation::RowMatrix reserve = estimation::RowMatrix::Constant(3, 1, 0.9);
  EXPECT_THAT(lifting_reserve_warning(carried.system, reserve), IsEmpty());
  reserve(1, 0) = -3.0;
  EXPECT_THAT(lifting_reserve_warning(carried.system, reserve),
              HasSubstr("the reserve of 'height' carries up to 3 N (15 % of the weight)"));
}

}  // namespace
}  // namespace veridyn::muscle
