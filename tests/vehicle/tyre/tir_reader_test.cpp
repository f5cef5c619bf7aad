#include "veridyn/vehicle/tyre/tir_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/support/folders.hpp"
#include "tests/vehicle/tyre/refused_tir.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::message_of;
using testing::replaced;
using testing::small_tir;

TEST(TirReader, ReadsTheNumbersOfATyreInSi) {
  const TirFile file = parse_tir(small_tir(), "small");
  EXPECT_EQ(file.format, "PAC2002");
  EXPECT_EQ(file.side, TyreSide::kRight);
  EXPECT_DOUBLE_EQ(file.unloaded_radius, 0.31);
  EXPECT_DOUBLE_EQ(file.width, 0.195);
  EXPECT_DOUBLE_EQ(file.vertical_stiffness, 2.0e5);
  EXPECT_DOUBLE_EQ(file.vertical_damping, 500.0);
  EXPECT_DOUBLE_EQ(file.nominal_load, 4000.0);
  EXPECT_DOUBLE_EQ(file.tyre.range.slip_angle_max, 40.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(file.tyre.range.load_max, 9000.0);
  EXPECT_EQ(file.tyre.combined_slip, CombinedSlip::kWeighting);
  EXPECT_EQ(file.tyre.coefficients.PKY1, -18.5);
  EXPECT_EQ(file.tyre.coefficients.LMUX, 0.9);
  EXPECT_EQ(file.tyre.coefficients.LKX, 1.0);
  EXPECT_EQ(file.tyre.coefficients.PVX1, 0.0) << "what is not given is 0";
}

TEST(TirReader, NamesKeysThatItDoesNotKnow) {
  const TirFile file = parse_tir(replaced("WIDTH = 195", "WIDTH = 195\nPDQ9 = 3\nQSX1 = 0.1"), "small");
  EXPECT_THAT(file.unknown_keys, ::testing::ElementsAre("COMMENT", "PDQ9"));
  EXPECT_THAT(file.warnings, ::testing::Contains(HasSubstr("COMMENT, PDQ9")));
}

TEST(TirReader, TakesForcesApartAsTheUseModeSays) {
  EXPECT_EQ(parse_tir(replaced("USE_MODE = 4", "USE_MODE = 3"), "s").tyre.combined_slip, CombinedSlip::kNone);
  EXPECT_TRUE(parse_tir(replaced("USE_MODE = 4", "USE_MODE = -14"), "s").tyre.mirrored);
  const TirFile alone = parse_tir(replaced("USE_MODE = 4", "USE_MODE = 2"), "s");
  EXPECT_THAT(alone.warnings, ::testing::Contains(HasSubstr("USE_MODE 2")));
}

TEST(TirReader, PutsAnInflationPressureIntoTheCoefficients) {
  const TirFile file = parse_tir(replaced("WIDTH = 195", "IP = 220000\nIP_NOM = 200000\nPPY1 = -0.5\nPPY3 = 0.1"), "s");
  EXPECT_DOUBLE_EQ(file.tyre.coefficients.PKY1, -18.5 * 0.95);
  EXPECT_DOUBLE_EQ(file.tyre.coefficients.PDY1, 1.01);
  EXPECT_DOUBLE_EQ(file.tyre.coefficients.PDX1, 1.15);
}

TEST(TirReader, ReadsTheFilesOfChrono) {
  const std::filesystem::path folder = test::shared_folder() / "data/vehicle/chrono";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "needs the shared tyre files, which are not part of the project: " << folder.string();
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".tir") continue;
    ++count;
    SCOPED_TRACE(entry.path().filename().string());
    const TirFile file = read_tir(entry.path());
    EXPECT_THAT(file.unknown_keys, IsEmpty());
    EXPECT_GT(file.vertical_stiffness, 5e4);
    // Per load and radian: 5 for the truck tyre, 10 to 21 for cars.
    EXPECT_GT(file.tyre.cornering_stiffness(file.nominal_load) / file.nominal_load, 4.5);
    EXPECT_LT(file.tyre.cornering_stiffness(file.nominal_load) / file.nominal_load, 22.0);
    const double peak = file.tyre.forces(file.nominal_load, 0.0, 0.15, 0.0).Fy / file.nominal_load;
    EXPECT_GT(peak, 0.5);
    EXPECT_LT(peak, 1.2);
  }
  EXPECT_EQ(count, 5U);
  const TirFile sedan = read_tir(folder / "Sedan_Pac02Tire.tir");
  EXPECT_EQ(sedan.tyre.combined_slip, CombinedSlip::kEquivalentSlip);
  EXPECT_EQ(sedan.unloaded_radius, 0.344);
  EXPECT_EQ(sedan.tyre.coefficients.LFZO, 0.81);
  EXPECT_EQ(sedan.tyre.coefficients.PEX4, -3.7604e-5);
  EXPECT_EQ(sedan.tyre.coefficients.QHZ4, 0.059083);
  const TirFile old = read_tir(folder / "mf_185_80R14.tir");
  EXPECT_EQ(old.tyre.combined_slip, CombinedSlip::kWeighting);
  EXPECT_EQ(old.tyre.coefficients.RVY4, -9.6324e-5);
}

TEST(TirReader, RefusesFormatsAndUnitsThatItDoesNotKnow) {
  EXPECT_THAT(message_of(replaced("'PAC2002'", "'FIALA'")), HasSubstr("t.tir:10: PROPERTY_FILE_FORMAT is 'FIALA'"));
  EXPECT_THAT(message_of(replaced("'PAC2002'", "'MF-TYRE'\nFITTYP = 61")), HasSubstr("t.tir:11: FITTYP 61"));
  EXPECT_NO_THROW((void)parse_tir(replaced("'PAC2002'", "'MF-TYRE'\nFITTYP = 6"), "s"));
  EXPECT_THAT(message_of(replaced("'degrees'", "'gon'")), HasSubstr("t.tir:5: ANGLE = 'gon' is not a known unit"));
  EXPECT_THAT(message_of(replaced("'mm'", "'newton'")), HasSubstr("LENGTH: unit 'N' is a force"));
}

TEST(TirReader, RefusesATyreThatCannotBe) {
  EXPECT_THAT(message_of(replaced("PKY1 = -18.5\nPKY2 = 1.8\n", "")), HasSubstr("has no PKY1, PKY2: without them"));
  EXPECT_THAT(message_of(replaced("PKY1 = -18.5", "PKY1 = 18.5")), HasSubstr("PKY1 = 18.5 must be < 0"));
  EXPECT_THAT(message_of(replaced("FNOMIN = 4000", "FNOMIN = 0")), HasSubstr("FNOMIN = 0 must be > 0"));
  EXPECT_THAT(message_of(replaced("FZMAX = 9000", "FZMAX = 100")), HasSubstr("FZMAX = 100 must be above FZMIN = 200"));
  EXPECT_THAT(message_of(replaced("PDY2 = -0.15", "PDY2 = -1")), HasSubstr("lateral friction is"));
  EXPECT_THAT(message_of(replaced("LMUX = .9", "LMUX = -1")), HasSubstr("LMUX = -1"));
  EXPECT_THAT(message_of(replaced("= +2.0E+2", "= -2")), HasSubstr("VERTICAL_STIFFNESS"));
}

// Whatever the bytes, an answer or one line.
void takes(const std::string& text) {
  try {
    const TirFile file = parse_tir(std::string(text.data(), text.size()), "fuzz");
    EXPECT_TRUE(std::isfinite(file.tyre.forces(file.nominal_load, 0.05, 0.05, 0.01).Fy));
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(TirReader, TakesAFileThatIsCutAtAnyByte) {
  const std::string whole = small_tir();
  for (std::size_t size = 0; size < whole.size(); ++size) takes(whole.substr(0, size));
}

TEST(TirReader, TakesTenThousandFilesWithDamagedBytes) {
  numerics::RandomStream random(5, "tir");
  for (int n = 0; n < 10000; ++n) {
    std::string text = small_tir();
    for (std::uint64_t k = 0; k <= random.index(3); ++k)
      text[random.index(text.size())] = static_cast<char>(random.index(256));
    takes(text);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
