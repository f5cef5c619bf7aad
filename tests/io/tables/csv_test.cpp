#include "veridyn/io/tables/csv.hpp"

#include <cmath>
#include <numbers>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using testing::shared_flight;

Recording read(std::string_view text, const TableOptions& options = {}) {
  return to_recording(read_csv(text, "a.csv", options));
}

std::string refusal(std::string_view text, const TableOptions& options = {}) {
  return message_of([&] { (void)read_csv(text, "a.csv", options); });
}

TEST(Csv, ReadsOurOwnFilesWithUnitsFrameAndMissingSamples) {
  const Recording recording = read(testing::small_csv());
  EXPECT_EQ(recording.frame, Frame::kFrd);
  EXPECT_THAT(recording.names(), ElementsAre("roll", "airspeed", "odd, name"));
  EXPECT_NEAR(recording.at("roll").value[2], 30.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_TRUE(std::isnan(recording.at("airspeed").value[1]));
  EXPECT_TRUE(std::isnan(recording.at("airspeed").value[2]));
  EXPECT_DOUBLE_EQ(recording.at("airspeed").value[3], 12.5);
  EXPECT_THAT(*recording.at("roll").time, ElementsAre(0.0, 0.02, 0.04, 0.06));
}

TEST(Csv, FindsTheTimeOfForeignFilesByItsName) {
  EXPECT_THAT(*read("t_s,x\n0.5,1\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("x,TimeMS\n1,500\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("TimeUS,x\n500000,1\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("timestamp,x\n500000,1\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("timestamp,x\n0.5,1\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("time_boot[ms],x\n500,1\n").at("x").time, ElementsAre(0.5));
  EXPECT_THAT(*read("Status,TimeMS,Week,T\n3,511214500,1768,500\n").at("Week").time, ElementsAre(0.5));
  EXPECT_THAT(*read("a,b\n1,30\n", {.time_column = "b", .time_unit = "min"}).at("a").time, ElementsAre(1800.0));
}

TEST(Csv, TakesForeignHabits) {
  const Recording recording = read(
      "\xEF\xBB\xBFtime;mode;control[0];Roll[deg];flag;\r\n"
      "0;\"AUTO; fast\";+1.5;180;true;\r\n"
      "\r\n"
      "1;MANUAL;NaN;-90;false;\r\n");
  EXPECT_THAT(recording.names(), ElementsAre("control[0]", "Roll", "flag"));
  EXPECT_DOUBLE_EQ(recording.at("control[0]").value[0], 1.5);
  EXPECT_NEAR(recording.at("Roll").value[0], std::numbers::pi, 1e-15);
  EXPECT_DOUBLE_EQ(recording.at("flag").value[0], 1.0);
}

std::vector<std::string> notes_of(std::string_view text, const TableOptions& options = {}) {
  return read(text, options).warnings;
}

TEST(Csv, ReadsBlankSeparatedColumns) {
  const Recording recording = read("Time (s)   p (deg/s)  V\n 0.0  180   20\n 0.5\t-90   21  \n");
  EXPECT_THAT(recording.names(), ElementsAre("p", "V"));
  EXPECT_NEAR(recording.at("p").value[0], std::numbers::pi, 1e-15);
  EXPECT_THAT(*recording.at("V").time, ElementsAre(0.0, 0.5));
  EXPECT_THAT(recording.at("V").value, ElementsAre(20.0, 21.0));
}

TEST(Csv, TakesAHeaderFromTheLastCommentThatFits) {
  const Recording numpy = read("# flight: 12\n# t p V\n0.0 0.1 20\n0.5 0.2 21\n");
  EXPECT_THAT(numpy.names(), ElementsAre("p", "V"));
  EXPECT_EQ(numpy.information.at("flight"), "12");
  const Recording matlab = read("% time (s), Pitch (deg), V (kt)\n0,180,1\n% a remark\n1,90,1\n");
  EXPECT_NEAR(matlab.at("Pitch").value[1], std::numbers::pi / 2.0, 1e-15);
  EXPECT_EQ(refusal("\"\n0 1\n", {.delimiter = ' '}), "a.csv:1: column 1: has no name");
  // A comment of another length is no header.
  EXPECT_EQ(refusal("# t p\n0,1,2\n").substr(0, 29), "a.csv:2: no time column found");
}

TEST(Csv, TakesUnitsFromARowOfTheirOwn) {
  const Recording recording = read("time,Speed,Note,flag\ns,km/h,,-\n0,36,a,1\n1,72,b,0\n");
  EXPECT_THAT(recording.at("Speed").value, ElementsAre(10.0, 20.0));
  EXPECT_EQ(recording.at("Speed").unit.name, "m/s");
  EXPECT_EQ(refusal("time,mode\n0,s\n0,x,1\n"), "a.csv:3: more cells than the 2 of the header");
}

// Columns as Garmin's G1000 logs them; a header of its log stands in datui's documentation and others' converters.
TEST(Csv, ReadsAGarminLogWithUnitsInACommentAndRowsBeforeItsClockIsSet) {
  const char* text =
      "#airframe_info, log_version=\"1.00\", airframe_name=\"Cessna 172S\",\n"
      "#yyy-mm-dd, hh:mm:ss,   hh:mm,  ident,      degrees, ft Baro,  inch,     kt,    deg,      G,    rpm, enum\n"
      "  Lcl Date, Lcl Time, UTCOfst, AtvWpt,     Latitude,    AltB, BaroA,    IAS,  Pitch, NormAc, E1 RPM, HSIS\n"
      "          ,         ,        ,       ,             ,        ,      ,       ,   1.00,       ,       ,     \n"
      "2026-09-02, 23:59:59,  -07:00,   KPDX,    45.500000,  1000.0, 29.92,  100.0,   2.00,   0.50, 2400.0,  GPS\n"
      "2026-09-03, 00:00:00,  -07:00,   KPDX,    45.500000,  1000.0, 29.92,  100.0,   3.00,   0.50, 2400.0,  GPS\n";
  const Recording log = read(text);
  EXPECT_THAT(*log.at("Pitch").time, ElementsAre(86399.0, 86400.0));
  EXPECT_NEAR(log.at("Pitch").value[0], 2.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_NEAR(log.at("IAS").value[0], 51.444444, 1e-6);
  EXPECT_NEAR(log.at("NormAc").value[0], 4.903325, 1e-12);
  EXPECT_NEAR(log.at("AltB").value[0], 304.8, 1e-12);
  EXPECT_THAT(notes_of(text), ElementsAre("1 rows without a time were left out"));
}

// Long and short names as a GDU 460 (G3X) writes them.
TEST(Csv, ReadsAGarminLogWithTwoRowsOfNames) {
  const Recording log = read(
      "#airframe_info,log_version=\"1.00\",product=\"GDU 460\"\n"
      "Date (yyyy-mm-dd),Time (hh:mm:ss),GPS Velocity N (m/sec),True Airspeed (kt),Normal Acceleration (G),CAS Alert\n"
      "Lcl Date,Lcl Time,,TAS,NormAc,\n"
      "2026-09-02,14:47:56,10.5,100,1.0,\n2026-09-02,14:47:57,10.6,101,1.1,\n2026-09-02,14:47:58,10.6,101,1.1,\n");
  EXPECT_THAT(log.at("GPS Velocity N").value, ElementsAre(10.5, 10.6, 10.6));
  EXPECT_EQ(log.at("Normal Acceleration").unit.name, "m/s^2");
  EXPECT_NEAR(log.at("True Airspeed").value[0], 51.444444, 1e-6);
}

// What Blackbox Explorer exports: lines of metadata ahead of the header.
TEST(Csv, ReadsTheExportOfABlackboxBelowItsMetadata) {
  std::string text =
      "\"Product\",\"Blackbox flight data recorder by Nicholas Sherlock\"\n\"firmwareType\",3\n"
      "\"Firmware revision\",\"Betaflight 4.5.1 (77d01ba3b) STM32H743\"\n\"rollPID\",\"45,80,40\"\n\"acc_1G\",2048\n"
      "\"debug_mode\",\"\"\n\"loopIteration\",\"time\",\"gyroADC[0]\",\"heading[0]\"\n";
  for (int i = 0; i < 10; ++i) text += std::to_string(i) + "," + std::to_string(1000000 + 1000 * i) + ",90,NaN\n";
  const Recording log = read(text);
  EXPECT_EQ(log.at("gyroADC[0]").size(), 10U);
  // Thousand apart would be 1 Hz in ms too; this recorder counts microseconds.
  EXPECT_NEAR(log.at("gyroADC[0]").times()[1], 1.001, 1e-12);
  EXPECT_EQ(log.information.at("acc_1G"), "2048");
  EXPECT_THAT(notes_of(text), Contains("the names of the columns are in line 7; what stands above describes them"));
}

// ASCII as CarMaker writes it: names, types and units, each in a comment.
TEST(Csv, ReadsNamesTypesAndUnitsInThreeComments) {
  const char* text = "#Time\tCar.vx\tCar.YawRate\n#double\tfloat\tfloat\n#s\tkm/h\tdeg/s\n0\t36\t180\n0.5\t72\t90\n";
  const Recording log = read(text);
  EXPECT_THAT(log.at("Car.vx").value, ElementsAre(10.0, 20.0));
  EXPECT_NEAR(log.at("Car.YawRate").value[0], std::numbers::pi, 1e-15);
}

// Data.txt of X-Plane, whose names are twice five letters.
TEST(Csv, ReadsColumnsBetweenBars) {
  const Recording log = read(
      "\n   _totl,_time |    _Vind,_kias |    Vtrue,_ktas |    pitch,__deg |      __P,rad/s |    Gload,norml | \n"
      "        0.00000 |      100.00000 |      110.00000 |      180.00000 |        0.50000 |        1.00000 | \n"
      "        0.50000 |      100.00000 |      110.00000 |      180.00000 |        0.50000 |        1.00000 | \n");
  EXPECT_THAT(*log.at("_Vind,_kias").time, ElementsAre(0.0, 0.5));
  EXPECT_NEAR(log.at("_Vind,_kias").value[0], 51.444444, 1e-6);
  EXPECT_NEAR(log.at("pitch,__deg").value[0], std::numbers::pi, 1e-15);
  EXPECT_EQ(log.at("__P,rad/s").unit.name, "rad/s");
  EXPECT_NEAR(log.at("Gload,norml").value[0], 9.80665, 1e-12);
}

TEST(Csv, FindsAHeaderBelowLinesOfAnyForm) {
  const char* text =
      "FLIGHT 12 OF AIRCRAFT D-ABCD\nPilot: Smith\nNUMBER OF CHANNELS 3\n\ntime TAS NZ\n sec kts G\n"
      "0.0 100 1\n0.1 100 1\n0.2 100 1\n";
  const Recording log = read(text);
  EXPECT_NEAR(log.at("TAS").value[2], 51.444444, 1e-6);
  EXPECT_NEAR(log.at("NZ").value[0], 9.80665, 1e-12);
  EXPECT_EQ(log.information.at("Pilot"), "Smith");
  const Recording same = read(text, {.skip_lines = 4});
  EXPECT_THAT(same.at("TAS").value, ::testing::ElementsAreArray(log.at("TAS").value));
  EXPECT_EQ(refusal("a,b\n0,1\n", {.skip_lines = 3}), "a.csv: has only 2 lines, skip_lines leaves nothing of it");
  EXPECT_EQ(refusal("time,a\n0,1\n1,hello\n", {.skip_lines = 1}).substr(0, 29), "a.csv:2: no time column found");
  // A row that is wrong makes no table between blanks of one between commas.
  EXPECT_EQ(refusal("time, a, b\n0, 1, 2\n1, 2, 3\n2, 3\n3, 4, 5\n4, 5, 6\n"), "a.csv:4: 2 cells, the header has 3");
  // No header is made of rows that are longer than the first.
  EXPECT_EQ(refusal("time,a\n0,1,2\n1,2,3\n2,3,4\n3,4,5\n"), "a.csv:2: more cells than the 2 of the header");
}

TEST(Csv, TakesAUnitInEveryPlaceWherePeopleWriteIt) {
  const Recording comma = read("\"Time, sec\",\"TAS, knots\",\"p, deg/sec\"\n0,100,180\n1,100,180\n");
  EXPECT_NEAR(comma.at("TAS").value[0], 51.444444, 1e-6);
  EXPECT_NEAR(comma.at("p").value[0], std::numbers::pi, 1e-15);
  const Recording slash = read("Time/s TAS/(m/s) AOA/deg p/(deg/s)\n0 10 180 1\n1 10 180 1\n");
  EXPECT_THAT(slash.names(), ElementsAre("TAS", "AOA", "p"));
  EXPECT_NEAR(slash.at("AOA").value[0], std::numbers::pi, 1e-15);
  EXPECT_EQ(slash.at("p").unit.name, "rad/s");
  // What is no unit stays in the name.
  EXPECT_THAT(read("time,L/D,\"x, y\"\n0,1,2\n").names(), ElementsAre("L/D", "x, y"));
}

TEST(Csv, TakesGForGravityButNotOfACompass) {
  const Recording log = read("time (s),Az [G],Mag X [G]\n0,1,0.5\n1,1,0.5\n");
  EXPECT_NEAR(log.at("Az").value[0], 9.80665, 1e-12);
  EXPECT_NEAR(log.at("Mag X").value[0], 0.5e-4, 1e-18);
}

TEST(Csv, TakesNoTemperatureForAClock) {
  EXPECT_EQ(read("TimeUS,T,p\n0,25,1\n20000,25,1\n40000,25,1\n").at("T").value[0], 25.0);
  EXPECT_EQ(read("timestamp,T,p\n0,25,1\n20000,25,1\n40000,25,1\n").at("p").times()[1], 0.02);
  EXPECT_THAT(read("T,p\n0,1\n0.5,1\n").names(), ElementsAre("p"));
}

TEST(Csv, KnowsUnitsThatJsbsimHasWithoutSayingSo) {
  const Recording log = read(
      "Time,P (deg/s),V_{Total} (ft/s),BodyAccel_Z,Rho (slugs/ft^3),Temperature (R),L_{Aero} (ft-lbs)\n"
      "0,180,100,-32.174,0.0023769,518.67,1\n0.02,180,100,-32.174,0.0023769,518.67,1\n");
  EXPECT_NEAR(log.at("BodyAccel_Z").value[0], -9.80665, 1e-4);
  EXPECT_NEAR(log.at("Rho").value[0], 1.225, 1e-4);
  EXPECT_NEAR(log.at("Temperature (R)").value[0], 288.15, 1e-10);
  EXPECT_NEAR(log.at("L_{Aero}").value[0], 1.3558179, 1e-7);
}

TEST(Csv, ReadsADecimalCommaAndSaysSo) {
  const char* text = "Zeit;V\n0,00;20,5\n0,02;21\n";
  EXPECT_THAT(read(text).at("V").value, ElementsAre(20.5, 21.0));
  EXPECT_THAT(notes_of(text), Contains(HasSubstr("decimal comma")));
  EXPECT_THAT(refusal(text, {.decimal = '.'}), HasSubstr("a.csv:2: column 'Zeit': '0,00' is not a number"));
  EXPECT_THAT(read("time,V\n0,\"20,5\"\n1,\"21,5\"\n").at("V").value, ElementsAre(20.5, 21.5));
}

TEST(Csv, NumbersColumnsOfOneNameAndSaysSo) {
  const char* text = "time,V,V\n0,1,2\n";
  EXPECT_THAT(read(text).at("V(2)").value, ElementsAre(2.0));
  EXPECT_THAT(notes_of(text), ElementsAre("names of columns appear again, and are numbered: V(2)"));
}

TEST(Csv, AssumesAUnitOfTimeOnlyWhereNothingSaysItAndNotesIt) {
  EXPECT_THAT(*read("time,x\n0,1\n20,1\n40,1\n").at("x").time, ElementsAre(0.0, 0.02, 0.04));
  EXPECT_THAT(notes_of("time,x\n0,1\n20,1\n40,1\n"), ElementsAre(HasSubstr("taken as ms: whole numbers 20 apart")));
  EXPECT_THAT(*read("time,x\n0,1\n20,1\n40,1\n", {.time_unit = "s"}).at("x").time, ElementsAre(0.0, 20.0, 40.0));
  EXPECT_TRUE(notes_of("time[s],x[1]\n0,1\n20,1\n40,1\n").empty());
  const Recording unix = read("timestamp,x\n1700000000000000000,1\n1700000000020000000,1\n");
  EXPECT_EQ(unix.information.at("date"), "2023-11-14");
  EXPECT_NEAR(unix.at("x").times()[1] - unix.at("x").times()[0], 0.02, 1e-6);
}

TEST(Csv, ReadsTimesOfDayZonesAndDurations) {
  const Recording midnight = read("time,x\n23:59:59.5,1\n00:00:00.5,1\n");
  EXPECT_THAT(*midnight.at("x").time, ElementsAre(86399.5, 86400.5));
  const Recording zoned = read("x,when\n1,2024-05-03T12:00:00+02:00\n1,2024-05-03T11:00:01+01:00\n");
  EXPECT_THAT(*zoned.at("x").time, ElementsAre(36000.0, 36001.0));
  EXPECT_EQ(zoned.information.at("time zone"), "UTC");
  EXPECT_THAT(*read("Time,x\n0 sec,1\n0.5 sec,1\n").at("x").time, ElementsAre(0.0, 0.5));
  EXPECT_EQ(refusal("time,x\n10:00:00,1\n0.5 sec,1\n"), "a.csv:3: column 'time': '0.5 sec' is no date and time");
}

TEST(Csv, ReadsOnePartWhereTheClockRestartsAndListsAll) {
  std::string text = "time,x,word\n";
  for (int i = 0; i < 12; ++i) text += std::to_string(0.1 * i) + ",1,a\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(0.1 * i) + ",2,b\n";
  EXPECT_EQ(read(text).at("x").size(), 20U);
  EXPECT_EQ(read(text).at("x").value[0], 2.0);
  EXPECT_THAT(notes_of(text), Contains(HasSubstr("part 1 (rows 1 to 12, 0 s to 1.1 s), part 2 (rows 13 to 32, 0 s")));
  EXPECT_EQ(read(text, {.part = 1}).at("x").size(), 12U);
  EXPECT_EQ(refusal(text, {.part = 3}), "a.csv: has no part 3: its clock restarts 1 times, which makes 2 parts");
}

TEST(Csv, LeavesOutALastLineThatIsCutAndSaysSo) {
  const Log log = read_csv("time[s],a[1],b[1]\n0,1,2\n1,3,4\n2,5", "a.csv");
  EXPECT_EQ(log.topics[0].size(), 2U);
  EXPECT_EQ(log.damage.records_lost, 1U);
  EXPECT_THAT(log.damage.notes, ElementsAre("line 4 is cut (2 of 3 cells) and was left out"));
}

TEST(Csv, NamesColumnsThatHoldNoNumber) {
  const Log log = read_csv("time[s],a[1],b[1]\n0,1,\n1,inf,nan\n", "a.csv");
  EXPECT_THAT(log.damage.notes, Contains("columns without one number: b"));
  EXPECT_THAT(log.damage.notes, Contains("column 'a': 1 infinite numbers are taken as missing"));
}

TEST(Csv, RefusesWithFileLineAndColumn) {
  EXPECT_EQ(refusal(""), "a.csv: the file is empty");
  EXPECT_EQ(refusal("\n\n# nothing\n"), "a.csv: no header: the file has only blank lines and comments");
  EXPECT_EQ(refusal("time[s],a[1]\n"), "a.csv: there is a header but not one row of data");
  EXPECT_EQ(refusal("time[s],a[1]\n0,1\n1,x1\n"), "a.csv:3: column 'a': 'x1' is not a number");
  EXPECT_EQ(refusal("time,a\n0,1\n1,hello\n"), "a.csv:3: column 'a': 'hello' is not a number");
  EXPECT_EQ(refusal("# frame: frd\n\ntime[s],a[1]\n0,1\n2,1\n1,1\n"),
            "a.csv:6: column 'time': time goes backwards: 1 s after 2 s");
  EXPECT_EQ(refusal("time[s],a[1]\n0,1\n,1\n"), "a.csv:3: column 'time': the time is missing");
  EXPECT_EQ(refusal("time[s],a[1]\nnan,1\n"), "a.csv:2: column 'time': the time is missing");
  EXPECT_EQ(refusal("time[s],a[1],b[1]\n0,1\n1,2,3\n"), "a.csv:2: 2 cells, the header has 3");
  EXPECT_EQ(refusal("time[s],a[1]\n0,1,7\n"), "a.csv:2: more cells than the 2 of the header");
  EXPECT_EQ(refusal("time[s],a[1],a[m]\n0,1,2\n"), "a.csv:1: column 'a' appears twice");
  EXPECT_EQ(refusal("time[s],,b[1]\n0,1,2\n"), "a.csv:1: column 2: has no name");
  EXPECT_EQ(refusal("time[s]\n0\n"), "a.csv:1: there is no column but the time");
  EXPECT_THAT(refusal("time[s],a[parsek]\n0,1\n"), HasSubstr("a.csv:1: column 'a': unknown unit 'parsek'"));
  EXPECT_THAT(refusal("time[m],a[1]\n0,1\n"), HasSubstr("a.csv:1: column 'time': unit 'm' is a length [m]"));
  EXPECT_EQ(refusal("# frame: up\ntime[s],a[1]\n"), "a.csv:1: frame is 'up', expected frd or flu");
  EXPECT_EQ(refusal("alpha,CL\n0,1\n"),
            "a.csv:1: no time column found among alpha, CL; name it in the study ([data.time] column = \"...\"), "
            "or call it 'time[s]'");
  EXPECT_EQ(refusal("stamp,CL\n0,1\n", {.time_column = "stam"}),
            "a.csv:1: no column 'stam' for the time (did you mean 'stamp'?)");
}

// Counted with wc -l and looked up with sed in the files.
TEST(RealCsv, FilesOfOthersAreRead) {
  const auto path = shared_flight("px4/proto_flt09/airspeed_0.csv");
  VERIDYN_NEEDS_SHARED(path);
  const Recording airspeed = to_recording(read_csv_file(path));
  EXPECT_NEAR(airspeed.span().begin, 327.003843, 1e-9);
  EXPECT_NEAR(airspeed.at("air_temperature_celsius").value[1], 23.4182, 1e-12);
  const Recording controls = to_recording(read_csv_file(shared_flight("px4/proto_flt09/actuator_controls_0_0.csv")));
  EXPECT_TRUE(controls.has("control[7]"));
  const Recording gps = to_recording(read_csv_file(shared_flight("arduplane_2013/GPS.csv")));
  EXPECT_NEAR(gps.span().begin, 13.341, 1e-9);
  const Recording state = to_recording(read_csv_file(shared_flight("skywalker_stanford/flight_2021_06_30_state.csv")));
  EXPECT_NEAR(state.at("u_m_s").value[0], 0.0580556, 1e-12);
}

}  // namespace
}  // namespace veridyn::io
