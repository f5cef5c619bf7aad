#include "tests/apps/process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace veridyn {

Process::Process(const std::vector<std::string>& arguments, const std::filesystem::path& says) : says_(says) {
  std::filesystem::remove(says_);
  std::vector<std::string> words = {VERIDYN_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ != 0) return;
  const int file = ::open(says_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644), nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  ::execv(pointers[0], pointers.data());
  ::_exit(127);
}

Process::~Process() {
  if (pid_ <= 0) return;
  signal(SIGKILL);
  wait();
}

void Process::signal(int number) const { ::kill(pid_, number); }

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

bool Process::says(const std::string& text, double within) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(within);
  while (std::chrono::steady_clock::now() < end) {
    if (said().find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

}  // namespace veridyn
