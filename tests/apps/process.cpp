#include "tests/apps/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace veridyn {

Process::Process(const std::vector<std::string>& arguments, const std::filesystem::path& says,
                 const std::filesystem::path& errors)
    : says_(says) {
  std::filesystem::remove(says_);
  std::vector<std::string> words = {VERIDYN_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::array<int, 2> keys{-1, -1};
  if (::pipe2(keys.data(), O_CLOEXEC) != 0) return;
  keys_ = keys[1];
  pid_ = ::fork();
  if (pid_ != 0) {
    ::close(keys[0]);
    return;
  }
  const int file = ::open(says_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(keys[0], STDIN_FILENO);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(errors.empty() ? file : ::open(errors.c_str(), O_WRONLY), STDERR_FILENO);
  ::execv(pointers[0], pointers.data());
  ::_exit(127);
}

Process::~Process() {
  if (pid_ > 0) {
    signal(SIGKILL);
    wait();
  }
  if (keys_ >= 0) ::close(keys_);
}

void Process::signal(int number) const { ::kill(pid_, number); }

void Process::press(char key) const {
  if (::write(keys_, &key, 1) != 1) ADD_FAILURE() << "the key '" << key << "' was not taken";
}

int Process::wait() {
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string Process::said() const {
  std::ifstream file(says_);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

bool Process::says(const std::string& text, double within, std::size_t from) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(within);
  while (std::chrono::steady_clock::now() < end) {
    if (said().find(text, from) != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

}  // namespace veridyn
