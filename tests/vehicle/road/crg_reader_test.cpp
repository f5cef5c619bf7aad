#include "veridyn/vehicle/road/crg_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"
#include "tests/vehicle/road/roads.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

using testing::big_endian;
using testing::crg_header;
using ::testing::HasSubstr;
using testing::kHeights;
using testing::text_crg;

TEST(CrgReader, ReadsEveryFormatToTheSameSurface) {
  std::string wide = crg_header("LDFI");
  for (std::size_t i = 0; i < 9; ++i) {
    std::string cell = std::to_string(kHeights[i]);
    wide += std::string(20 - cell.size(), ' ') + cell + (i % 3 == 2 ? "\r\n" : "");
  }
  for (const std::string& bytes :
       {text_crg(), wide, big_endian<float, std::uint32_t>("KRBI"), big_endian<double, std::uint64_t>("KDBI")}) {
    const CrgRoad road = parse_crg(bytes, "r.crg");
    ASSERT_EQ(road.rows(), 3U);
    EXPECT_THAT(road.grid().v, ::testing::ElementsAre(-1.0, 0.5, 2.0));
    for (std::size_t i = 0; i < 9; ++i) EXPECT_FLOAT_EQ(road.grid().z[i], static_cast<float>(kHeights[i]));
    const auto z = [&](double x, double y) { return road.height({x, y, 0.0, 0.0}); };
    EXPECT_FLOAT_EQ(static_cast<float>(z(12.0, 0.5)), 0.25F);
    EXPECT_NEAR(z(11.0, -0.25), 0.25 * (0.0 + 0.1 + 0.5 + 0.25), 1e-7) << "the middle of four points";
    EXPECT_FLOAT_EQ(static_cast<float>(z(0.0, -9.0)), 0.0F) << "that of the corner";
    EXPECT_FLOAT_EQ(static_cast<float>(z(99.0, 9.0)), 3.0F);
  }
}

TEST(CrgReader, TakesSectionsFromLeftToRightToo) {
  const std::string bytes =
      "$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 1\n$\n$KD_Definition\n#:LRFI\nD:long section at v = 2.0,m\n"
      "D:long section at v = 0.5,m\nD:long section at v = -1.0,m\n$\n$$$$\n 0.3000000 0.2000000 0.1000000\n"
      " 0.3000000 0.2000000 0.1000000\n";
  const CrgRoad road = parse_crg(bytes, "r.crg");
  EXPECT_THAT(road.grid().v, ::testing::ElementsAre(-1.0, 0.5, 2.0));
  EXPECT_FLOAT_EQ(static_cast<float>(road.height({0.3, 2.0, 0.0, 0.0})), 0.3F);
  EXPECT_FLOAT_EQ(static_cast<float>(road.height({0.3, -1.0, 0.0, 0.0})), 0.1F);
}

TEST(CrgReader, TurnsWithItsHeading) {
  const CrgRoad road = parse_crg(
      [] {
        std::string bytes = text_crg();
        const std::string key = "reference_line_start_x = 10\n";
        return bytes.replace(bytes.find(key), key.size(), "reference_line_start_phi = 1.5707963267948966\n");
      }(),
      "r.crg");
  // Its u points along y, its v against x.
  EXPECT_NEAR(road.height({-0.5, 2.0, 0.0, 0.0}), 0.25, 1e-7);
}

TEST(CrgReader, FillsMissingHeightsFromTheSameCrossSection) {
  std::string bytes = text_crg();
  bytes.replace(bytes.find(" 0.5000000"), 10, "**missing*");
  const CrgRoad road = parse_crg(bytes, "r.crg");
  EXPECT_FLOAT_EQ(road.grid().z[3], 0.25F);
}

TEST(CrgReader, RefusesWhatItDoesNotReadByName) {
  const auto refusal = [](const std::string& bytes) { return why([&] { (void)parse_crg(bytes, "r.crg"); }); };
  const std::string rows = text_crg().substr(crg_header("LRFI").size());
  EXPECT_THAT(refusal(""), HasSubstr("r.crg: is no OpenCRG file"));
  EXPECT_THAT(refusal("time[s],x\n0,1\n"), HasSubstr("r.crg: is cut: the header has no end"));
  EXPECT_THAT(refusal("$$$$\n"), HasSubstr("$KD_DEFINITION"));
  EXPECT_THAT(refusal(crg_header("LQRS") + rows), HasSubstr("r.crg:14: format 'LQRS'"));
  EXPECT_THAT(refusal(crg_header("LRFI", "reference_line_end_phi = 0.1\n") + rows), HasSubstr("r.crg:12: curved"));
  EXPECT_THAT(refusal(crg_header("LRFI", "reference_line_start_s = 0.1\n") + rows),
              HasSubstr("REFERENCE_LINE_START_S"));
  EXPECT_THAT(refusal(crg_header("LRFI", "reference_line_increment = 1\n") + rows), HasSubstr("is given twice"));
  EXPECT_THAT(refusal(crg_header("LRFI", "reference_line_start_y = nan\n") + rows),
              HasSubstr("is not a finite number"));
  EXPECT_THAT(refusal(crg_header("LRFI", "", "D:reference line phi,rad\n") +
                      "**unused** 0.0000000 0.0000000 0.0000000\n 0.1000000 0.0000000 0.0000000 0.0000000\n 0.2000000 "
                      "0.0000000 0.0000000 0.0000000\n"),
              HasSubstr("reference line PHI is not constant"));
  EXPECT_THAT(refusal(crg_header("LRFI") + rows.substr(0, 40)), HasSubstr("is cut: 1 of 3 cross sections"));
  std::string bad = text_crg();
  bad.replace(bad.find(" 0.5000000"), 10, " 0.5x00000");
  EXPECT_THAT(refusal(bad), HasSubstr("'0.5x00000' of cross section 1 is not a number"));
}

TEST(CrgReader, ReadsTheRoadsOfChrono) {
  const std::filesystem::path folder = test::shared_folder() / "data/vehicle/chrono";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "needs the shared roads, which are not part of the project: " << folder.string();
  const CrgRoad bump = read_crg(folder / "halfround_4in.crg");
  EXPECT_EQ(bump.rows(), 10001U);
  double highest = 0.0;
  for (double x = 0.0; x < 100.0; x += 0.001) highest = std::max(highest, bump.height({x, 0.0, x, 0.0}));
  EXPECT_NEAR(highest, 4.0 * 0.0254, 1e-4);  // its title
  EXPECT_EQ(bump.height({49.9, 0.0, 0.0, 0.0}), 0.0);
  const CrgRoad rough = read_crg(folder / "detrended_rms_course_1in.crg");
  EXPECT_EQ(rough.rows(), 10096U);
  double squares = 0.0;
  std::size_t count = 0;
  // 304.8 m from 100 m on, as its title says; their rms by another reader (Python's struct). The 0.96944 in of the
  // title is 1.3 % more than its numbers have.
  for (; count < 6096; ++count)
    squares += std::pow(rough.height({100.0 + 0.05 * static_cast<double>(count), 1.0, 0.0, 0.0}), 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)) / 0.0254, 0.9573953, 1e-6);
}

void takes(const std::string& bytes) {
  try {
    const CrgRoad road = parse_crg(std::string(bytes.data(), bytes.size()), "fuzz");
    EXPECT_TRUE(std::isfinite(road.height({11.0, 0.3, 0.0, 0.0})));
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(CrgReader, TakesFilesThatAreCutOrDamagedAnywhere) {
  numerics::RandomStream random(3, "crg");
  for (const std::string& whole : {text_crg(), big_endian<float, std::uint32_t>("KRBI")}) {
    for (std::size_t size = 0; size < whole.size(); ++size) takes(whole.substr(0, size));
    for (int n = 0; n < 5000; ++n) {
      std::string bytes = whole;
      for (std::uint64_t k = 0; k <= random.index(3); ++k)
        bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
      takes(bytes);
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
