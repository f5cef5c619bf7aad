#include "veridyn/io/matlab/mat_objects.hpp"

#include "tests/io/support.hpp"
#include "tests/support/mat_object_writer.hpp"
#include "veridyn/io/matlab/mat.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::timetable_fields;
using testing::timetable_mat;
using ObjectFile = testing::MatObjectWriter;

TEST(MatObjects, ReadATimetableWithDurations) {
  ObjectFile file;
  const std::string times = testing::mat_duration(file, {500, 520, 540});
  const Log log = read_mat(timetable_mat(times, file), "x.mat");
  const LogTopic& flight = *log.find("flight");
  EXPECT_THAT(*flight.time, ElementsAre(DoubleNear(0.5, 1e-12), DoubleNear(0.52, 1e-12), DoubleNear(0.54, 1e-12)));
  EXPECT_THAT(flight.find("p")->values.numbers(), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(flight.find("acc[1]")->values.numbers(), ElementsAre(10.0, 20.0, 30.0));
  EXPECT_THAT(log.damage.notes, ElementsAre("columns of timetable 'flight' that hold no numbers are left out: mode"));
}

TEST(MatObjects, ReadATimetableWithDates) {
  ObjectFile file;
  // 2023-11-14 22:13:20 UTC
  const std::string times = file.add("datetime", {{"data", ObjectFile::reals({1.7e12, 1.7e12 + 10, 1.7e12 + 25})}});
  const Log log = read_mat(timetable_mat(times, file), "x.mat");
  EXPECT_THAT(*log.find("flight")->time,
              ElementsAre(DoubleNear(80000.0, 1e-6), DoubleNear(80000.01, 1e-6), DoubleNear(80000.025, 1e-6)));
  EXPECT_EQ(log.information.at("flight.date"), "2023-11-14");
}

TEST(MatObjects, ReadATimetableAtARate) {
  ObjectFile file;
  const std::string origin = testing::mat_duration(file, {2000});
  const std::string times = ObjectFile::fields({{"origin", origin},
                                                {"specifiedAsRate", ObjectFile::reals({1})},
                                                {"stepSize", testing::mat_duration(file, {40})},
                                                {"sampleRate", ObjectFile::reals({50})}});
  EXPECT_THAT(*read_mat(timetable_mat(times, file), "x.mat").find("flight")->time,
              ElementsAre(DoubleNear(2.0, 1e-12), DoubleNear(2.02, 1e-12), DoubleNear(2.04, 1e-12)));
  const std::string stepped = ObjectFile::fields({{"origin", origin},
                                                  {"specifiedAsRate", ObjectFile::reals({0})},
                                                  {"stepSize", testing::mat_duration(file, {40})},
                                                  {"sampleRate", ObjectFile::reals({50})}});
  EXPECT_NEAR(read_mat(timetable_mat(stepped, file), "x.mat").find("flight")->time->back(), 2.08, 1e-12);
}

TEST(MatObjects, ReadATableWithAColumnOfStamps) {
  ObjectFile file;
  const std::string stamps = testing::mat_duration(file, {0, 20, 40});
  file.variable(
      "t1", "table",
      file.add("table", {{"data", ObjectFile::cells({stamps, ObjectFile::reals({7, 8, 9})})},
                         {"nrows", ObjectFile::reals({3})},
                         {"nvars", ObjectFile::reals({2})},
                         {"varnames", ObjectFile::cells({ObjectFile::text("Time_s"), ObjectFile::text("V")})}}));
  const Log log = read_mat(file.bytes(), "x.mat");
  EXPECT_THAT(*log.find("t1")->time, ElementsAre(0.0, 0.02, 0.04));
  EXPECT_THAT(log.find("t1")->find("V")->values.numbers(), ElementsAre(7.0, 8.0, 9.0));
}

TEST(MatObjects, ReadTheUnitsOfColumns) {
  const std::string units =
      ObjectFile::cells({ObjectFile::text("deg/sec"), ObjectFile::text("furlong"), ObjectFile::text("")});
  ObjectFile file;
  auto any = timetable_fields(testing::mat_duration(file, {500, 520, 540}), 3.0);
  any.emplace_back("varUnits", units);
  file.variable("flight", "timetable", file.add("timetable", {{"any", ObjectFile::fields(any)}}, true));
  const Log log = read_mat(file.bytes(), "x.mat");
  EXPECT_EQ(log.find("flight")->find("p")->unit, "deg/s");
  EXPECT_EQ(log.find("flight")->find("acc[1]")->unit, "1");
  EXPECT_THAT(log.damage.notes, Contains("the unit of column 'acc' is not known: furlong"));

  // A table's stamps in the unit that it says; of as many units as columns only.
  const auto table = [](const std::vector<std::string>& of_columns) {
    ObjectFile made;
    made.variable(
        "t1", "table",
        made.add("table", {{"data", ObjectFile::cells({ObjectFile::reals({0, 20, 40}), ObjectFile::reals({7, 8, 9})})},
                           {"nrows", ObjectFile::reals({3})},
                           {"nvars", ObjectFile::reals({2})},
                           {"varnames", ObjectFile::cells({ObjectFile::text("time"), ObjectFile::text("V")})},
                           {"props", ObjectFile::fields({{"VariableUnits", ObjectFile::cells(of_columns)}})}}));
    return read_mat(made.bytes(), "x.mat");
  };
  const Log with = table({ObjectFile::text("ms"), ObjectFile::text("km/h")});
  EXPECT_THAT(*with.find("t1")->time, ElementsAre(0.0, 0.02, 0.04));
  EXPECT_EQ(with.find("t1")->find("V")->unit, "km/h");
  EXPECT_EQ(table({}).find("t1")->find("V")->unit, "1");
  EXPECT_EQ(table({ObjectFile::text("ms")}).find("t1")->find("V")->unit, "1");
}

// Whatever does not agree leaves it at saying how to convert the variable.
TEST(MatObjects, AreNotReadWhereAnythingIsNotAsExpected) {
  const auto refused = [](const std::string& bytes) {
    const Log log = read_mat(bytes, "x.mat");
    EXPECT_EQ(log.find("flight"), nullptr);
    EXPECT_THAT(log.damage.notes, Contains(HasSubstr("variable 'flight' is a timetable, which only MATLAB reads")));
  };
  ObjectFile file;
  const std::string times = testing::mat_duration(file, {500, 520, 540});
  refused(timetable_mat(times, file, 4.0));
  refused(timetable_mat(ObjectFile::reals({0, 1, 2}), file));
  refused(timetable_mat(file.add("duration", {{"other", ObjectFile::reals({1, 2, 3})}}), file));
  refused(timetable_mat(ObjectFile::words({0xdd000000U, 2U, 1U, 1U, 77U, 1U}), file));
  const std::string any = ObjectFile::fields(timetable_fields(times, 3.0));
  ObjectFile wrong = file;
  wrong.variable("flight", "timetable", wrong.add("table", {{"any", any}}, true));
  refused(wrong.bytes());
  ObjectFile newer = file;
  newer.variable("flight", "timetable", newer.add("timetable", {{"any", any}}, true));
  refused(newer.bytes(5));
  const std::string whole = newer.bytes();
  refused(whole.substr(0, whole.size() - 400));
}

TEST(MatObjects, StandFlippedBits) {
  ObjectFile file;
  const std::string whole = timetable_mat(testing::mat_duration(file, {500, 520, 540}), file);
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    const std::string bytes = testing::flip_bits(whole, seed);
    try {
      testing::expect_consistent(read_mat(bytes, "x"), bytes.size());
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace veridyn::io
