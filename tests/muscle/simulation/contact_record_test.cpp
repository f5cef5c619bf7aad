#include "veridyn/muscle/simulation/contact_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/mass_on_slider.hpp"

namespace veridyn::muscle {
namespace {

using testing::ElementsAre;

TEST(ContactRecord, HoldsForceAndPointInGroundAtEachInstant) {
  const MusculoskeletalSystem system(on_a_slider(ball_on_floor("0", "foot")));
  const estimation::RowMatrix q{{0.09}, {0.2}}, still{{0.0}, {0.0}};
  const ContactRecord record = record_contacts(system, {0.0, 0.5}, q, still);
  ASSERT_EQ(record.sources.size(), 1u);
  EXPECT_EQ(record.sources[0].name, "foot");
  EXPECT_EQ(record.sources[0].body, "mass");
  EXPECT_EQ(record.sources[0].force, "foot_force_v");
  EXPECT_EQ(record.sources[0].point, "foot_force_p");
  EXPECT_THAT(record.storage.time, ElementsAre(0.0, 0.5));
  EXPECT_THAT(record.storage.labels, ElementsAre("foot_force_vx", "foot_force_vy", "foot_force_vz", "foot_force_px",
                                                 "foot_force_py", "foot_force_pz"));
  ASSERT_EQ(record.storage.values.size(), 12u);
  // 1 cm deep: it acts half way in, upwards on the body.
  EXPECT_NEAR(record.storage.values[0], 0.0, 1e-12);
  EXPECT_NEAR(record.storage.values[1], kBallStiffness * std::pow(0.01, 1.5), 1e-9);
  EXPECT_NEAR(record.storage.values[4], -0.005, 1e-12);
  // In the air nothing presses.
  EXPECT_EQ(record.storage.values[7], 0.0);
}

TEST(ContactRecord, ContactsOfOneNameAreNumbered) {
  const MusculoskeletalSystem system(on_a_slider(ball_on_floor("0", "c") + ball_on_floor("0", "c")));
  const ContactRecord record =
      record_contacts(system, {0.0}, estimation::RowMatrix{{0.09}}, estimation::RowMatrix{{0.0}});
  ASSERT_EQ(record.sources.size(), 2u);
  EXPECT_EQ(record.sources[0].name, "c");
  EXPECT_EQ(record.sources[1].name, "c_2");
  EXPECT_EQ(record.storage.labels[7], "c_2_force_vy");
}

TEST(ContactRecord, AHalfSpaceThatMovesIsPushedByTheOpposite) {
  // The mass and the floor change roles: the floor hangs below the mass, the ball stands on the ground.
  Model model = on_a_slider(ball_on_floor("0", "foot"));
  std::swap(model.body_forces.contacts[0].sphere_body, model.body_forces.contacts[0].plane_body);
  const MusculoskeletalSystem system(std::move(model));
  const ContactRecord record =
      record_contacts(system, {0.0}, estimation::RowMatrix{{-0.09}}, estimation::RowMatrix{{0.0}});
  ASSERT_EQ(record.sources.size(), 1u);
  EXPECT_EQ(record.sources[0].name, "foot_plane");
  EXPECT_EQ(record.sources[0].body, "mass");
  EXPECT_NEAR(record.storage.values[1], -kBallStiffness * std::pow(0.01, 1.5), 1e-9);
}

}  // namespace
}  // namespace veridyn::muscle
