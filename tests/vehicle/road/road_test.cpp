#include "veridyn/vehicle/road/road.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/vehicle/road/crg_reader.hpp"
#include "veridyn/vehicle/road/iso8608_road.hpp"
#include "veridyn/vehicle/road/obstacle_road.hpp"
#include "veridyn/vehicle/road/profile_road.hpp"
#include "veridyn/vehicle/road/road_study.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::HasSubstr;

template <typename Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

RoadPoint at(double distance, double offset = 0.75) { return {distance, offset, distance, offset}; }

// ---- obstacles

TEST(ObstacleRoad, HasTheShapesItSays) {
  const ObstacleRoad step({Obstacle::Shape::kStep, 10.0, 0.08, 0.4});
  EXPECT_EQ(step.height(at(9.999)), 0.0);
  EXPECT_NEAR(step.height(at(10.2)), 0.04, 1e-15);
  EXPECT_NEAR(step.height(at(10.1)), 0.04 * (1.0 - std::sqrt(0.5)), 1e-15);
  EXPECT_EQ(step.height(at(50.0)), 0.08);
  const ObstacleRoad edge({Obstacle::Shape::kStep, 10.0, -0.08});
  EXPECT_EQ(edge.height(at(9.999999)), 0.0);
  EXPECT_EQ(edge.height(at(10.0)), -0.08);
  const ObstacleRoad ramp({Obstacle::Shape::kRamp, 5.0, 1.0, 20.0});
  EXPECT_NEAR(ramp.height(at(10.0)), 0.25, 1e-15);
  EXPECT_EQ(ramp.height(at(100.0)), 1.0);
  const ObstacleRoad bump({Obstacle::Shape::kBump, 5.0, 0.1, 2.0});
  EXPECT_NEAR(bump.height(at(6.0)), 0.1, 1e-15);
  EXPECT_NEAR(bump.height(at(5.5)), 0.05, 1e-15);
  EXPECT_EQ(bump.height(at(7.0)), 0.0);
  const ObstacleRoad plank({Obstacle::Shape::kPlank, 5.0, 0.1, 2.0});
  EXPECT_EQ(plank.height(at(5.0)), 0.1);
  EXPECT_EQ(plank.height(at(7.0)), 0.0);
}

TEST(ObstacleRoad, MayLieUnderOneSide) {
  const ObstacleRoad left({Obstacle::Shape::kStep, 1.0, 0.1, 0.0, Obstacle::Side::kLeft});
  EXPECT_EQ(left.height(at(2.0, 0.7)), 0.1);
  EXPECT_EQ(left.height(at(2.0, -0.7)), 0.0);
  const ObstacleRoad right({Obstacle::Shape::kStep, 1.0, 0.1, 0.0, Obstacle::Side::kRight});
  EXPECT_EQ(right.height(at(2.0, 0.7)), 0.0);
  EXPECT_EQ(right.height(at(2.0, -0.7)), 0.1);
}

// ---- ISO 8608

/// One-sided spectra by Welch's method: Hann windows of `window` samples, half overlapped, without reference to how the
/// road was made.
struct Welch {
  std::vector<double> wave_number, left, right;
  std::vector<std::complex<double>> cross;

  Welch(const Road& road, double from, double length, double step, std::size_t window) {
    Eigen::FFT<double> fft;
    std::vector<double> shape(window);
    double power = 0.0;
    for (std::size_t i = 0; i < window; ++i) {
      shape[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(window));
      power += shape[i] * shape[i];
    }
    const std::size_t bins = window / 2;
    left.assign(bins, 0.0);
    right.assign(bins, 0.0);
    cross.assign(bins, 0.0);
    double segments = 0.0;
    const double extent = step * static_cast<double>(window);
    for (double start = from; start + extent <= from + length; start += 0.5 * extent) {
      std::vector<double> a(window), b(window);
      for (std::size_t i = 0; i < window; ++i) {
        const double x = start + step * static_cast<double>(i);
        a[i] = shape[i] * road.height(at(x, 0.75));
        b[i] = shape[i] * road.height(at(x, -0.75));
      }
      std::vector<std::complex<double>> A, B;
      fft.fwd(A, a);
      fft.fwd(B, b);
      for (std::size_t k = 0; k < bins; ++k) {
        left[k] += std::norm(A[k]) * 2.0 * step / power;
        right[k] += std::norm(B[k]) * 2.0 * step / power;
        cross[k] += std::conj(A[k]) * B[k] * 2.0 * step / power;
      }
      segments += 1.0;
    }
    for (std::size_t k = 0; k < bins; ++k) {
      wave_number.push_back(static_cast<double>(k) / extent);
      left[k] /= segments;
      right[k] /= segments;
      cross[k] /= segments;
    }
  }

  template <typename Value, typename Result = typename Value::value_type>
  Result mean(const Value& values, double low, double high) const {
    Result sum{};
    double count = 0.0;
    for (std::size_t k = 0; k < wave_number.size(); ++k) {
      if (wave_number[k] < low || wave_number[k] >= high) continue;
      sum += values[k];
      count += 1.0;
    }
    return sum / count;
  }
};

TEST(Iso8608Road, HasTheRoughnessOfItsClass) {
  EXPECT_DOUBLE_EQ(iso8608_roughness('A'), 16e-6);
  EXPECT_DOUBLE_EQ(iso8608_roughness('D'), 1024e-6);
  EXPECT_DOUBLE_EQ(iso8608_roughness('H'), 262144e-6);
  EXPECT_THAT(message_of([] { (void)iso8608_roughness('I'); }), HasSubstr("'I' is not one of A"));
}

TEST(Iso8608Road, HasTheDensityOfTheStandardByAnEstimateOfItsOwn) {
  for (const double waviness : {2.0, 2.5}) {
    Iso8608Options options;
    options.roughness = iso8608_roughness('B');
    options.waviness = waviness;
    options.length = 5000.0;
    options.seed = 42;
    const Iso8608Road road(options);
    const Welch welch(road, 20.0, road.period(), 0.0437, 4096);
    for (double low = 0.04; low < 2.0; low *= std::sqrt(2.0)) {
      const double high = low * std::sqrt(2.0);
      // Mean of G0 (n/n0)^-w over the band.
      const double p = 1.0 - waviness;
      const double expected =
          64e-6 * std::pow(0.1, waviness) * (std::pow(high, p) - std::pow(low, p)) / p / (high - low);
      // Some 60 windows of 179 m, at least three lines a band: 180 values of two degrees of freedom, 7 %, less where
      // the waves are so many that they average; window and band edges some per cent at the steep low end.
      EXPECT_NEAR(welch.mean(welch.left, low, high) / expected, 1.0, 0.12) << low;
      EXPECT_NEAR(welch.mean(welch.right, low, high) / expected, 1.0, 0.12) << low;
    }
    EXPECT_LT(welch.mean(welch.left, 3.2, 8.0), 1e-4 * 64e-6 * std::pow(30.0, -waviness)) << "nothing above the band";
  }
}

TEST(Iso8608Road, HasTheVarianceOfItsBand) {
  Iso8608Options options;
  options.fade_in = 0.0;
  const Iso8608Road road(options);
  double sum = 0.0, squares = 0.0;
  const std::size_t count = 100000;
  const double period = road.period();
  for (std::size_t i = 0; i < count; ++i) {
    const double z = road.height(at(period * (1.0 + static_cast<double>(i) / static_cast<double>(count))));
    sum += z;
    squares += z * z;
  }
  // The integral of the density: G0 n0^2 (1/low - 1/high); interpolation loses 1e-5 of it.
  const double variance = 256e-6 * 0.01 * (1.0 / 0.011 - 1.0 / 2.83);
  EXPECT_NEAR(sum / static_cast<double>(count), 0.0, 1e-9);
  EXPECT_NEAR(squares / static_cast<double>(count) / variance, 1.0, 1e-4);
}

TEST(Iso8608Road, HasTheCoherenceItStates) {
  Iso8608Options options;
  options.length = 5000.0;
  const Iso8608Road road(options);
  const Welch welch(road, 20.0, road.period(), 0.0437, 4096);
  for (const auto& [low, high] : {std::pair{0.03, 0.06}, {0.08, 0.12}, {0.15, 0.25}, {0.3, 0.5}, {0.8, 2.0}}) {
    const double n = std::sqrt(low * high);
    const std::complex<double> cross = welch.mean(welch.cross, low, high);
    const double power = std::sqrt(welch.mean(welch.left, low, high) * welch.mean(welch.right, low, high));
    EXPECT_NEAR(cross.real() / power, std::exp(-4.0 * n), 0.07) << n;
    EXPECT_NEAR(cross.imag() / power, 0.0, 0.09) << n;
  }
  options.coherence_length = 0.0;
  const Iso8608Road equal(options);
  EXPECT_EQ(equal.height(at(123.4, 0.7)), equal.height(at(123.4, -0.7)));
}

TEST(Iso8608Road, ComesFromItsSeedAndGrowsFromALevelRoad) {
  Iso8608Options options;
  const Iso8608Road one(options), same(options);
  options.seed = 2;
  const Iso8608Road other(options);
  EXPECT_EQ(one.height(at(321.0)), same.height(at(321.0)));
  EXPECT_NE(one.height(at(321.0)), other.height(at(321.0)));
  EXPECT_EQ(one.height(at(0.0)), 0.0);
  EXPECT_EQ(one.height(at(-3.0)), 0.0);
  EXPECT_LT(std::abs(one.height(at(0.1))), 1e-4);
  const double p = one.period();
  EXPECT_NEAR(one.height(at(77.0)), one.height(at(77.0 + p)), 1e-12);
  EXPECT_NEAR(0.5 * (one.height(at(50.0, 1.0)) + one.height(at(50.0, -1.0))), one.height(at(50.0, 0.0)), 1e-16);
}

TEST(Iso8608Road, RefusesWhatIsNoRoad) {
  const auto refuse = [](auto change) {
    Iso8608Options options;
    change(options);
    return message_of([&] { (void)Iso8608Road(options); });
  };
  EXPECT_THAT(refuse([](auto& o) { o.roughness = std::nan(""); }), HasSubstr("roughness = nan must be"));
  EXPECT_THAT(refuse([](auto& o) { o.length = 1e9; }), HasSubstr("length"));
  EXPECT_THAT(refuse([](auto& o) { o.high = 0.001; }), HasSubstr("high"));
  EXPECT_THAT(refuse([](auto& o) { o.coherence_length = -1.0; }), HasSubstr("coherence_length"));
  EXPECT_THAT(refuse([](auto& o) { o.length = 50.0; }), HasSubstr("longest wave"));
}

// ---- profiles

TEST(ProfileRoad, IsStraightBetweenItsPointsAndLevelBeyond) {
  for (const double bend : {0.0, 0.3}) {  // evenly spaced, and not
    const ProfileRoad road({1.0, 2.0 + bend, 3.0}, {0.0, 0.1, 0.3}, {0.0, -0.1, 0.5});
    EXPECT_EQ(road.height(at(0.0, 1.0)), 0.0);
    EXPECT_EQ(road.height(at(9.0, 1.0)), 0.3);
    EXPECT_EQ(road.height(at(9.0, -1.0)), 0.5);
    EXPECT_NEAR(road.height(at(1.0 + 0.5 * (1.0 + bend), 1.0)), 0.05, 1e-15);
    EXPECT_NEAR(road.height(at(2.0 + bend, -1.0)), -0.1, 1e-15);
    EXPECT_NEAR(road.height(at(2.0 + bend, 0.0)), 0.0, 1e-15);
  }
}

TEST(ProfileRoad, ReadsATable) {
  const ProfileRoad both = profile_road(io::parse_table("distance[m],height[cm]\n0,0\n1,5\n", "p.csv"));
  EXPECT_DOUBLE_EQ(both.height(at(0.5)), 0.025);
  const ProfileRoad sides = profile_road(io::parse_table("right[m],distance[m],left[m]\n0,0,1\n0,1,1\n", "p.csv"));
  EXPECT_EQ(sides.height(at(0.5, 1.0)), 1.0);
  EXPECT_EQ(sides.height(at(0.5, -1.0)), 0.0);
  const auto refusal = [](const char* text) {
    return message_of([&] { (void)profile_road(io::parse_table(text, "p.csv")); });
  };
  EXPECT_THAT(refusal("distance[m],left[m]\n0,0\n1,0\n"), HasSubstr("p.csv: has no column 'right'"));
  EXPECT_THAT(refusal("distance[s],height[m]\n0,0\n1,0\n"), HasSubstr("column 'distance' is in [s]"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n0,0\n"), HasSubstr("distance of row 1 is 0; must be more than"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n1,\n"), HasSubstr("left height of row 1 is nan"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n"), HasSubstr("has 1 points"));
}

// ---- OpenCRG

std::string crg_header(const std::string& format, const std::string& more_keys = "", const std::string& more = "") {
  return "$CT ! comment\nany text = with signs $ and !\n$\n$ROAD_CRG\n"
         "reference_line_start_u = 0.0\nreference_line_end_u = 4.0 ! [m]\nREFERENCE_LINE_INCREMENT = 2.0\n"
         "* a comment\nlong_section_v_right = -1\nlong_section_v_increment = 1.5\nreference_line_start_x = 10\n" +
         more_keys + "$\n$KD_Definition\n#:" + format + "\nU:reference line u,m,0.0,2.0\n" + more +
         "D:long section 1,m\nD:long section 2,m\nD:long section 3,m\n$\n$$$$$$$$\n";
}

// z(u, v) row by row from right to left.
constexpr std::array<double, 9> kHeights{0.0, 0.1, 0.2, 0.5, 0.25, 0.125, -1.0, -2.0, 3.0};

template <typename Real, typename Bits>
std::string big_endian(const std::string& format) {
  std::string bytes = crg_header(format);
  for (const double z : kHeights) {
    const Bits bits = std::bit_cast<Bits>(static_cast<Real>(z));
    for (std::size_t k = sizeof(Bits); k-- > 0;) bytes += static_cast<char>(bits >> (8 * k) & 0xff);
  }
  for (std::size_t i = 0; i < 11 * sizeof(Bits); ++i) bytes += '\x7f';  // padding: NaN
  return bytes;
}

std::string text_crg() {
  return crg_header("LRFI") + " 0.0000000 0.1000000 0.2000000\n" + " 0.5000000 0.2500000 0.1250000\n" +
         "-1.0000000-2.0000000 3.0000000\n";
}

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
  const auto refusal = [](const std::string& bytes) { return message_of([&] { (void)parse_crg(bytes, "r.crg"); }); };
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
  // 304.8 m from 100 m on, as its title says; their rms by another reader (Python's struct). The title's own 0.96944 in
  // is 1.3 % more than its numbers have.
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

// ---- studies

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
    return message_of([&] { (void)read(text); });
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
  // From the study's seed, unless the road has its own.
  EXPECT_EQ(read("kind = 'iso8608'\nclass = 'D'\n")->height(at(40.0)),
            read("kind = 'iso8608'\nroughness = 1024e-6\nseed = 5\n")->height(at(40.0)));
  EXPECT_NE(read("kind = 'iso8608'\n")->height(at(40.0)), read("kind = 'iso8608'\nseed = 6\n")->height(at(40.0)));
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "veridyn_road_study";
  std::filesystem::create_directories(folder);
  write_file(folder / "p.csv", "distance[m],height[m]\n0,0\n10,1\n");
  write_file(folder / "r.crg", text_crg());
  EXPECT_DOUBLE_EQ(read("kind = 'file'\nfile = 'p.csv'\n", folder)->height(at(5.0)), 0.5);
  EXPECT_FLOAT_EQ(static_cast<float>(read("kind = 'file'\nfile = 'r.crg'\n", folder)->height({12.0, 0.5, 0.0, 0.0})),
                  0.25F);
  std::filesystem::remove_all(folder);
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
