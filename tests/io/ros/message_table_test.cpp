#include "veridyn/io/ros/message_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ros_writer.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::ElementsAre;
using testing::MessageWriter;

MessageTable table(const char* type, const std::string& text, RosEncoding encoding = RosEncoding::kCdr) {
  return MessageTable(*ros_layout(*parse_ros_definitions(type, text), encoding), encoding);
}

std::vector<std::string> names(const std::vector<LogField>& fields) {
  std::vector<std::string> all;
  for (const LogField& f : fields) all.push_back(f.name);
  return all;
}

const char* const kMixed =
    "std_msgs/Header header\nuint8 a\nint64 b\nstring text\nfloat32 c\nint16[] some\nbool d\nfloat64 e\n"
    "Part[] parts\nuint16 f\n==========\nMSG: a/Part\nstring s\nfloat64 x\n==========\nMSG: std_msgs/Header\n";

std::string mixed(MessageWriter::Kind kind, int i) {
  MessageWriter m(kind);
  m.header(5'000'000'001LL + i, "base").numbers(static_cast<std::uint8_t>(200 + i), std::int64_t{-7} * i);
  m.text(i == 0 ? "" : "hello").number(0.5F * static_cast<float>(i)).number(std::uint32_t{2});
  m.numbers(static_cast<std::int16_t>(-i), std::int16_t{9}).number(std::uint8_t{1}).number(0.1 * i);
  m.number(std::uint32_t{1}).text("xy").number(3.25).number(static_cast<std::uint16_t>(60000 + i));
  return m.bytes();
}

TEST(MessageTable, DecodesBothByteOrdersAndRos1Alike) {
  for (const auto& [kind, encoding, header] :
       {std::tuple(MessageWriter::Kind::kLittleEndian, RosEncoding::kCdr, "builtin_interfaces/Time stamp\n"),
        std::tuple(MessageWriter::Kind::kBigEndian, RosEncoding::kCdr, "builtin_interfaces/Time stamp\n"),
        std::tuple(MessageWriter::Kind::kRos1, RosEncoding::kRos1, "uint32 seq\ntime stamp\n")}) {
    MessageTable made = table("a/msg/B", kMixed + std::string(header) + "string frame_id\n", encoding);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(made.add(mixed(kind, i), 100 + i, static_cast<std::uint64_t>(i)));
    EXPECT_THAT(made.stamps(), ElementsAre(5'000'000'001, 5'000'000'002, 5'000'000'003));
    EXPECT_THAT(made.logged(), ElementsAre(100, 101, 102));
    EXPECT_EQ(made.frame(), "base");
    std::map<std::string, std::string> constants;
    const std::vector<LogField> fields = made.take_fields(constants);
    EXPECT_THAT(names(fields), ElementsAre("a", "b", "c", "d", "e", "f", "some[0]", "some[1]"));
    EXPECT_THAT(fields[0].values.numbers(), ElementsAre(200.0, 201.0, 202.0));
    EXPECT_THAT(fields[1].values.numbers(), ElementsAre(0.0, -7.0, -14.0));
    EXPECT_THAT(fields[2].values.numbers(), ElementsAre(0.0, 0.5, 1.0));
    EXPECT_THAT(fields[3].values.numbers(), ElementsAre(1.0, 1.0, 1.0));
    EXPECT_THAT(fields[4].values.numbers(), ElementsAre(0.0, 0.1, 0.2));
    EXPECT_THAT(fields[5].values.numbers(), ElementsAre(60000.0, 60001.0, 60002.0));
    EXPECT_THAT(fields[6].values.numbers(), ElementsAre(0.0, -1.0, -2.0));
    EXPECT_THAT(fields[7].values.numbers(), ElementsAre(9.0, 9.0, 9.0));
  }
}

TEST(MessageTable, LeavesOutMessagesOfAnotherSizeThanTheirDefinition) {
  MessageTable made = table("a/msg/B", "float64 x\nuint8 y\n");
  const std::string good = MessageWriter().number(1.5).number(std::uint8_t{2}).bytes();
  EXPECT_TRUE(made.add(good, 0, 0));
  EXPECT_TRUE(made.add(good + std::string(3, '\0'), 0, 1)) << "filled up to a multiple of 4";
  EXPECT_FALSE(made.add(good + std::string(4, '\0'), 0, 2)) << "a definition of another version";
  EXPECT_FALSE(made.add(good.substr(0, good.size() - 1), 0, 3));
  EXPECT_FALSE(made.add("", 0, 4));
  std::string parameters = good;
  parameters[1] = 3;  // PL_CDR_LE
  EXPECT_FALSE(made.add(parameters, 0, 5));
  std::map<std::string, std::string> constants;
  for (const LogField& field : made.take_fields(constants)) EXPECT_EQ(field.values.size(), 2U);
}

TEST(MessageTable, TakesNothingOfAMessageThatEndsEarly) {
  MessageTable made = table("a/msg/B", "float64 x\nfloat64[] some\nfloat64 y\n");
  const auto message = [](double x) { return MessageWriter().number(x).sequence({x, 2.0 * x}).number(-x).bytes(); };
  EXPECT_TRUE(made.add(message(1.0), 0, 0));
  for (std::size_t size = 4; size < message(2.0).size(); ++size)
    EXPECT_FALSE(made.add(message(2.0).substr(0, size), 0, 1)) << size;
  EXPECT_TRUE(made.add(message(3.0), 0, 2));
  std::map<std::string, std::string> constants;
  const std::vector<LogField> fields = made.take_fields(constants);
  ASSERT_THAT(names(fields), ElementsAre("x", "y", "some[0]", "some[1]"));
  EXPECT_THAT(fields[0].values.numbers(), ElementsAre(1.0, 3.0));
  EXPECT_THAT(fields[1].values.numbers(), ElementsAre(-1.0, -3.0));
  EXPECT_THAT(fields[3].values.numbers(), ElementsAre(2.0, 6.0));
}

// Publishers of one topic may name other joints, in another order.
TEST(MessageTable, NamesSequencesByTheNamesThatTheMessageHas) {
  MessageTable made = table("sensor_msgs/msg/JointState", "");
  made = MessageTable(
      *ros_layout(*parse_ros_definitions("a/msg/B", "string[] name\nfloat64[] position\nfloat64[] velocity\n"),
                  RosEncoding::kCdr),
      RosEncoding::kCdr);
  EXPECT_TRUE(made.add(MessageWriter().texts({"l", "r"}).sequence({1, 2}).sequence({}).bytes(), 0, 0));
  EXPECT_TRUE(made.add(MessageWriter().texts({"r", "l"}).sequence({4, 3}).sequence({}).bytes(), 0, 1));
  EXPECT_TRUE(made.add(MessageWriter().texts({"x"}).sequence({5}).sequence({7, 8}).bytes(), 0, 2));
  std::map<std::string, std::string> constants;
  const std::vector<LogField> fields = made.take_fields(constants);
  ASSERT_THAT(names(fields), ElementsAre("position[l]", "position[r]", "position[x]", "velocity[0]", "velocity[1]"));
  EXPECT_EQ(fields[0].values.number(1), 3.0);
  EXPECT_TRUE(std::isnan(fields[0].values.number(2)));
  EXPECT_EQ(fields[1].values.number(1), 4.0);
  EXPECT_TRUE(std::isnan(fields[2].values.number(0)));
  EXPECT_EQ(fields[4].values.number(2), 8.0);
}

TEST(MessageTable, MakesNoColumnsOfLongSequencesNorOfCovariancesThatNeverChange) {
  MessageTable made = table("a/msg/B", "float64[2] covariance\nfloat64[2] other_covariance\nfloat64[] ranges\n");
  EXPECT_TRUE(made.add(MessageWriter().reals({1, 2, 3, 4}).sequence({1, 2}).bytes(), 0, 0));
  EXPECT_TRUE(made.add(MessageWriter().reals({1, 2, 3, 5}).sequence(std::vector<double>(65, 1.0)).bytes(), 0, 1));
  std::map<std::string, std::string> constants;
  EXPECT_THAT(names(made.take_fields(constants)), ElementsAre("other_covariance[1]"));
  EXPECT_EQ(constants.at("covariance"), "1 2");
}

TEST(NumberColumn, KeepsANumberThatNeverChangesOnce) {
  NumberColumn column(GatherType::kInt16);
  for (int i = 0; i < 5; ++i) column.push(std::int16_t{-3});
  EXPECT_FALSE(column.varies());
  EXPECT_EQ(column.first(), -3.0);
  column.push(std::int16_t{4});
  EXPECT_TRUE(column.varies());
  column.shorten(2);
  column.push(std::int16_t{6});
  EXPECT_THAT(column.take().numbers(), ElementsAre(-3.0, -3.0, 6.0));
  NumberColumn constant(GatherType::kFloat);
  for (int i = 0; i < 3; ++i) constant.push(2.5F);
  constant.shorten(2);
  EXPECT_THAT(constant.take().numbers(), ElementsAre(2.5, 2.5));
}

}  // namespace
}  // namespace veridyn::io::internal
