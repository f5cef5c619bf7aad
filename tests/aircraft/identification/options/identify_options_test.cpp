#include "veridyn/aircraft/identification/options/identify_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

TEST(IdentifyOptions, RefuseValuesThatMakeNoSense) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      const Study study = Study::parse("[identify]\n" + text, "study.toml");
      static_cast<void>(IdentifyOptions::keys().read(study.root().table("identify")));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message("bootstrap = 10"),
            "study.toml:2: identify.bootstrap: = 10 must be 0 (none) or at least 50 replicates");
  EXPECT_THAT(message("frequency_band = [2, 0.1]"), ::testing::HasSubstr("0 < low < high"));
  EXPECT_THAT(message("frequency_band = [\"0.1 kg\", \"2 Hz\"]"), ::testing::HasSubstr("kg"));
  EXPECT_THAT(message("structure = \"stepwize\""), ::testing::HasSubstr("stepwise"));
  EXPECT_THAT(message("[identify.candidates]\nCL = [\"1\", \"alpha\"]"), ::testing::HasSubstr("needs structure"));
  EXPECT_THAT(message("structure = \"stepwise\"\n[identify.candidates]\nCL = [\"alfa\"]"),
              ::testing::HasSubstr("alpha"));
  EXPECT_THAT(message("structure = \"stepwise\"\n[identify.candidates]\nCL = [\"alpha\", \"alpha\"]"),
              ::testing::HasSubstr("twice"));
}

TEST(IdentifyOptions, AreEnumerationsOfTheStudysWords) {
  const auto read = [](const std::string& text) {
    return IdentifyOptions::keys().read(Study::parse("[identify]\n" + text, "study.toml").root().table("identify"));
  };
  EXPECT_FALSE(read("").method.has_value());
  EXPECT_FALSE(read("method = \"auto\"").method.has_value());
  EXPECT_EQ(read("method = \"PCA-GTLS\"").method, estimation::Method::kPcaGtls);
  EXPECT_FALSE(read("structure = \"given\"").structure.has_value());
  EXPECT_EQ(read("structure = \"orthogonal\"").structure, estimation::StructureMethod::kOrthogonal);
  EXPECT_EQ(read("structure = \"stepwise\"").structure, estimation::StructureMethod::kStepwise);
  EXPECT_THROW(static_cast<void>(read("method = \"LS\"")), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
