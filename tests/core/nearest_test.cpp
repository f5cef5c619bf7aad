#include "veridyn/core/nearest.hpp"

#include <gtest/gtest.h>

namespace veridyn {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("mass", "mass"), 0u);
  EXPECT_EQ(edit_distance("mass", "mas"), 1u);
  EXPECT_EQ(edit_distance("mass", "mess"), 1u);
  EXPECT_EQ(edit_distance("mass", "masss"), 1u);
  EXPECT_EQ(edit_distance("alpha", "alhpa"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("MASS", "mass"), 0u);
}

TEST(Nearest, FindsTheMisspeltWordAndRefusesAFarOne) {
  const std::vector<std::string> names{"airspeed", "alpha", "elevator"};
  EXPECT_EQ(nearest("elevatro", names), "elevator");
  EXPECT_EQ(nearest("temperature", names), "");
}

TEST(Suggestion, ListsWhatThereIsWhenNothingIsClose) {
  const std::vector<std::string> names{"airspeed", "alpha"};
  EXPECT_EQ(suggestion("gyro", names), " (known: airspeed, alpha)");
  EXPECT_EQ(suggestion("airsped", names), " (did you mean 'airspeed'?)");
  EXPECT_EQ(suggestion("gyro", names, 1), " (known: airspeed, and 1 more)");
}

}  // namespace
}  // namespace veridyn
