#include "veridyn/camera/camera_keys.hpp"

#include "tests/support/shown_defaults.hpp"

namespace veridyn::camera {
namespace {

TEST(CameraKeys, ShowDefaultsThatStudiesTake) { test::expect_defaults_read_back(study_keys()); }

}  // namespace
}  // namespace veridyn::camera
