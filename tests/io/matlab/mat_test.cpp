#include "veridyn/io/matlab/mat.hpp"

#include <algorithm>
#include <numbers>

#include "tests/io/matlab/small_mat_log.hpp"
#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using testing::expect_small_mat;
using ::testing::HasSubstr;
using testing::message_of;
using testing::shared_flight;

TEST(Mat, MakesSeriesOfVectorsBesideATimeAndTablesOfTheRest) {
  expect_small_mat(read_mat(testing::small_mat(), "small.mat"));
}

TEST(Mat, NamesTheColumnsOfAMatrix) {
  // `table` has two rows of three columns: 1 3 5 and 2 4 6.
  const Recording made =
      to_recording(read_mat(testing::small_mat(), "small.mat", {.columns = {"p[deg/s]", "q", "V"}, .rate = 10.0}));
  EXPECT_THAT(made.names(), ElementsAre("p", "q", "V"));
  EXPECT_NEAR(made.at("p").value[1], 2.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_THAT(made.at("V").times(), ElementsAre(0.0, 0.1));
  const Recording stamped = to_recording(read_mat(testing::small_mat(), "small.mat", {.columns = {"t", "q", "V"}}));
  EXPECT_THAT(stamped.at("q").times(), ElementsAre(1.0, 2.0));
  EXPECT_EQ(message_of([] {
              (void)read_mat(testing::small_mat(), "small.mat", {.columns = {"t", "q"}});
            }),
            "small.mat: `columns` names 2 columns, and no matrices have as many: it holds table (2 x 3)");
}

/// An array of doubles as a level 5 file has it.
std::string array_of(const std::string& name, const std::vector<std::int32_t>& extents,
                     const std::vector<double>& numbers) {
  const auto element = [](std::uint32_t type, std::string data) {
    const std::string tag = testing::pack(type, static_cast<std::uint32_t>(data.size()));
    data.resize((data.size() + 7) / 8 * 8, '\0');
    return tag + data;
  };
  std::string shape, values;
  for (const std::int32_t extent : extents) shape += testing::pack(extent);
  for (const double number : numbers) values += testing::pack(number);
  return element(14, element(6, testing::pack(std::uint32_t{6}, std::uint32_t{0})) + element(5, shape) +
                         element(1, name) + element(9, values));
}

/// SIDPAC's array of so many segments: V is 100 ft/s in all, alpha the number of its segment [deg].
std::string fdata_of(const std::string& name, std::size_t segments) {
  constexpr std::size_t kRows = 4, kColumns = 90;
  std::vector<double> numbers(kRows * kColumns * segments);
  for (std::size_t s = 0; s < segments; ++s) {
    for (std::size_t row = 0; row < kRows; ++row) {
      double* const first = &numbers[s * kRows * kColumns + row];
      first[0] = 0.02 * static_cast<double>(row);
      first[kRows] = 100.0;
      first[3 * kRows] = static_cast<double>(s + 1);
      first[76 * kRows] = 174.0;
    }
  }
  std::vector<std::int32_t> extents{kRows, kColumns};
  if (segments > 1) extents.push_back(static_cast<std::int32_t>(segments));
  return array_of(name, extents, numbers);
}

// Columns as in Klein and Morelli's SIDPAC: 1 time, 2 airspeed in ft/s, 4 angle of attack in deg, 77 wing area.
TEST(Mat, KnowsTheArrayOfSidpacAndItsCopy) {
  const std::string file = testing::small_mat().substr(0, 128) + fdata_of("fdata", 1) + fdata_of("fdatao", 1);
  const Log log = read_mat(file, "sidpac.mat");
  const Recording flight = to_recording(log);
  EXPECT_THAT(flight.names(), ElementsAre("V", "alpha", "sarea"));  // zeros are what was not measured
  EXPECT_NEAR(flight.at("V").value[0], 30.48, 1e-12);
  EXPECT_NEAR(flight.at("alpha").value[0], std::numbers::pi / 180.0, 1e-15);
  EXPECT_THAT(flight.at("V").times(), ElementsAre(0.0, 0.02, 0.04, 0.06));
  EXPECT_THAT(log.damage.notes[1], HasSubstr("fdatao is not read; `variable = \"fdatao\"` in [data] takes it"));
  EXPECT_EQ(to_recording(read_mat(file, "sidpac.mat", {.variable = "fdatao"})).names(), flight.names());
  EXPECT_EQ(message_of([&] { (void)read_mat(file, "sidpac.mat", {.variable = "fdat"}); }),
            "sidpac.mat: holds no matrix 'fdat', which `variable` names (did you mean 'fdata'?): it holds fdata (4 x "
            "90), fdatao (4 x 90)");
  std::vector<std::string> names(90, "x");
  for (std::size_t i = 0; i < names.size(); ++i) names[i] += std::to_string(i);
  EXPECT_THAT(message_of([&] { (void)read_mat(file, "sidpac.mat", {.columns = names}); }),
              HasSubstr("2 matrices have as many: it holds fdata (4 x 90), fdatao (4 x 90); say which, variable = "));
}

TEST(Mat, ReadsOneSegmentOfAnArrayOfThreeDimensions) {
  const std::string file = testing::small_mat().substr(0, 128) + fdata_of("fdata", 3);
  const Log first = read_mat(file, "segments.mat");
  EXPECT_EQ(first.parts, 3U);
  EXPECT_THAT(first.damage.notes,
              ::testing::Contains("fdata has 3 segments; part 1 is read, `part = 2` in [data] takes another"));
  const Recording third = to_recording(read_mat(file, "segments.mat", {.part = 3}));
  EXPECT_NEAR(third.at("alpha").value[0], 3.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(message_of([&] { (void)read_mat(file, "segments.mat", {.part = 4}); }),
            "segments.mat: has no part 4: fdata has 3 segments");
  // Any such array, where its columns are named.
  const std::string named = testing::small_mat().substr(0, 128) + array_of("z", {2, 2, 2}, {0, 1, 5, 6, 0, 2, 7, 8});
  const Recording second =
      to_recording(read_mat(named, "z.mat", {.columns = {"t[s]", "p"}, .variable = "z", .part = 2}));
  EXPECT_THAT(second.at("p").value, ElementsAre(7.0, 8.0));
  EXPECT_THAT(second.at("p").times(), ElementsAre(0.0, 2.0));
  EXPECT_EQ(message_of([&] { (void)read_mat(named, "z.mat", {.variable = "z"}); }),
            "z.mat: z has 2 columns; name them, columns = [\"time[s]\", ...] in [data]");
  EXPECT_EQ(message_of([&] {
              (void)read_mat(named, "z.mat", {.columns = {"t", "p", "q"}, .variable = "z"});
            }),
            "z.mat: `columns` names 3 columns, z has 2");
}

TEST(Mat, SaysWhatAFileHoldsWhereNothingIsASeries) {
  const std::string small = testing::small_mat();
  const std::size_t flight = 8 + static_cast<unsigned char>(small[132]) + 256U * static_cast<unsigned char>(small[133]);
  const Log log = read_mat(small.substr(0, 128) + small.substr(128 + flight), "table.mat");
  ASSERT_EQ(log.damage.notes.size(), 1U);
  EXPECT_THAT(log.damage.notes[0], HasSubstr("the file holds table (2 x 3). Name the stamps: time = { column = "));
  EXPECT_THAT(message_of([&] { (void)read_mat(small, "small.mat", {.time_column = "clock"}); }),
              HasSubstr("small.mat: holds no vector 'clock' for the time"));
}

TEST(Mat, SaysHowToSaveAnObjectThatOnlyMatlabReads) {
  const auto element = [](std::uint32_t type, std::string data) {
    const std::string tag = testing::pack(type, static_cast<std::uint32_t>(data.size()));
    data.resize((data.size() + 7) / 8 * 8, '\0');
    return tag + data;
  };
  const std::string object = element(14, element(6, testing::pack(std::uint32_t{17}, std::uint32_t{0})) +
                                             element(1, "tt") + element(1, "MCOS") + element(1, "timetable"));
  const Log log = read_mat(testing::small_mat() + object, "tt.mat");
  EXPECT_THAT(log.damage.notes,
              ElementsAre("variable 'tt' is a timetable, which only MATLAB reads: save it as a struct, s = "
                          "table2struct(timetable2table(tt), 'ToScalar', true), or by writetimetable(tt, 'log.csv')"));
}

TEST(Mat, SaysWhatIsWrongWithAFileThatIsNone) {
  EXPECT_THAT(message_of([] { (void)read_mat(std::string(200, 'x'), "x.mat"); }),
              "x.mat: not a MATLAB file of version 5 to 7.3 (save it with '-v7'; version 4 is not read)");
}

// The CSV beside the file holds the same numbers (exported from it by others, 200 s to 585 s, six digits).
TEST(RealMat, TheFlightOfThorAgreesWithItsExport) {
  const auto path = shared_flight("umn_thor/thor_flight75_2012_10_10.mat");
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_mat_file(path);
  const LogTopic* flight = log.find("flight_data");
  ASSERT_NE(flight, nullptr);
  EXPECT_EQ(flight->size(), 34812U);
  const auto& time = *flight->time;
  const auto row = at(std::lower_bound(time.begin(), time.end(), 200.0009) - time.begin());
  // First row of the export: 200.001,1,0.0097528,-0.0051831,-0.015915,1.513,-0.19663,-9.7167,...
  EXPECT_NEAR(time[row], 200.001, 6e-4);
  EXPECT_NEAR(flight->find("p")->value(row), 0.0097528, 1e-7);
  EXPECT_NEAR(flight->find("r")->value(row), -0.015915, 1e-6);
  EXPECT_NEAR(flight->find("az")->value(row), -9.7167, 1e-4);
  EXPECT_NEAR(flight->find("aoa")->value(row), 0.080691, 1e-6);
}

TEST(RealMat, TheArduPlaneExportIsReadAsItsMessagesWithTheirUnits) {
  const auto path = shared_flight("arduplane_2013/TestLog2.mat");
  VERIDYN_NEEDS_SHARED(path);
  const Recording recording = to_recording(read_mat_file(path));
  // Rows of the exports IMU.csv, ATT.csv and GPS.csv.
  EXPECT_NEAR(recording.at("IMU.GyrX").value[0], -0.000415, 1e-6);
  EXPECT_NEAR(recording.at("IMU.AccZ").value[1], -9.58401, 1e-5);
  EXPECT_NEAR(recording.at("ATT.Yaw").value[0], 198.8 * std::numbers::pi / 180.0, 1e-9);
  EXPECT_NEAR(recording.at("GPS.Spd").times()[0], 13.341, 1e-9);
  EXPECT_NEAR(recording.at("GPS.Lat").value[1], -37.9596825 * std::numbers::pi / 180.0, 1e-9);
  EXPECT_EQ(recording.at("NTUN.Arspd").unit.name, "m/s");
}

// Facts of ../shared/data/flight/README.md.
TEST(RealMat, TheWindTunnelTablesAreThereWithTheirShapes) {
  const auto path = shared_flight("ultrastick120_windtunnel/UltraStick120_Aero.mat");
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_mat_file(path);
  EXPECT_THAT(log.find("C6_bas")->find("data")->shape, ElementsAre(16U, 13U, 6U));
  EXPECT_THAT(log.find("dC2_rud")->find("data")->shape, ElementsAre(16U, 13U, 3U, 3U, 2U));
  EXPECT_NEAR(log.find("dampder")->find("Clp")->value(0), -0.3731, 1e-4);
  EXPECT_NEAR(log.find("dampder")->find("Cmq")->value(0), -7.8542, 1e-4);
  EXPECT_THAT(log.information.at("C6_bas.dim"), HasSubstr("[alpha]x[beta]x[CD,CY,CL,Cl,Cm,Cn]"));
  EXPECT_EQ(to_recording(log).channels().size(), 0U);
}

}  // namespace
}  // namespace veridyn::io
