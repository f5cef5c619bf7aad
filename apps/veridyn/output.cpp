#include "apps/veridyn/output.hpp"

#include <fmt/format.h>

#include <boost/uuid/detail/sha1.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::app {
namespace {

std::string sha1_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), "cannot be read");
  boost::uuids::detail::sha1 hash;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())), file.gcount() > 0) {
    hash.process_bytes(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  unsigned int digest[5];
  hash.get_digest(digest);
  std::string text;
  for (const unsigned int word : digest) text += fmt::format("{:08x}", word);
  return text;
}

}  // namespace

void write_run_record(const std::filesystem::path& folder, const RunRecord& run, const CommonOptions& options) {
  nlohmann::ordered_json json;
  json["program"] = "veridyn";
  json["version"] = VERIDYN_VERSION;
  json["verb"] = run.verb;
  json["study"] = run.study_name;
  json["overrides"] = options.overrides;
  json["seed"] = run.seed;
  json["threads"] = options.threads;
  json["inputs"] = nlohmann::ordered_json::array();
  for (const std::filesystem::path& input : run.inputs) {
    json["inputs"].push_back({{"file", input.string()}, {"sha1", sha1_of(input)}});
  }
  json["study_after_overrides"] = run.study_toml;
  write_file(folder / "run.json", json.dump(2) + "\n");
}

void print_summary(const nlohmann::ordered_json& summary, const CommonOptions& options) {
  if (options.json) fmt::print("{}\n", summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void tell(const CommonOptions& options, const std::string& line) {
  if (!options.quiet) fmt::print(stderr, "{}\n", line);
}

}  // namespace veridyn::app
