#include "veridyn/numerics/batches/companions.hpp"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

namespace veridyn::numerics {
namespace {

/// A process that was never seen is waited for by so many times the patience.
constexpr double kToBeStarted = 5.0;

std::string alive_name(std::size_t index) { return fmt::format("process-{}.alive", index + 1); }

}  // namespace

Companions::Companions(std::filesystem::path folder, const ProcessShare& share)
    : folder_(std::move(folder)), share_(share) {
  if (share_.wait) heartbeat_ = std::make_unique<Heartbeat>(folder_ / alive_name(share_.index));
}

double Companions::wait_for(std::size_t owner, std::string_view missing) {
  const auto now = std::chrono::steady_clock::now();
  Watch& watch = watches_.try_emplace(owner, Watch{HeartbeatWatch(folder_ / alive_name(owner)), now}).first->second;
  const double silence = watch.beat.silence().count();
  if (watch.beat.who().empty()) {
    // Jobs of an array do not start at one time.
    if (silence > kToBeStarted * share_.patience_s)
      throw std::runtime_error(fmt::format(
          "{}: process {} of {} was never seen in {:g} s, and {}; start all {} at the same time", folder_.string(),
          owner + 1, share_.count, kToBeStarted * share_.patience_s, missing, share_.count));
  } else if (silence > share_.patience_s) {
    throw std::runtime_error(
        fmt::format("{}: process {} of {} ({}) has shown no life for {:g} s, and {}; run again to "
                    "go on",
                    folder_.string(), owner + 1, share_.count, watch.beat.who(), share_.patience_s, missing));
  }
  return std::chrono::duration<double>(now - watch.since).count();
}

void Companions::arrived(std::size_t owner) { watches_.erase(owner); }

}  // namespace veridyn::numerics
