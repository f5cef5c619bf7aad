#include "apps/veridyn/live/served.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/veridyn/run/work_progress.hpp"
#include "veridyn/core/error.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"
#endif

namespace veridyn::app {

namespace fs = std::filesystem;

namespace {

/// A run that stood still for so long may still be one to stop, and is asked to for as long.
constexpr std::chrono::duration<double> kLately(30.0);

/// The newest `run_TIME.vlr` of a folder, by its name; empty where there is none.
fs::path newest_recording(const fs::path& folder) {
  fs::path newest;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("run_") && name.ends_with(".vlr") && name > newest.filename().string()) newest = entry.path();
  }
  return newest;
}

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error) && !entry.path().filename().string().starts_with(".")) all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

Served::Served(const std::vector<std::string>& what, double rate) : rate_(rate) {
  for (const std::string& each : what) {
    const fs::path path = each;
    if (!fs::exists(path)) throw InputError(each, "no such file or folder");
    if (fs::is_directory(path)) {
      folders_.push_back(path);
    } else {
      serve(path, {});
      slots_.back().run->advance(std::chrono::nanoseconds(1));
      const std::string& trouble = slots_.back().run->trouble();
      if (!trouble.empty())
        throw InputError(each, trouble.starts_with(each + ": ") ? trouble.substr(each.size() + 2) : trouble);
    }
  }
  look();
}

void Served::serve(const fs::path& recording, const fs::path& folder) {
  auto run = std::make_shared<live::RecordedRun>(recording, rate_);
  const std::lock_guard lock(mutex_);
  const auto slot =
      std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return !folder.empty() && s.folder == folder; });
  Slot made{.folder = folder, .run = std::move(run), .asked = {}};
  if (slot == slots_.end()) {
    slots_.push_back(std::move(made));
  } else {
    *slot = std::move(made);
  }
}

void Served::look_into(const fs::path& folder) {
  const fs::path recording = newest_recording(folder);
  const auto shows = [&](const Slot& s) { return s.run->path() == recording; };
  if (recording.empty() || std::any_of(slots_.begin(), slots_.end(), shows)) return;
  try {
    serve(recording, folder);
  } catch (const InputError&) {
    return;  // it went away meanwhile
  }
}

void Served::look() {
  work_.clear();
  const auto look_at = [&](const fs::path& folder) {
    look_into(folder);
    std::string& said = said_[folder];
    said = work_in(folder, said);
    if (!said.empty()) work_.push_back(said);
  };
  for (const fs::path& folder : folders_) {
    look_at(folder);
    for (const fs::path& inner : folders_in(folder)) look_at(inner);
  }
}

void Served::advance(std::chrono::nanoseconds budget) {
  for (const Slot& s : slots_) s.run->advance(budget / static_cast<long>(slots_.size()));
}

std::vector<live::ShownRun> Served::runs() {
  std::vector<live::ShownRun> all;
  for (Slot& s : slots_) {
    all.push_back(s.run->shown());
    constexpr std::chrono::seconds kPatience(2);
    if (s.run->state() == live::RigState::kStopped || (s.asked && Clock::now() - *s.asked > kLately)) s.asked.reset();
    if (!s.asked) continue;
    // A run on a busy machine loses datagrams.
    static_cast<void>(ask_to_stop(s));
    if (Clock::now() - *s.asked > kPatience)
      all.back().trouble = "it was asked to stop and has not: use its own page, keys or signal";
  }
  return all;
}

std::shared_ptr<live::RecordedRun> Served::run_at(std::size_t run) const {
  const std::lock_guard lock(mutex_);
  return run < slots_.size() ? slots_[run].run : nullptr;
}

std::string Served::frames(std::size_t run, double from, double to) const {
  const std::shared_ptr<live::RecordedRun> of = run_at(run);
  return of ? of->frames(from, to) : "[]";
}

std::string Served::platform(std::size_t run) const {
  const std::shared_ptr<live::RecordedRun> of = run_at(run);
  return of ? of->platform() : "{}";
}

bool Served::stop(std::size_t run) {
  if (run >= slots_.size() || !slots_[run].run->grows(kLately.count())) return false;
  slots_[run].asked = Clock::now();
  return ask_to_stop(slots_[run]);
}

bool Served::ask_to_stop(const Slot& slot) {
#ifdef VERIDYN_HAS_SOCKETS
  if (!slot.run->study() || slot.run->study()->telemetry.port == 0) return false;
  live::Sender to = slot.run->study()->telemetry;
  constexpr std::uint32_t kLoopback = 0x7f000001;
  if (to.address == 0) to.address = kLoopback;
  return live::UdpSocket::connected(to, "emergency stop").send(live::kEmergencyPacket);
#else
  static_cast<void>(slot);
  return false;
#endif
}

}  // namespace veridyn::app
