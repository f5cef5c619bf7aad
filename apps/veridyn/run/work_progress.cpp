#include "apps/veridyn/run/work_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/results/json_text.hpp"

namespace veridyn::app {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

std::string machine() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : std::string();
}

std::optional<json> object_in(const fs::path& file) {
  try {
    json object = json::parse(read_file(file), nullptr, false);
    if (object.is_object()) return object;
  } catch (const InputError&) {
    return std::nullopt;  // it went away meanwhile
  }
  return std::nullopt;
}

/// The progress of a command that computes in the folder: of the newest one, where there are several.
std::optional<json> progress_in(const fs::path& folder) {
  std::optional<json> newest;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".veridyn-") || !name.ends_with(".part")) continue;
    std::optional<json> found = object_in(entry.path() / kProgressFile);
    if (found && found->value("program", "") == "veridyn" &&
        (!newest || newest->value("started", 0.0) < found->value("started", 0.0)))
      newest = std::move(found);
  }
  return newest;
}

bool was_killed(const json& progress) {
  const pid_t id = progress.value("process", 0);
  return id > 0 && progress.value("machine", "") == machine() && ::kill(id, 0) != 0 && errno == ESRCH;
}

/// When the results in a folder were written; 0 where there are none.
double results_of(const fs::path& folder) {
  std::error_code error;
  const auto written = fs::last_write_time(folder / "run.json", error);
  return error ? 0.0 : std::chrono::duration<double>(written.time_since_epoch()).count();
}

json going_on(const fs::path& folder, const json& p) {
  const double fraction = p.value("fraction", 0.0), began = p.value("stage_began", 0.0),
               written = p.value("written", 0.0), now = now_s();
  // A first guess from the very beginning would be noise.
  constexpr double kKnown = 0.02;
  json j = {{"folder", folder.string()},
            {"state", was_killed(p) ? "was killed" : "goes on"},
            {"elapsed", std::max(0.0, now - p.value("started", now))},
            {"age", std::max(0.0, now - written)},
            {"remaining", nullptr},
            {"of", results_of(folder)}};
  if (fraction > kKnown) j["remaining"] = std::max(0.0, (written - began) * (1.0 / fraction - 1.0));
  for (const char* key : {"command", "study", "stage", "stages", "fraction", "note"})
    j[key] = p.contains(key) ? p[key] : json();
  return j;
}

}  // namespace

WorkProgress::WorkProgress(const StudyRun& run, OutputFolder* folder)
    : TerminalProgress(run.options().quiet, run.options().threads, run.options().interruption),
      file_(folder != nullptr ? folder->aside(kProgressFile) : fs::path()),
      command_(run.command),
      study_(run.study.name()),
      started_(now_s()) {
  quiet_stage("reading the study");
}

void WorkProgress::stage(std::string_view name) {
  quiet_stage(name);
  TerminalProgress::stage(name);  // whoever reads it there finds it in the file
}

void WorkProgress::quiet_stage(std::string_view name) {
  stage_ = name;
  ++stages_;
  fraction_ = 0.0;
  stage_began_ = now_s();
  write();
}

bool WorkProgress::update(double fraction) {
  constexpr std::chrono::milliseconds kBetween(500);
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  if (!file_.empty() && Clock::now() - written_ > kBetween) write();
  return TerminalProgress::update(fraction);
}

void WorkProgress::note(std::string text) {
  note_ = std::move(text);
  write();
}

void WorkProgress::write() {
  if (file_.empty()) return;
  written_ = Clock::now();
  const json j = {{"program", "veridyn"}, {"command", command_},         {"study", study_},
                  {"stage", stage_},      {"stages", stages_},           {"fraction", fraction_},
                  {"started", started_},  {"stage_began", stage_began_}, {"written", now_s()},
                  {"note", note_},        {"process", ::getpid()},       {"machine", machine()}};
  try {
    write_file(file_, io::json_text(j));
  } catch (const std::exception&) {
    file_.clear();  // what the command computes matters more
  }
}

std::string work_in(const fs::path& folder, const std::string& before) {
  const json last = before.empty() ? json::object() : json::parse(before, nullptr, false);
  if (const std::optional<json> p = progress_in(folder)) return io::json_text(going_on(folder, *p));
  const double of = results_of(folder);
  // What is there may be of a run before the one that went on.
  if (last.value("state", "") == "goes on" && of == last.value("of", 0.0)) {
    json j = last;
    j["state"] = "ended without results";
    return io::json_text(j);
  }
  if (of == 0.0 || last.value("of", 0.0) == of) return before;
  const std::optional<json> run = object_in(folder / "run.json");
  if (!run || run->value("program", "") != "veridyn") return before;
  return io::json_text(json{{"folder", folder.string()},
                            {"command", run->value("command", "")},
                            {"study", run->value("study", "")},
                            {"state", "done"},
                            {"note", last.value("note", "")},
                            {"of", of}});
}

}  // namespace veridyn::app
