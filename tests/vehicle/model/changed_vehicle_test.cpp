#include "veridyn/vehicle/model/changed_vehicle.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/study.hpp"

namespace veridyn::vehicle {
namespace {

Vehicle reference_with(const std::string& more) {
  return read_vehicle(Study::parse("[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n" + more, "study.toml")
                          .root()
                          .table("subject"),
                      VehicleNeeds::kFourWheel);
}

TEST(ChangedVehicle, HasTyresOfItsStiffnessAndFriction) {
  for (const char* tyre : {"linear", "fiala", "magic formula"}) {
    const Vehicle before = reference_with(std::string("mu = 0.8\ntyre = \"") + tyre + "\"");
    VehicleParameters<double> p = before.parameters;
    p.C_f *= 1.1;
    p.C_r *= 0.9;
    p.mu = 0.6;
    const Vehicle after = with_parameters(before, p);
    const auto was = cornering_stiffnesses(before), is = cornering_stiffnesses(after);
    EXPECT_NEAR(is[0], 1.1 * was[0], 1e-9 * was[0]) << tyre;
    EXPECT_NEAR(is[1], 0.9 * was[1], 1e-9 * was[1]) << tyre;
    // As a study with these numbers reads them, but for the longitudinal stiffness, which stays.
    const Vehicle read_again =
        reference_with(std::string("mu = 0.6\nC_f = 66000\nC_r = 108000\ntyre = \"") + tyre + "\"");
    std::visit(
        [&]<typename Tyre>(const AxleTyres<Tyre>& t) {
          if constexpr (requires { t.front.mu; }) {
            EXPECT_DOUBLE_EQ(t.front.mu, std::get<AxleTyres<Tyre>>(read_again.tyres).front.mu) << tyre;
            EXPECT_DOUBLE_EQ(t.rear.stiffness, std::get<AxleTyres<Tyre>>(read_again.tyres).rear.stiffness) << tyre;
            EXPECT_DOUBLE_EQ(t.front.slip_stiffness, std::get<AxleTyres<Tyre>>(before.tyres).front.slip_stiffness);
          }
        },
        after.tyres);
  }
}

TEST(ChangedVehicle, OfTheSameNumbersIsTheSame) {
  const Vehicle car = reference_with("");
  const Vehicle same = with_parameters(car, car.parameters);
  EXPECT_EQ(write_vehicle_toml(same), write_vehicle_toml(car));
  EXPECT_EQ(cornering_stiffnesses(same), cornering_stiffnesses(car));
}

}  // namespace
}  // namespace veridyn::vehicle
