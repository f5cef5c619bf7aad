#include "veridyn/core/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  if (path.empty()) throw InputError("file", "its name is empty");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path.string(), "no such file");
  if (fs::is_directory(status)) throw InputError(path.string(), "is a directory, expected a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string content;
  if (fs::is_regular_file(status)) {
    content.resize(fs::file_size(path));
    file.read(content.data(), static_cast<std::streamsize>(content.size()));
    content.resize(at(file.gcount()));
  } else {
    content.assign(std::istreambuf_iterator<char>(file), {});
  }
  if (file.bad()) throw InputError(path.string(), "cannot be read to its end");
  return content;
}

void write_file(const fs::path& path, std::string_view content, std::string_view shown) {
  const fs::path temporary = fmt::format("{}.{}.part", path.string(), ::getpid());
  const auto fail = [&](int error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    const std::string name = shown.empty() ? path.string() : std::string(shown);
    const std::string what = fmt::format("cannot be written: {}", std::strerror(error));
    if (error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO)
      throw std::runtime_error(fmt::format("{}: {}", name, what));
    throw InputError(name, what);
  };
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  if (!file) fail(errno);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) fail(errno);
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) fail(error.value());
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return;
  if (fs::exists(path, ignored)) throw InputError(path.string(), "is a file, expected a folder");
  throw InputError(path.string(), fmt::format("cannot be made: {}", error.message()));
}

}  // namespace veridyn
