#include "veridyn/io/matlab/mat.hpp"

#include <matio.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using testing::shared_flight;

void expect_small(const Log& log) {
  const LogTopic* flight = log.find("flight");
  ASSERT_NE(flight, nullptr);
  EXPECT_THAT(*flight->time, ElementsAre(0.0, 0.02, 0.04));
  EXPECT_DOUBLE_EQ(flight->find("p")->value(2), 0.3);
  EXPECT_DOUBLE_EQ(flight->find("q")->value(0), -1.0);
  EXPECT_EQ(log.information.at("flight.note"), "hi");
  const LogTopic* tables = log.find("");
  ASSERT_NE(tables, nullptr);
  EXPECT_THAT(tables->find("table")->shape, ElementsAre(2U, 3U));
  EXPECT_DOUBLE_EQ(tables->find("table")->value(5), 6.0);
  const Recording recording = to_recording(log);
  EXPECT_THAT(recording.names(), ElementsAre("flight.p", "flight.q"));
}

TEST(Mat, MakesSeriesOfVectorsBesideATimeAndTablesOfTheRest) {
  expect_small(read_mat(testing::small_mat(), "small.mat"));
}

TEST(Mat, ReadsCompressedVariables) {
  const std::string plain = testing::small_mat();
  std::string packed = plain.substr(0, 128);
  std::size_t at = 128;
  while (at < plain.size()) {
    std::uint32_t size = 0;
    std::memcpy(&size, plain.data() + at + 4, 4);
    uLongf length = compressBound(size + 8);
    std::string body(length, '\0');
    ASSERT_EQ(compress(reinterpret_cast<Bytef*>(body.data()), &length,
                       reinterpret_cast<const Bytef*>(plain.data() + at), size + 8),
              Z_OK);
    body.resize(length);
    packed += testing::pack(std::uint32_t{15}, static_cast<std::uint32_t>(length)) + body;
    at += 8 + size;
  }
  expect_small(read_mat(packed, "packed.mat"));
}

/// The same variables as `small_mat`, written by matio.
void write_with_matio(const std::filesystem::path& path, mat_ft version, matio_compression compression) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(file, nullptr);
  std::size_t column[2] = {3, 1};
  std::size_t one[2] = {1, 1};
  std::size_t text[2] = {1, 2};
  std::size_t table[2] = {2, 3};
  double time[] = {0.0, 0.02, 0.04};
  double p[] = {0.1, 0.2, 0.3};
  std::int16_t q[] = {-1, 0, 7};
  char note[] = "hi";
  double numbers[] = {1, 2, 3, 4, 5, 6};
  matvar_t* fields[] = {Mat_VarCreate("time", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, column, time, 0),
                        Mat_VarCreate("p", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, column, p, 0),
                        Mat_VarCreate("q", MAT_C_INT16, MAT_T_INT16, 2, column, q, 0),
                        Mat_VarCreate("note", MAT_C_CHAR, MAT_T_UINT8, 2, text, note, 0), nullptr};
  matvar_t* flight = Mat_VarCreate("flight", MAT_C_STRUCT, MAT_T_STRUCT, 2, one, fields, 0);
  matvar_t* array = Mat_VarCreate("table", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, table, numbers, 0);
  EXPECT_EQ(Mat_VarWrite(file, flight, compression), 0);
  EXPECT_EQ(Mat_VarWrite(file, array, compression), 0);
  Mat_VarFree(flight);
  Mat_VarFree(array);
  Mat_Close(file);
}

TEST(Mat, ReadsWhatMatioWritesInAllVersions) {
  const testing::TemporaryFolder folder;
  write_with_matio(folder.path() / "5.mat", MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  expect_small(read_mat_file(folder.path() / "5.mat"));
  write_with_matio(folder.path() / "7.mat", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB);
  expect_small(read_mat_file(folder.path() / "7.mat"));
  write_with_matio(folder.path() / "73.mat", MAT_FT_MAT73, MAT_COMPRESSION_NONE);
  expect_small(read_mat_file(folder.path() / "73.mat"));
}

TEST(Mat, LosesOnlyTheVariableThatIsDamaged) {
  std::string bytes = testing::small_mat();
  bytes[128 + 8] = 0x55;  // type of the first variable's flags
  const Log log = read_mat(bytes, "x.mat");
  EXPECT_EQ(log.damage.records_lost, 1U);
  EXPECT_EQ(log.find("flight"), nullptr);
  EXPECT_NE(log.find("")->find("table"), nullptr);
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
