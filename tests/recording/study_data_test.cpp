#include "veridyn/recording/study_data.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/io/support.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::recording {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using ::testing::SizeIs;

class StudyData : public ::testing::Test {
 protected:
  std::filesystem::path write(const char* name, const std::string& text) const {
    write_file(folder / name, text);
    return folder / name;
  }
  [[nodiscard]] Recording read(const std::string& data) const {
    const Study study = Study::parse("[data]\n" + data, "study.toml", folder);
    const StudyTable table = study.root().table("data");
    Recording recording = read_study_data(table);
    table.finish();
    return recording;
  }
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() /
             ("veridyn_study_data_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::filesystem::path folder;
};

TEST_F(StudyData, NamesTheColumnsOfATableWithoutAHeader) {
  write("run.csv", "2024_02_11_23_59_59_900,0.1,-90\n2024_02_12_00_00_00_050,0.2,45\n");
  const Recording recording = read("file = 'run.csv'\ncolumns = ['time', 'throttle', 'steer[deg]']\n");
  EXPECT_THAT(recording.names(), ElementsAre("throttle", "steer"));
  EXPECT_THAT(recording.at("throttle").value, ElementsAre(0.1, 0.2));
  EXPECT_DOUBLE_EQ(recording.at("steer").value[1], std::numbers::pi / 4.0);
  // Counted from midnight of the first day, past the next one.
  EXPECT_NEAR(recording.at("steer").times()[0], 86399.9, 1e-9);
  EXPECT_NEAR(recording.at("steer").times()[1], 86400.05, 1e-9);
  EXPECT_EQ(recording.information.at("date"), "2024-02-11");
}

TEST_F(StudyData, SaysHowATableIsWritten) {
  write("run.txt", "Zeit speed\n0,0 1,5\n0,5 2,5\n");
  EXPECT_THAT(read("file = 'run.txt'\ndelimiter = 'blank'\ndecimal = 'comma'\n").at("speed").value,
              ElementsAre(1.5, 2.5));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.txt'\ndelimiter = 'pipe'\n"); }), HasSubstr("data.delimiter"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.txt'\ndecimal = ';'\n"); }), HasSubstr("data.decimal"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.txt'\npart = 0\n"); }),
              HasSubstr("data.part: = 0 must be from 1 to 1000000"));
  write("titled.txt", "a,b\nc,d\ntime|x\n0|1\n1|2\n");
  EXPECT_THAT(read("file = 'titled.txt'\nskip_lines = 2\ndelimiter = 'bar'\n").at("x").value, ElementsAre(1.0, 2.0));
  EXPECT_THAT(message_of([&] { (void)read("file = 'titled.txt'\nskip_lines = 9\n"); }),
              HasSubstr("titled.txt: has only 5 lines, skip_lines leaves nothing of it"));
  std::string twice = "time,x\n";
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 10 + k; ++i) twice += std::to_string(0.1 * i) + "," + std::to_string(k) + "\n";
  write("twice.csv", twice);
  EXPECT_EQ(read("file = 'twice.csv'\npart = 1\n").at("x").size(), 10U);
  EXPECT_EQ(read("file = 'twice.csv'\n").at("x").size(), 11U);
}

TEST_F(StudyData, RefusesColumnsThatTheTableDoesNotHave) {
  write("run.csv", "0,1,2\n1,1,2\n");
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ncolumns = ['time', 'a']\n"); }),
              HasSubstr("run.csv:1: more cells than the 2 of `columns`"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ncolumns = ['time', 'a', 'b', 'c']\n"); }),
              HasSubstr("run.csv:1: 3 cells, `columns` has 4"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ncolumns = ['time', 'a[parsec]', 'b']\n"); }),
              HasSubstr("column 'a'"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ncolumns = ['time', 'a', 'a']\n"); }),
              HasSubstr("column 'a' appears twice"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\n"); }), HasSubstr("no time column found among column_1"));
}

TEST_F(StudyData, TakesTheTimeFromWhereTheStudySaysItIs) {
  write("run.csv", "clock,x\n0,1\n500,2\n");
  EXPECT_THAT(*read("file = 'run.csv'\ntime = { column = 'clock', unit = 'ms' }\n").at("x").time,
              ElementsAre(0.0, 0.5));
  EXPECT_THAT(*read("file = 'run.csv'\ntime.run = { column = 'clock', unit = 'ms' }\n").at("x").time,
              ElementsAre(0.0, 0.5));
  const Recording made = read("file = 'run.csv'\ntime = { rate = '10 Hz' }\n");
  EXPECT_THAT(made.names(), ElementsAre("clock", "x"));
  EXPECT_THAT(*made.at("x").time, ElementsAre(0.0, 0.1));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ntime = { rate = 0 }\n"); }), HasSubstr("must be > 0"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ntime = { rate = 1, column = 'clock' }\n"); }),
              HasSubstr("without stamps"));
  EXPECT_THAT(message_of([&] { (void)read("file = 'run.csv'\ntime = { colum = 'clock' }\n"); }), HasSubstr("colum"));
}

TEST_F(StudyData, ReadsTheDriveLogsOfOthers) {
  const std::filesystem::path logs = test::shared_folder() / "data/vehicle";
  VERIDYN_NEEDS_SHARED(logs);
  const std::string hunter = (logs / "hunter_se_1to5/onroad_skidpad_30_hz_ccw_clean_t_0_8_s_0_3142.csv").string();
  const Recording car = read("file = '" + hunter +
                             "'\ncolumns = ['time', 'throttle', 'steer[rad]', 'ticks_l', 'ticks_r', 'x[m]', 'y[m]', "
                             "'z[m]', 'roll[rad]', 'pitch[rad]', 'yaw[rad]', 'speed[m/s]', 'p[rad/s]', 'q[rad/s]', "
                             "'r[rad/s]', 'ax[m/s^2]', 'ay[m/s^2]', 'az[m/s^2]']\n");
  EXPECT_EQ(car.names().size(), 17U);
  EXPECT_EQ(car.at("steer").size(), 2479U);  // wc -l
  EXPECT_NEAR(car.span().end - car.span().begin, 90.1, 0.1);
  const Recording phone = read("file = '" + (logs / "kalman_balzer82/2016-09-12-Leaning.csv").string() + "'\n");
  EXPECT_EQ(phone.information.at("date"), "2016-09-12");
  EXPECT_EQ(phone.at("gyroRotationX").size(), 730U);  // cells that are not empty
  const Recording drive = read("file = '" + (logs / "kalman_balzer82/2014-03-26-000-Data.csv").string() + "'\n");
  EXPECT_EQ(drive.information.at("date"), "2014-03-26");
  // 12:38:25.119 of the clock `millis`, which is UTC.
  EXPECT_NEAR(drive.span().begin, 45505.119, 1e-3);
  const Recording path =
      read("file = '" + (logs / "cpm_lab/test_trajectory.csv").string() + "'\ntime = { unit = 'ns' }\n");
  EXPECT_NEAR(path.span().end, 29.75, 1e-9);
  const Recording points =
      read("file = '" + (logs / "cpm_lab/calibration_points.csv").string() + "'\ntime = { rate = 1 }\n");
  EXPECT_EQ(points.at("image_x").size(), 1716U);
}

TEST_F(StudyData, DescribesPacketsOfItsOwn) {
  std::string bytes;
  for (int k = 0; k < 40; ++k) {
    const float time = 0.05F * static_cast<float>(k), right = 0.3F;
    std::string packet = "RIG1" + std::string(8, '\0');
    std::memcpy(packet.data() + 4, &time, 4);
    std::memcpy(packet.data() + 8, &right, 4);
    bytes += packet;
  }
  write("rig.raw", bytes);
  const std::string packet =
      "[data.packet]\nsize = 12\nbegins_with = 'RIG1'\n[[data.packet.field]]\nname = "
      "'time'\noffset = 4\nunit = 's'\n[[data.packet.field]]\nname = 'accel_y'\noffset = 8\nunit "
      "= 'g'\nfactor = -1\n";
  const Recording rig = read("file = 'rig.raw'\n" + packet);
  EXPECT_EQ(rig.frame, Frame::kFlu);
  EXPECT_NEAR(rig.at("accel_y").value[20], -0.3 * kGravity, 1e-6);
  EXPECT_NEAR(rig.at("accel_y").times()[20], 1.0, 1e-6);
  EXPECT_THAT(why([&] { static_cast<void>(read("file = 'rig.raw'\n")); }), HasSubstr("rig.raw: not a known log"));
  EXPECT_THAT(why([&] { static_cast<void>(read("file = 'rig.raw'\npacket = 'outsim'\n")); }),
              HasSubstr("rig.raw: holds 0 usable packets of a drive"));
  EXPECT_THAT(why([&] { static_cast<void>(read("file = 'rig.raw'\npacket = 'outsin'\n")); }),
              HasSubstr("study.toml:3: data.packet: = 'outsin' is not one of outsim, "));
}

TEST_F(StudyData, HasItsKeysCheckedWithoutAFile) {
  const std::vector<StandardChannel> standard{{"yaw_rate", "rad/s"}, {"steer", "rad"}};
  const auto check = [&](const std::string& data) {
    return why([&] {
      const Study study = Study::parse("[data]\n" + data, "study.toml", folder);
      check_study_data(study.root().table("data"), standard);
      study.root().finish();
    });
  };
  EXPECT_EQ(check("files = ['IMU.csv', 'GPS.csv']\nfrom = '1 s'\nto = 9\ncolumns = ['t', 'yaw_rate']\n"
                  "[data.time]\nunit = 'ms'\nGPS = { column = 'T', unit = 'ms' }\n"
                  "[data.map]\nsteer = 'none'\nyaw_rate = { channel = 'r', zero = 1, scale = 2, unit = 'deg/s', "
                  "delay = '5 ms' }\n"),
            "nothing was refused");
  EXPECT_EQ(check("[data.map]\nsteer = { switch = 'mode', cases = { 1 = 'a', 2 = 'b' } }\n"
                  "yaw_rate = { channels = ['a', 'b'], weights = [1, 2] }\n"),
            "nothing was refused");
  EXPECT_THAT(check("fil = 'x.csv'\n"), HasSubstr("study.toml:2: data.fil: unknown key (did you mean 'file'?)"));
  EXPECT_THAT(check("frm = 3\n"), HasSubstr("data.frm: unknown key (did you mean 'from'?)"));
  EXPECT_THAT(check("time = { colum = 'T' }\n"), HasSubstr("data.time.colum: unknown key (did you mean 'column'?)"));
  EXPECT_THAT(check("file = 'GPS.csv'\n[data.time]\nGPS = { uni = 'ms' }\n"), HasSubstr("data.time.GPS.uni: unknown"));
  EXPECT_THAT(check("[data.map]\nyaw_rat = 'r'\n"), HasSubstr("is not a standard channel (did you mean 'yaw_rate'?)"));
  EXPECT_THAT(check("[data.map]\nsteer = { chanel = 'x' }\n"), HasSubstr("(did you mean 'channel'?)"));
  EXPECT_THAT(check("from = 'noon'\n"), HasSubstr("is not a number with a unit"));
}

/// All that `[data]` names.
std::vector<StudyRecording> recordings_of(const std::string& data, const std::filesystem::path& folder) {
  const Study study = Study::parse("[data]\n" + data, "study.toml", folder);
  const StudyTable table = study.root().table("data");
  std::vector<StudyRecording> runs = read_study_recordings(table);
  table.finish();
  return runs;
}

TEST_F(StudyData, ReadsEveryRunByItself) {
  write("a.csv", "time,v\n0,1\n1,2\n2,3\n");
  write("b.csv", "T,v\n0,10\n1000,20\n2000,30\n");
  write("c.csv", "time,v\n0,7\n1,8\n");
  const std::vector<StudyRecording> runs = recordings_of(
      "runs = ['a.csv']\nholdout_runs = ['c.csv']\n[[data.run]]\nfile = 'b.csv'\nfrom = 0.5\n"
      "time = { column = 'T', unit = 'ms' }\nholdout = false\n",
      folder);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[0].name, "a.csv");
  EXPECT_EQ(runs[1].name, "b.csv");
  EXPECT_EQ(runs[2].name, "c.csv");
  EXPECT_THAT(runs[1].recording.at("v").value, ElementsAre(20.0, 30.0)) << "from 0.5 s on its own clock";
  EXPECT_THAT(runs[1].recording.at("v").times(), ElementsAre(1.0, 2.0));
  EXPECT_FALSE(runs[1].held_out);
  EXPECT_TRUE(runs[2].held_out);
  EXPECT_EQ(runs[2].recording.source, (folder / "c.csv").string());
}

TEST_F(StudyData, CallsPartsOfOneFileByWhereTheyBegin) {
  write("a.csv", "time,v\n0,1\n1,2\n2,3\n3,4\n");
  const std::vector<StudyRecording> runs = recordings_of(
      "[[data.run]]\nfile = 'a.csv'\nfrom = 0\nto = 1\n[[data.run]]\nfile = 'a.csv'\nfrom = 2\nto = 3\n", folder);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].name, "a.csv from 0 s");
  EXPECT_EQ(runs[1].name, "a.csv from 2 s");
}

/// A table of two flights whose clock restarts: 30 rows of 1, then 20 rows of 2.
std::string restarting_table() {
  std::string text = "time,v\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("{},{}\n", 0.5 * (i < 30 ? i : i - 30), i < 30 ? 1 : 2);
  return text;
}

TEST_F(StudyData, ReadsOnePartOfATableOrAFolderWhoseClockRestarts) {
  write("a.csv", restarting_table());
  std::filesystem::create_directories(folder / "log");
  write("log/IMU.csv", restarting_table());
  write("log/GPS.csv", restarting_table());
  EXPECT_THAT(read("file = 'a.csv'\n").at("v").value, Each(1.0)) << "the longest";
  EXPECT_THAT(read("file = 'a.csv'\npart = 2\n").at("v").value, AllOf(SizeIs(20), Each(2.0)));
  EXPECT_THAT(message_of([&] { (void)read("file = 'a.csv'\npart = 3\n"); }), HasSubstr("a.csv: has no part 3"));
  const Recording both = read("file = 'log'\npart = 2\n");
  EXPECT_THAT(both.at("IMU.v").value, AllOf(SizeIs(20), Each(2.0)));
  EXPECT_THAT(both.at("GPS.v").value, AllOf(SizeIs(20), Each(2.0)));
}

TEST_F(StudyData, CallsPartsOfOneFileByTheirNumbers) {
  write("a.csv", restarting_table());
  const std::vector<StudyRecording> runs = recordings_of(
      "[[data.run]]\nfile = 'a.csv'\npart = 1\n[[data.run]]\nfile = 'a.csv'\npart = 2\nholdout = true\n", folder);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].name, "a.csv part 1");
  EXPECT_EQ(runs[1].name, "a.csv part 2");
  EXPECT_THAT(runs[1].recording.at("v").value, AllOf(SizeIs(20), Each(2.0)));
}

TEST_F(StudyData, OfOneFileIsOneRecordingWithoutAName) {
  write("a.csv", "time,v\n0,1\n1,2\n");
  for (const char* data : {"file = 'a.csv'\n", "runs = ['a.csv']\n"}) {
    const std::vector<StudyRecording> runs = recordings_of(data, folder);
    ASSERT_EQ(runs.size(), 1U) << data;
    EXPECT_EQ(runs[0].name, "") << data;
    EXPECT_THAT(runs[0].recording.at("v").value, ElementsAre(1.0, 2.0)) << data;
  }
}

TEST_F(StudyData, RefusesRunsThatMakeNoSenseByFileAndKey) {
  write("a.csv", "time,v\n0,1\n1,2\n");
  write("b.csv", "time,v\n0,1\n1,2\n");
  const auto refusal = [&](const std::string& data) { return message_of([&] { (void)recordings_of(data, folder); }); };
  EXPECT_THAT(refusal("runs = ['a.csv', 'b.csv']\nfrom = 1\n"),
              HasSubstr("study.toml:3: data.from: is of one recording"));
  EXPECT_THAT(refusal("file = 'a.csv'\nruns = ['b.csv']\n"), HasSubstr("study.toml:2: data.file: is of one recording"));
  EXPECT_THAT(refusal("runs = []\n"), HasSubstr("study.toml:2: data.runs: is empty"));
  EXPECT_THAT(refusal("runs = ['a.csv', 'a.csv']\n"), HasSubstr("data.runs: names"));
  EXPECT_THAT(refusal("holdout_runs = ['a.csv', 'b.csv']\n"),
              HasSubstr("data.holdout_runs: leaves no recording to identify from"));
  EXPECT_THAT(refusal("[[data.run]]\nfrom = 1\n"), HasSubstr("data.run[0].file: is missing"));
  EXPECT_THAT(refusal("[[data.run]]\nfile = 'a.csv'\nfrom = 5\n"), HasSubstr("a.csv: holds nothing from 5 s"));
  EXPECT_THAT(refusal("runs = ['a.csv', 'none.csv']\n"), HasSubstr("none.csv"));
  EXPECT_THAT(refusal("[[data.run]]\nfile = 'a.csv'\nhold_out = true\n"), HasSubstr("hold_out"));
}

}  // namespace
}  // namespace veridyn::recording
