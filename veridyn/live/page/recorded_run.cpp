#include "veridyn/live/page/recorded_run.hpp"

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/live/page/platform_json.hpp"
#include "veridyn/live/page/status_json.hpp"

namespace veridyn::live {

namespace {

namespace fs = std::filesystem;

/// Bytes of statuses that are kept: a quarter of an hour at 20 Hz; of longer runs every second one, and so on.
constexpr std::size_t kMostBytes = 64U << 20U;

}  // namespace

RecordedRun::RecordedRun(const fs::path& path, double rate) : file_(path), apart_(1.0 / rate) {
  std::error_code error;
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, error);
  if (!error) grew_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(std::max(age, decltype(age)::zero()));
}

bool RecordedRun::grows(double within) const {
  return trouble_.empty() && grew_ && Clock::now() - *grew_ < std::chrono::duration<double>(within);
}

void RecordedRun::advance(Clock::duration budget) {
  const Clock::time_point end = Clock::now() + budget;
  try {
    while (trouble_.empty()) {
      if (!file_.read([this](const LiveRecord& record) { take(record); })) {
        caught_up_ = true;
        break;
      }
      if (caught_up_) grew_ = Clock::now();
      if (Clock::now() >= end) break;
    }
  } catch (const InputError& error) {
    trouble_ = error.what();
  }
}

void RecordedRun::begin() {
  study_ = recorded_study(*file_.head());
  rig_ = std::make_unique<RecordedRig>(*study_, *file_.head());
  felt_.emplace(study_->cueing);
  const std::lock_guard lock(mutex_);
  platform_ = platform_json(study_->cueing.platform);
}

std::string RecordedRun::platform() const {
  const std::lock_guard lock(mutex_);
  return platform_;
}

void RecordedRun::take(const LiveRecord& record) {
  if (!rig_) begin();
  if (rig_->take(record).step == nullptr) return;
  length_ = seconds(record.time - file_.head()->started);
  const bool due = frames_.empty() || length_ - frames_.back().time >= apart_ - 1e-6;
  constexpr double kFeltApart = 0.02;  // [s]
  if (!due && length_ - felt_at_ < kFeltApart) return;
  felt_at_ = length_;
  const RigStatus status = rig_->status();
  felt_->update(status);
  if (due) keep(status, length_);
}

void RecordedRun::keep(const RigStatus& status, double time) {
  std::string json = status_json(status, *study_, *felt_, rig_->design(), time, drift_warning(status.drift));
  const std::lock_guard lock(mutex_);
  bytes_ += json.size();
  frames_.push_back({time, std::move(json)});
  if (bytes_ <= kMostBytes) return;
  apart_ *= 2.0;
  std::size_t kept = 0;
  bytes_ = 0;
  for (std::size_t k = 0; k < frames_.size(); k += 2) {
    if (kept != k) frames_[kept] = std::move(frames_[k]);
    bytes_ += frames_[kept++].json.size();
  }
  frames_.resize(kept);
}

ShownRun RecordedRun::shown() {
  const Clock::time_point now = Clock::now();
  const double passed = looked_ ? std::chrono::duration<double>(now - *looked_).count() : 0.0;
  looked_ = now;
  ShownRun s{.name = path().string(), .trouble = trouble_, .length = length_, .grows = grows(), .kept = true};
  // Behind by a block and a half, evenly.
  constexpr double kBehind = 0.4, kOff = 0.3;  // [s]
  shown_at_ = s.grows ? std::min(length_, shown_at_ + passed) : length_;
  if (s.grows && shown_at_ < length_ - kBehind - kOff) shown_at_ = std::max(0.0, length_ - kBehind);
  if (!caught_up_ && trouble_.empty()) s.trouble = "still being read";
  const std::lock_guard lock(mutex_);
  const auto after =
      std::upper_bound(frames_.begin(), frames_.end(), shown_at_, [](double t, const Frame& f) { return t < f.time; });
  if (after != frames_.begin()) s.status = std::prev(after)->json;
  return s;
}

std::string RecordedRun::frames(double from, double to) const {
  constexpr std::size_t kFramesSent = 200;
  const std::lock_guard lock(mutex_);
  auto at = std::upper_bound(frames_.begin(), frames_.end(), from, [](double t, const Frame& f) { return t < f.time; });
  if (at != frames_.begin()) --at;
  std::string all = "[";
  for (std::size_t n = 0; n < kFramesSent && at != frames_.end() && (n == 0 || at->time <= to); ++n, ++at) {
    if (n > 0) all += ",";
    all += at->json;
  }
  return all + "]";
}

}  // namespace veridyn::live
