#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn {

struct Outcome {
  int exit_code = -1;
  std::string text;  ///< stdout and stderr
};

/// Runs the program with these arguments.
[[nodiscard]] Outcome run(const std::string& arguments);

/// The same after `before` ("ulimit -f 8") in the same shell.
[[nodiscard]] Outcome run_in_shell(const std::string& before, const std::string& arguments);

/// The same as the last words of `before` ("timeout -s KILL 0.5", "mpirun -n 2", "NAME=value").
[[nodiscard]] Outcome run_under(const std::string& before, const std::string& arguments);

/// Runs the program, presses Ctrl-C as soon as it says on stderr what it is doing, and waits for its end. The text is
/// what it said on stderr.
[[nodiscard]] Outcome run_interrupted(const std::string& arguments, const std::filesystem::path& scratch);

/// The same, once it has said `words`, by `signals` a tenth of a second after each other; 130 where the signal ended
/// it.
[[nodiscard]] Outcome run_interrupted_after(const std::string& words, int signals, const std::string& arguments,
                                            const std::filesystem::path& scratch);

/// Lets programs that are run from here on find a camera at `device`, an existing character device, which shows these
/// pictures and is unplugged after the last one (tests/support/fake_camera).
void plug_in_camera(const std::string& device, const std::filesystem::path& pictures, int width, int height,
                    double rate_Hz);

/// A scratch folder for each test, and what every refusal must look like.
class ProgramTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) const {
    write_file(folder_ / name, content);
    return (folder_ / name).string();
  }
  std::string out() const { return " --quiet --out " + (folder_ / "out").string(); }

  /// A wrong input: exit code 2, one line that holds `message`, and no result.
  void expect_refusal(const std::string& arguments, const std::string& message) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, testing::HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "estimate.json"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "report.html"));
  }

  [[nodiscard]] std::filesystem::path in_out(const std::string& name) const { return folder_ / "out" / name; }
  /// Names in the folder of the results, sorted; none where there is no folder.
  [[nodiscard]] std::vector<std::string> results() const {
    std::vector<std::string> names;
    if (!std::filesystem::exists(folder_ / "out")) return names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  test::TemporaryFolder temporary_;

 protected:
  const std::filesystem::path& folder_ = temporary_.path();
};

}  // namespace veridyn
