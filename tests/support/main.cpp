// The main function of all test binaries.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

/// As GoogleTest's own; but where VERIDYN_SKIPPED is set it is the exit code of a run in which tests were skipped and
/// none failed, so that CTest can say so.
int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  const char* skipped = std::getenv("VERIDYN_SKIPPED");
  if (failed == 0 && skipped != nullptr && testing::UnitTest::GetInstance()->skipped_test_count() > 0)
    return std::atoi(skipped);
  return failed;
}
