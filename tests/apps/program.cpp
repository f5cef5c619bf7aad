#include "tests/apps/program.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace veridyn {

namespace {

Outcome shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = ::popen(command.c_str(), "r");
  std::array<char, 4096> block{};
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    outcome.text.append(block.data(), n);
  const int status = ::pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

}  // namespace

Outcome run(const std::string& arguments) { return shell(std::string(VERIDYN_PROGRAM) + " " + arguments + " 2>&1"); }

Outcome run_in_shell(const std::string& before, const std::string& arguments) {
  return shell("(" + before + "; " + std::string(VERIDYN_PROGRAM) + " " + arguments + ") 2>&1");
}

Outcome run_under(const std::string& before, const std::string& arguments) {
  return shell(before + " " + std::string(VERIDYN_PROGRAM) + " " + arguments + " 2>&1");
}

void plug_in_camera(const std::string& device, const std::filesystem::path& pictures, int width, int height,
                    double rate_Hz) {
  const auto set = [](const char* name, const std::string& value) { ::setenv(name, value.c_str(), 1); };
  set("LD_PRELOAD", VERIDYN_FAKE_CAMERA);
  set("VERIDYN_FAKE_CAMERA_DEVICE", device);
  set("VERIDYN_FAKE_CAMERA_PICTURES", pictures.string());
  set("VERIDYN_FAKE_CAMERA_WIDTH", std::to_string(width));
  set("VERIDYN_FAKE_CAMERA_HEIGHT", std::to_string(height));
  set("VERIDYN_FAKE_CAMERA_RATE", std::to_string(rate_Hz));
}

Outcome run_interrupted(const std::string& arguments, const std::filesystem::path& scratch) {
  return run_interrupted_after("", 1, arguments, scratch);
}

Outcome run_interrupted_after(const std::string& words, int signals, const std::string& arguments,
                              const std::filesystem::path& scratch) {
  const std::string said = (scratch / "stderr.txt").string();
  std::filesystem::remove(said);  // of the run before
  std::string line = std::string(VERIDYN_PROGRAM) + " " + arguments + " >/dev/null 2>" + said + " & pid=$!; " +
                     "while ! grep -q '" + words + "' " + said + " 2>/dev/null && kill -0 $pid 2>/dev/null; " +
                     "do sleep 0.02; done; ";
  for (int i = 0; i < signals; ++i) line += "sleep 0.1; kill -INT $pid 2>/dev/null; ";
  return shell(line + "wait $pid; code=$?; cat " + said + "; exit $code");
}

}  // namespace veridyn
