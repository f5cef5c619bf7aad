#include "veridyn/io/tables/known_tables.hpp"

#include "tests/io/support.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn::io::internal {
namespace {

TEST(KnownTables, AddUnitsWhereTheProgramIsKnownAndTheHeaderSaysNone) {
  std::vector<Header> jsbsim{{"Time", ""}, {"BodyAccel_X", ""}, {"UBody", "m/s"}, {"other", ""}};
  add_known_units(jsbsim);
  EXPECT_EQ(jsbsim[1].unit, "ft/s^2");
  EXPECT_EQ(jsbsim[2].unit, "m/s");
  EXPECT_EQ(jsbsim[3].unit, "");
  std::vector<Header> others{{"Time", ""}, {"Mass", ""}};
  add_known_units(others);
  EXPECT_EQ(others[1].unit, "");
}

TEST(KnownTables, NameTheColumnsOfSidpac) {
  EXPECT_TRUE(sidpac_columns(20).empty());
  const std::vector<Header> columns = sidpac_columns(90);
  ASSERT_EQ(columns.size(), 90U);
  EXPECT_EQ(columns[3].name, "alpha");
  EXPECT_EQ(columns[16].name, "fdata(17)");
  for (const Header& column : columns) EXPECT_NO_THROW(static_cast<void>(parse_unit(column.unit))) << column.name;
}

}  // namespace
}  // namespace veridyn::io::internal
