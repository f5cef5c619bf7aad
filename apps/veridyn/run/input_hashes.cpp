#include "apps/veridyn/run/input_hashes.hpp"

#include <exception>
#include <utility>

#include "apps/veridyn/run/run_record.hpp"

namespace veridyn::app {

InputHashes::~InputHashes() { stop_ = true; }

void InputHashes::begin(std::vector<std::filesystem::path> files) {
  ahead_ = std::async(std::launch::async, [this, files = std::move(files)] {
    std::map<std::filesystem::path, std::string> hashes;
    for (const std::filesystem::path& file : files) {
      try {
        hashes.emplace(file, sha1_of(file, &stop_));
      } catch (const std::exception&) {
        // Asked for, it is refused.
      }
    }
    return hashes;
  });
}

std::string InputHashes::of(const std::filesystem::path& file) {
  if (ahead_.valid()) found_ = ahead_.get();
  const auto known = found_.find(file);
  return known != found_.end() ? known->second : sha1_of(file);
}

}  // namespace veridyn::app
