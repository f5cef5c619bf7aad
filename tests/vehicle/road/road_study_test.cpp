#include "veridyn/vehicle/road/road_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/vehicle/road/roads.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::vehicle {
namespace {

using testing::at;
using ::testing::HasSubstr;
using testing::text_crg;

class RoadStudy : public ::testing::Test {
 protected:
  static std::shared_ptr<const Road> read(const std::string& text, const std::filesystem::path& folder = {}) {
    const Study study = Study::parse("[road]\n" + text, "s.toml", folder);
    const StudyTable table = study.root().table("road");
    auto road = read_road(table, 5);
    table.finish();
    return road;
  }
  static std::string refusal(const std::string& text) {
    return why([&] { (void)read(text); });
  }
};

TEST_F(RoadStudy, ReadsEveryKind) {
  EXPECT_EQ(read_road(StudyTable("road"), 1)->height(at(3.0)), 0.0);
  EXPECT_EQ(read("kind = 'flat'\n")->height(at(3.0)), 0.0);
  EXPECT_DOUBLE_EQ(read("kind = 'step'\nat = 2\nheight = '5 cm'\n")->height(at(3.0)), 0.05);
  EXPECT_EQ(read("kind = 'step'\nat = 2\nheight = 0.05\nside = 'left'\n")->height(at(3.0, -1.0)), 0.0);
  EXPECT_DOUBLE_EQ(read("kind = 'bump'\nat = 2\nheight = 0.05\nlength = 2\n")->height(at(3.0)), 0.05);
  EXPECT_DOUBLE_EQ(read("kind = 'ramp'\nat = 2\nheight = 0.05\nlength = 2\n")->height(at(3.0)), 0.025);
  EXPECT_DOUBLE_EQ(read("kind = 'plank'\nat = 2\nheight = 0.05\nlength = 2\n")->height(at(3.0)), 0.05);
  // From the study's seed, unless the road has one.
  EXPECT_EQ(read("kind = 'iso8608'\nclass = 'D'\n")->height(at(40.0)),
            read("kind = 'iso8608'\nroughness = 1024e-6\nseed = 5\n")->height(at(40.0)));
  EXPECT_NE(read("kind = 'iso8608'\n")->height(at(40.0)), read("kind = 'iso8608'\nseed = 6\n")->height(at(40.0)));
  const test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  write_file(folder / "p.csv", "distance[m],height[m]\n0,0\n10,1\n");
  write_file(folder / "r.crg", text_crg());
  EXPECT_DOUBLE_EQ(read("kind = 'file'\nfile = 'p.csv'\n", folder)->height(at(5.0)), 0.5);
  EXPECT_FLOAT_EQ(static_cast<float>(read("kind = 'file'\nfile = 'r.crg'\n", folder)->height({12.0, 0.5, 0.0, 0.0})),
                  0.25F);
}

TEST_F(RoadStudy, RefusesWithTheLineOfTheKey) {
  EXPECT_THAT(refusal("kind = 'flatt'\n"), HasSubstr("s.toml:2"));
  EXPECT_THAT(refusal("kind = 'step'\n"), HasSubstr("height"));
  EXPECT_THAT(refusal("kind = 'bump'\nheight = 0.1\nlength = 0\n"), HasSubstr("s.toml:4: road.length"));
  EXPECT_THAT(refusal("kind = 'iso8608'\nclass = 'Z'\n"), HasSubstr("s.toml:3: road.class"));
  EXPECT_THAT(refusal("kind = 'iso8608'\nlength = 1e12\n"), HasSubstr("length = 1000000000000 must be"));
  EXPECT_THAT(refusal("kind = 'file'\nfile = 'a.obj'\n"), HasSubstr("a road is a table (.csv) or OpenCRG (.crg)"));
  EXPECT_THAT(refusal("kind = 'flat'\nheight = 3\n"), HasSubstr("height"));
}

}  // namespace
}  // namespace veridyn::vehicle
