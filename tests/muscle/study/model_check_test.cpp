#include "veridyn/muscle/study/model_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/folders.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

TEST(ModelCheck, SaysWhatLoadsWhatSimulatesAndWhatIsMissing) {
  const veridyn::test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "more");
  std::string arm(builtin_models()[0].text);
  std::ofstream(folder.path() / "arm.osim") << arm;
  std::ofstream(folder.path() / "more" / "broken.osim") << arm.substr(0, arm.size() / 2);
  std::ofstream(folder.path() / "notes.txt") << "no model";
  const std::size_t at = arm.rfind("</objects>", arm.find("</ForceSet>"));
  ASSERT_NE(at, std::string::npos);
  arm.insert(at, "<ElasticFoundationForce name=\"sole\"/>");
  std::ofstream(folder.path() / "more" / "sole.osim") << arm;
  Progress progress;
  std::vector<ModelCheck> checks;
  for (const auto& file : model_files(folder.path())) checks.push_back(check_model(file, progress, 0.02));
  ASSERT_EQ(checks.size(), 3u);
  EXPECT_TRUE(checks[0].simulates);
  EXPECT_EQ(checks[0].muscles, 6u);
  EXPECT_TRUE(checks[0].trouble.empty());
  EXPECT_FALSE(checks[1].loads);
  EXPECT_THAT(checks[1].trouble, HasSubstr("not well-formed XML"));
  EXPECT_TRUE(checks[2].loads);
  EXPECT_FALSE(checks[2].simulates);
  EXPECT_THAT(checks[2].missing, ::testing::ElementsAre("ElasticFoundationForce 'sole'"));
  const std::string table = model_check_table(checks, folder.path());
  EXPECT_THAT(table, HasSubstr("more/sole.osim"));
  EXPECT_THAT(table, HasSubstr("3 models: 2 load, 1 simulate"));
}

TEST(ModelCheck, EveryModelOfOpenSimHereSimulates) {
  const auto folder = veridyn::test::shared_folder() / "data/opensim";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  Progress progress;
  for (const auto& file : model_files(folder)) {
    const ModelCheck check = check_model(file, progress, 0.02);
    EXPECT_TRUE(check.loads) << file;
    EXPECT_TRUE(check.simulates) << file << ": " << check.trouble;
  }
}

}  // namespace
}  // namespace veridyn::muscle
