// run.json: what a run was made from and what it wrote.
#include "apps/veridyn/run/run_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/uuid/detail/sha1.hpp>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/veridyn/run/summary.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::app {
namespace {

namespace fs = std::filesystem;

/// What the commands of versions before 0.4.0, whose run.json does not say so, wrote.
std::vector<std::string> results_before_lists(const std::string& command) {
  static const std::vector<std::string> identification = {
      "report.html",      "estimate.json",     "parameters.csv",    "subject.toml",     "flight.csv",
      "coefficients.csv", "validation.csv",    "methods.csv",       "structure.csv",    "coefficient_uncertainty.csv",
      "jsbsim.xml",       "sensor_errors.csv", "filter_errors.csv", "calibration.toml", "residuals.csv",
      "recording.csv",    "truth.csv",         "run.json"};
  static const std::map<std::string, std::vector<std::string>> known = {
      {"identify", identification},
      {"validate", identification},
      {"demo", identification},
      {"reconstruct",
       {"report.html", "flight.csv", "filter.csv", "sensor_errors.csv", "filter_errors.csv", "run.json"}},
      {"track", {"report.html", "track.csv", "changes.csv", "filter.csv", "models.csv", "estimate.json", "run.json"}},
      {"export", {"model.json", "subject.toml", "model.csv", "jsbsim.xml", "run.json"}},
      {"scale", {"report.html", "groups.csv", "scaled.toml", "prototype.csv", "model.csv", "run.json"}},
      {"reproduce", {"report.html", "reproduction.json", "run.json"}},
      {"simulate",
       {"report.html", "recording.csv", "truth.csv", "subject.toml", "motion.csv", "metrics.csv", "muscles.csv",
        "states.sto", "controls.sto", "model.osim", "run.json"}}};
  const auto found = known.find(command);
  return found == known.end() ? std::vector<std::string>() : found->second;
}

bool is_result(const fs::path& folder, const std::string& name) {
  if (name.empty() || name == "study.toml" || fs::path(name).filename() != fs::path(name)) return false;
  std::error_code error;
  return fs::symlink_status(folder / name, error).type() == fs::file_type::regular;
}

std::string in_hexadecimal(boost::uuids::detail::sha1& hash) {
  unsigned int digest[5];
  hash.get_digest(digest);
  std::string text;
  for (const unsigned int word : digest) text += fmt::format("{:08x}", word);
  return text;
}

/// Of the names of its files and the SHA-1 of each.
std::string sha1_of_folder(const fs::path& folder, const std::atomic<bool>* stop) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  boost::uuids::detail::sha1 hash;
  for (const fs::path& file : files) {
    const std::string line = fmt::format("{} {}\n", sha1_of(file, stop), file.filename().string());
    hash.process_bytes(line.data(), line.size());
  }
  return in_hexadecimal(hash);
}

}  // namespace

std::string sha1_of(const fs::path& path, const std::atomic<bool>* stop) {
  if (fs::is_directory(path)) return sha1_of_folder(path, stop);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), "cannot be read");
  boost::uuids::detail::sha1 hash;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())), file.gcount() > 0) {
    if (stop != nullptr && *stop) break;
    hash.process_bytes(block.data(), at(file.gcount()));
  }
  return in_hexadecimal(hash);
}

std::string run_json(const RunRecord& run, const CommonOptions& options, const std::vector<HashedInput>& inputs,
                     const std::vector<std::string>& files) {
  Summary json;
  json["program"] = "veridyn";
  json["version"] = version();
  json["command"] = run.command;
  json["study"] = run.study_name;
  json["overrides"] = options.overrides;
  json["seed"] = run.seed;
  json["threads"] = options.threads;
  json["inputs"] = Summary::array();
  for (const HashedInput& input : inputs)
    json["inputs"].push_back(Summary::object({{"file", input.name}, {"sha1", input.sha1}}));
  json["files"] = files;
  json["study_after_overrides"] = run.study_toml;
  return json.to_json() + "\n";
}

std::vector<std::string> files_of_earlier_run(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "run.json", error)) return {};
  const auto json = nlohmann::json::parse(read_file(folder / "run.json"), nullptr, false);
  const auto text = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  if (text("program") != "veridyn") return {};
  std::vector<std::string> files;
  if (json.contains("files") && json["files"].is_array()) {
    for (const auto& file : json["files"]) {
      if (file.is_string()) files.push_back(file.get<std::string>());
    }
  } else {
    files = results_before_lists(text("verb"));  // what those versions called the command
  }
  std::erase_if(files, [&](const std::string& name) { return !is_result(folder, name); });
  return files;
}

}  // namespace veridyn::app
