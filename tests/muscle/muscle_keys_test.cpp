#include "veridyn/muscle/muscle_keys.hpp"

#include "tests/support/shown_defaults.hpp"

namespace veridyn::muscle {
namespace {

TEST(MuscleKeys, ShowDefaultsThatStudiesTake) { test::expect_defaults_read_back(study_keys()); }

}  // namespace
}  // namespace veridyn::muscle
