#include "veridyn/muscle/osim/osim_element.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle::osim {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kDocument = R"(<?xml version="1.0"?>
<OpenSimDocument Version="30000">
  <Model name="m">
    <defaults><Thing name="default"><mass>2.5</mass><on>true</on></Thing></defaults>
    <Thing name="first">
      <location>1 -2e-1 +3</location>
      <bad>1 two</bad>
      <set><objects><Part name="a"/><Part name="b"/></objects><groups/></set>
    </Thing>
  </Model>
</OpenSimDocument>
)";

class OsimElement : public ::testing::Test {
 protected:
  Document document{kDocument, "m.osim"};
  Element thing{document, document.model().child("Thing")};

  template <typename Call>
  static std::string error_of(const Call& call) {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(OsimElement, PropertiesComeFromTheObjectOrItsTypesDefaults) {
  EXPECT_EQ(thing.vector_or("location", Eigen::Vector3d::Zero()), Eigen::Vector3d(1.0, -0.2, 3.0));
  EXPECT_EQ(thing.number_or("mass", 0.0), 2.5);
  EXPECT_TRUE(thing.flag_or("on", false));
  EXPECT_EQ(thing.number_or("absent", 7.0), 7.0);
  EXPECT_FALSE(thing.has("absent"));
}

TEST_F(OsimElement, ObjectsOfASetAreWithoutItsGroups) {
  std::vector<std::string> names;
  for (const Element& part : thing.objects("set")) names.push_back(part.name());
  EXPECT_THAT(names, ElementsAre("a", "b"));
}

TEST_F(OsimElement, ErrorsNameFileLineElementAndProperty) {
  EXPECT_THAT(error_of([&] { (void)thing.numbers("bad"); }),
              AllOf(HasSubstr("m.osim:5: Thing 'first'"), HasSubstr("bad: 'two' is not a number")));
  EXPECT_THAT(error_of([&] { (void)thing.number_or("location", 0.0); }), HasSubstr("3 numbers where one is expected"));
  EXPECT_THAT(error_of([&] { (void)thing.positive_or("absent", -1.0); }), HasSubstr("-1 must be > 0"));
  EXPECT_THAT(error_of([] { const Document broken("<OpenSimDocument>\n<Model>\n", "b.osim"); }),
              HasSubstr("b.osim:2: not well-formed XML"));
  EXPECT_THAT(error_of([] { const Document other("<Other/>", "o.osim"); }), HasSubstr("not an OpenSim model"));
}

TEST(LastPart, IsTheNameAtTheEndOfAPath) {
  EXPECT_EQ(last_part("/bodyset/r_humerus"), "r_humerus");
  EXPECT_EQ(last_part("r_humerus"), "r_humerus");
  EXPECT_EQ(last_part("/bodyset/r_humerus//"), "r_humerus");
}

}  // namespace
}  // namespace veridyn::muscle::osim
