#include "veridyn/muscle/osim/builtin_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string loading_error(const std::string& name) {
  try {
    static_cast<void>(load_model(name));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(BuiltInModels, AreReadByTheirNamesAndComplete) {
  ASSERT_FALSE(builtin_models().empty());
  for (const EmbeddedText& model : builtin_models()) {
    const Model read = load_model(std::string(model.name)).model();
    EXPECT_FALSE(read.muscles.empty()) << model.name;
    // All that is in them is computed with.
    EXPECT_TRUE(read.unsupported.empty()) << model.name;
    EXPECT_TRUE(read.warnings.empty()) << model.name;
    EXPECT_FALSE(MusculoskeletalSystem(read).reduction().free().empty()) << model.name;
  }
}

TEST(BuiltInModels, WithAnotherNameAreRefusedWithTheNearestOne) {
  EXPECT_THAT(loading_error("amr"),
              AllOf(HasSubstr("no built-in model of this name"), HasSubstr("did you mean 'arm'?")));
  // A file is not looked for among them.
  EXPECT_THAT(loading_error("arm.osim"), AllOf(HasSubstr("arm.osim"), HasSubstr("no such file")));
}

}  // namespace
}  // namespace veridyn::muscle
