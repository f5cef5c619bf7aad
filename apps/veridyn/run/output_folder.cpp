#include "apps/veridyn/run/output_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::app {

namespace fs = std::filesystem;

namespace {

/// The folders on the way to `path` that are not there, innermost first.
std::vector<fs::path> missing_folders(const fs::path& path) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path at = fs::absolute(path, error).lexically_normal(); !at.empty() && !fs::exists(at, error);
       at = at.parent_path()) {
    if (at.has_filename()) missing.push_back(at);
    if (at == at.parent_path()) break;
  }
  return missing;
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

/// While it lives SIGINT and SIGTERM do nothing.
class SignalsIgnored {
 public:
  SignalsIgnored() = default;
  SignalsIgnored(const SignalsIgnored&) = delete;
  SignalsIgnored& operator=(const SignalsIgnored&) = delete;
  ~SignalsIgnored() {
    std::signal(SIGINT, on_interrupt_);
    std::signal(SIGTERM, on_termination_);
  }

 private:
  using Handler = void (*)(int);
  Handler on_interrupt_ = std::signal(SIGINT, SIG_IGN);
  Handler on_termination_ = std::signal(SIGTERM, SIG_IGN);
};

}  // namespace

OutputFolder::OutputFolder(fs::path path)
    : path_(std::move(path)), staging_(path_ / fmt::format(".veridyn-{}.part", ::getpid())) {
  if (path_.empty()) throw InputError("--out", "is empty; it must name a folder");
  made_ = missing_folders(path_);
  make_folder(path_);
  if (::access(path_.c_str(), W_OK | X_OK) != 0)
    throw InputError(path_.string(), fmt::format("cannot be written to: {}", std::strerror(errno)));
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  // What was published keeps its folders: only empty ones go.
  for (const fs::path& folder : made_) fs::remove(folder, ignored);
}

fs::path OutputFolder::staged(const std::string& name) {
  if (std::find(files_.begin(), files_.end(), name) == files_.end()) files_.push_back(name);
  make_folder(staging_);
  return staging_ / name;
}

fs::path OutputFolder::aside(const std::string& name) const {
  make_folder(staging_);
  return staging_ / name;
}

void OutputFolder::write(const std::string& name, std::string_view content) {
  write_file(staged(name), content, (path_ / name).string());
}

void OutputFolder::write(const std::string& name, const std::function<void(const fs::path&)>& writer) {
  const fs::path file = staged(name);
  try {
    writer(file);
  } catch (const std::runtime_error& error) {
    std::string text = error.what();
    const std::string hidden = staging_.string();
    if (const std::size_t at = text.find(hidden); at != std::string::npos)
      text.replace(at, hidden.size(), path_.string());
    throw std::runtime_error(text);
  }
}

fs::path OutputFolder::current(const fs::path& file) const {
  for (const std::string& name : files_) {
    if (file == path_ / name) return staging_ / name;
  }
  return file;
}

void OutputFolder::publish(const RunRecord& run, const CommonOptions& options, const Summary& summary) {
  if (!run.study_to_write.empty()) write("study.toml", run.study_to_write);
  std::vector<HashedInput> inputs;
  for (const fs::path& input : run.inputs) inputs.push_back({input.string(), hashes_.of(current(input))});
  const std::string name = "run.json";
  std::vector<std::string> listed = files_;
  listed.push_back(name);
  std::erase(listed, "study.toml");  // an input that lies here
  write(name, run_json(run, options, inputs, listed));
  std::vector<std::string> stale = files_of_earlier_run(path_);
  std::erase_if(stale, [&](const std::string& file) {
    return std::find(files_.begin(), files_.end(), file) != files_.end() ||
           std::any_of(run.inputs.begin(), run.inputs.end(),
                       [&](const fs::path& input) { return same_file(input, path_ / file); });
  });
  check_names();
  print_summary(summary, options);
  // A second Ctrl-C would end the program between the files of two runs.
  const SignalsIgnored whole;
  for (const std::string& file : stale) {
    std::error_code ignored;
    fs::remove(path_ / file, ignored);
  }
  publish();
}

void OutputFolder::check_names() const {
  for (const std::string& name : files_) {
    if (fs::is_directory(path_ / name)) throw InputError((path_ / name).string(), "cannot be written: it is a folder");
  }
}

void OutputFolder::publish() {
  check_names();
  for (const std::string& name : files_) {
    std::error_code error;
    fs::rename(staging_ / name, path_ / name, error);
    if (error)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", (path_ / name).string(), error.message()));
  }
  files_.clear();
}

}  // namespace veridyn::app
