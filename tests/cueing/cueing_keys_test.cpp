#include "veridyn/cueing/cueing_keys.hpp"

#include "tests/support/shown_defaults.hpp"

namespace veridyn::cueing {
namespace {

TEST(CueingKeys, ShowDefaultsThatStudiesTake) { test::expect_defaults_read_back(study_keys()); }

}  // namespace
}  // namespace veridyn::cueing
