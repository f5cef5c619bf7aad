#include "veridyn/io/results/estimate_json.hpp"

#include <cmath>

#include "tests/io/support.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;

estimation::Estimate two_parameters() {
  estimation::Estimate e;
  e.subject = "unatrap";
  e.method = "GTLS";
  for (const char* name : {"CL_0", "CL_alpha"}) {
    auto& p = e.parameters.emplace_back();
    p.name = name;
    p.value = 0.1 + 0.2;  // no short decimal
    p.sigma = 1e-17;
    p.low95 = -1.0 / 3.0;
    p.high95 = 5.0;
    p.unit = "1/rad";
    p.status = estimation::ParameterStatus::kIdentified;
  }
  e.covariance = Eigen::Matrix2d{{1.0, 0.1}, {0.1, 2.0}};
  e.fit = {{"CL", 0.97}};
  e.validation["alpha"] = {0.1, 0.2, 0.3, 0.4, "deg"};
  e.verdict = "identified: CL";
  e.warnings = {"a line"};
  return e;
}

TEST(EstimateJson, IsReadAsItWasWrittenToTheLastBit) {
  const testing::TemporaryFolder folder;
  const std::string text = to_json(two_parameters());
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", text));
  EXPECT_EQ(to_json(read), text);
  ASSERT_EQ(read.parameters.size(), 2u);
  EXPECT_EQ(read.parameters[1].value, 0.1 + 0.2);
  EXPECT_EQ(read.parameters[1].low95, -1.0 / 3.0);
  EXPECT_EQ(read.covariance(0, 1), 0.1);
  EXPECT_EQ(read.validation.at("alpha").unit, "deg");
  EXPECT_THAT(read.warnings, ElementsAre("a line"));
}

TEST(EstimateJson, BeginsWithItsSchemaAndIsReadWithoutOne) {
  const testing::TemporaryFolder folder;
  const std::string text = to_json(two_parameters());
  const std::string first = "{\n  \"schema\": 1,\n";
  ASSERT_EQ(text.substr(0, first.size()), first);
  const std::string rest = text.substr(first.size());
  EXPECT_EQ(to_json(read_estimate(folder.write("old.json", "{\n" + rest))), text) << "of an earlier version";
  const auto later = folder.write("later.json", "{\n  \"schema\": 2,\n" + rest);
  EXPECT_THAT(message_of([&] { static_cast<void>(read_estimate(later)); }), HasSubstr("has schema 2"));
}

TEST(EstimateJson, KeepsGradesAndEvidence) {
  estimation::Estimate e = two_parameters();
  e.parameters[0].status = estimation::ParameterStatus::kEffective;
  e.evidence = {row_of(estimation::Check::kCrossValidation, "CL", estimation::Outcome::kMissing).with("folds", 5.0)};
  e.evidence[0].cause = estimation::Cause::kLength;
  e.evidence[0].sigma = 0.1;
  e.judgement = estimation::judge(e.evidence);
  const testing::TemporaryFolder folder;
  const std::string text = to_json(e);
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", text));
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.judgement.prediction.grade, estimation::Grade::kNotJudged);
  EXPECT_THAT(read.judgement.prediction.decided_by, ElementsAre(says(e.evidence[0])));
  ASSERT_EQ(read.evidence.size(), 1u);
  EXPECT_EQ(read.evidence[0].check, estimation::Check::kCrossValidation);
  EXPECT_EQ(read.evidence[0].cause, estimation::Cause::kLength);
  EXPECT_FALSE(read.evidence[0].bears_on.contains(estimation::Purpose::kParameters));
}

TEST(EstimateJson, KeepsTheRecordingsOfSeveral) {
  estimation::Estimate e = two_parameters();
  EXPECT_THAT(to_json(e), ::testing::Not(HasSubstr("recordings"))) << "of one recording";
  e.recordings = {{.name = "a.csv", .use = "identification"},
                  {.name = "b.csv", .use = "hold-out", .validation = {{"CL", {0.1, 0.2, 0.9, 0.05, "1"}}}}};
  const testing::TemporaryFolder folder;
  const std::string text = to_json(e);
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", text));
  EXPECT_EQ(to_json(read), text);
  ASSERT_EQ(read.recordings.size(), 2u);
  EXPECT_EQ(read.recordings[1].name, "b.csv");
  EXPECT_EQ(read.recordings[1].use, "hold-out");
  EXPECT_EQ(read.recordings[1].validation.at("CL").r2, 0.9);
  const auto broken = folder.write(
      "broken.json", text.substr(0, text.find("\"a.csv\"")) + "7" + text.substr(text.find("\"a.csv\"") + 7));
  EXPECT_THAT(message_of([&] { static_cast<void>(read_estimate(broken)); }), HasSubstr("recordings[0]: name"));
}

// JSON has no infinite numbers: such an end of an interval is null in the file.
TEST(EstimateJson, KeepsWhatFollowsFromTheParameters) {
  estimation::Estimate e = two_parameters();
  EXPECT_EQ(to_json(e).find("derived"), std::string::npos);
  e.derived = {{.group = "spiral mode",
                .name = "spiral.time_to_half",
                .value = 12.5,
                .low95 = 8.0,
                .high95 = kInfinity,
                .unit = "s",
                .note = "at 20 m/s"}};
  const testing::TemporaryFolder folder;
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", to_json(e)));
  ASSERT_EQ(read.derived.size(), 1u);
  EXPECT_EQ(read.derived[0].name, "spiral.time_to_half");
  EXPECT_EQ(read.derived[0].group, "spiral mode");
  EXPECT_EQ(read.derived[0].value, 12.5);
  EXPECT_EQ(read.derived[0].low95, 8.0);
  EXPECT_TRUE(std::isnan(read.derived[0].high95));
  EXPECT_EQ(read.derived[0].note, "at 20 m/s");
}

TEST(EstimateJson, KeepsWhatToMeasureNext) {
  estimation::Estimate e = two_parameters();
  EXPECT_EQ(to_json(e).find("next_measurements"), std::string::npos);
  e.next_measurements = {{"task 5", "a", 0.2, "b", 0.125}, {"task 7", "a", 0.2, "a", 0.15}};
  const testing::TemporaryFolder folder;
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", to_json(e)));
  ASSERT_EQ(read.next_measurements.size(), 2u);
  EXPECT_EQ(read.next_measurements[0].name, "task 5");
  EXPECT_EQ(read.next_measurements[0].widest_then, "b");
  EXPECT_EQ(read.next_measurements[0].share_now, 0.2);
  EXPECT_EQ(read.next_measurements[1].share_then, 0.15);
}

TEST(EstimateJson, KeepsTheStructureAndTheOthersThatWereTried) {
  estimation::Estimate e = two_parameters();
  EXPECT_EQ(to_json(e).find("structure"), std::string::npos);
  e.structure = "roll";
  e.structure_reason = "likelier";
  e.tried_structures = {{.name = "bicycle", .obstacle = "did not converge", .needed_gain = 12.5},
                        {.name = "roll",
                         .taken = true,
                         .log_likelihood_gain = 400.0,
                         .holdout_quantity = "yaw_rate",
                         .holdout_rmse = 0.002,
                         .holdout_unit = "rad/s",
                         .parameters = {{.name = "C_f", .value = 5e4, .sigma = 500.0, .unit = "N/rad"}}}};
  const testing::TemporaryFolder folder;
  const std::string text = to_json(e);
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", text));
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.structure, "roll");
  EXPECT_EQ(read.structure_reason, "likelier");
  ASSERT_EQ(read.tried_structures.size(), 2u);
  EXPECT_EQ(read.tried_structures[0].obstacle, "did not converge");
  EXPECT_TRUE(std::isnan(read.tried_structures[0].log_likelihood_gain));
  EXPECT_EQ(read.tried_structures[0].needed_gain, 12.5);
  const estimation::StructureTrial& roll = read.tried_structures[1];
  EXPECT_TRUE(roll.taken);
  EXPECT_EQ(roll.log_likelihood_gain, 400.0);
  EXPECT_EQ(roll.holdout_quantity, "yaw_rate");
  EXPECT_EQ(roll.holdout_rmse, 0.002);
  EXPECT_EQ(roll.holdout_unit, "rad/s");
  ASSERT_EQ(roll.parameters.size(), 1u);
  EXPECT_EQ(roll.parameters[0].name, "C_f");
  EXPECT_EQ(roll.parameters[0].sigma, 500.0);
}

TEST(EstimateJson, SaysOfWhatWasInterruptedThatItWas) {
  estimation::Estimate e = two_parameters();
  EXPECT_EQ(to_json(e).find("interrupted"), std::string::npos);
  e.interrupted = true;
  const testing::TemporaryFolder folder;
  const std::string text = to_json(e);
  EXPECT_NE(text.find("\"interrupted\": true"), std::string::npos);
  EXPECT_TRUE(read_estimate(folder.write("estimate.json", text)).interrupted);
  EXPECT_FALSE(read_estimate(folder.write("whole.json", to_json(two_parameters()))).interrupted);
}

TEST(EstimateJson, RefusesAStructureThatIsNeitherTakenNorNot) {
  estimation::Estimate e = two_parameters();
  e.structure = "roll";
  e.tried_structures = {{.name = "roll", .taken = true}};
  std::string text = to_json(e);
  const std::string word = "\"taken\": true";
  text.replace(text.find(word), word.size(), "\"taken\": 1");
  const testing::TemporaryFolder folder;
  const auto file = folder.write("estimate.json", text);
  EXPECT_THAT(message_of([&] { (void)read_estimate(file); }),
              HasSubstr("tried_structures[0].taken: is neither true nor false"));
}

TEST(EstimateJson, RefusesAGradeThatIsNone) {
  std::string text = to_json(two_parameters());
  const std::size_t at = text.find("not judged");
  text.replace(at, 10, "marvellous");
  const testing::TemporaryFolder folder;
  const auto file = folder.write("estimate.json", text);
  EXPECT_THAT(message_of([&] { static_cast<void>(read_estimate(file)); }),
              HasSubstr("grades.data.grade: 'marvellous' is not one of yes, with care, not judged, no"));
}

TEST(EstimateJson, HasNullForWhatIsNotFinite) {
  estimation::Estimate e = two_parameters();
  e.parameters[0].value = std::nan("");
  e.parameters[0].status = estimation::ParameterStatus::kNotExcited;
  e.covariance(0, 0) = INFINITY;
  EXPECT_THAT(to_json(e), HasSubstr("\"value\": null"));
  const testing::TemporaryFolder folder;
  const estimation::Estimate read = read_estimate(folder.write("estimate.json", to_json(e)));
  EXPECT_TRUE(std::isnan(read.parameters[0].value));
  EXPECT_FALSE(std::isfinite(read.covariance(0, 0)));
}

TEST(EstimateJson, RefusesWhatDoesNotFitByPlaceAndKey) {
  const testing::TemporaryFolder folder;
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = to_json(two_parameters());
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return message_of([&] { static_cast<void>(read_estimate(folder.write("estimate.json", text))); });
  };
  EXPECT_THAT(refused("{", "["), HasSubstr("estimate.json: not JSON at byte"));
  EXPECT_THAT(refused("\"subject\"", "\"subjekt\""), HasSubstr("subject"));
  EXPECT_THAT(refused("\"sigma\"", "\"sigm\""), HasSubstr("estimate.json: parameters[0]"));
  EXPECT_THAT(refused("\"status\": \"identified\"", "\"status\": \"good\""), HasSubstr("status 'good' is not one of"));
  EXPECT_THAT(refused("\"covariance\": [", "\"covariance\": [ [1, 2],"), HasSubstr("'covariance' is not a 2 by 2"));
}

}  // namespace
}  // namespace veridyn::io
