#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/one_input.hpp"
#include "veridyn/io/log/log_parts.hpp"
#include "veridyn/io/tables/csv_folder.hpp"

// The input is up to four tables, one after the other with a zero byte between, in a folder as ulog2csv names them.
// The first byte says which part is asked for, where it is small.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  static const std::filesystem::path folder = [] {
    std::string pattern = (std::filesystem::temp_directory_path() / "veridyn_csv_folder_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    return std::filesystem::path(pattern);
  }();
  constexpr std::array kNames{"log_vehicle_attitude_0.csv", "log_sensor_baro_1.csv", "log_x.csv", "IMU.csv"};
  veridyn::io::TableOptions options;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (!rest.empty() && rest.front() > 0 && rest.front() < 4) {
    options.part = static_cast<std::size_t>(rest.front());
    rest.remove_prefix(1);
  }
  for (const char* name : kNames) {
    const std::size_t end = rest.find('\0');
    if (rest.empty())
      std::filesystem::remove(folder / name);
    else
      std::ofstream(folder / name, std::ios::binary) << rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return veridyn::fuzz::one_input({reinterpret_cast<const char*>(data), size}, [&](std::string_view) {
    veridyn::io::Log log = veridyn::io::read_csv_folder(folder, options);
    veridyn::io::choose_part(log, options.part);
    return log;
  });
}
