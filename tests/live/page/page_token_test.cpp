#include "veridyn/live/page/page_token.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

TEST(PageToken, OfAFileThatOthersCanReadIsRefused) {
  const veridyn::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "token";
  std::ofstream(file) << "  0123456789abcdef  \n";
  ::chmod(file.c_str(), 0600);
  EXPECT_EQ(read_token_file(file), "0123456789abcdef");
  ::chmod(file.c_str(), 0640);
  EXPECT_THAT(why([&] { static_cast<void>(read_token_file(file)); }), HasSubstr("can be read by others"));
  ::chmod(file.c_str(), 0600);
  std::ofstream(file) << "short\n";
  EXPECT_THAT(why([&] { static_cast<void>(read_token_file(file)); }), HasSubstr("a token of 5 characters"));
  EXPECT_THROW(static_cast<void>(read_token_file(file)), InputError);
}

TEST(PageToken, IsComparedWhole) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "Abc", "abcabc"})
    EXPECT_FALSE(equal_in_constant_time("abc", other)) << other;
  EXPECT_FALSE(equal_in_constant_time("", ""));
  EXPECT_FALSE(equal_in_constant_time("", "a"));
  EXPECT_NE(random_token(), random_token());
  EXPECT_EQ(random_token().size(), 32U);
}

}  // namespace
}  // namespace veridyn::live
