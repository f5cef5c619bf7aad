#include "veridyn/cueing/score/false_cues.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace veridyn::cueing {
namespace {

constexpr double kShortest = 0.1, kApart = 0.1;  // [s]

std::optional<FalseCue::Kind> kind_of(double vehicle, double platform, double threshold) {
  if (std::abs(platform - vehicle) <= threshold) return std::nullopt;
  if (std::abs(platform) > threshold) {
    if (vehicle * platform < 0.0) return FalseCue::Kind::kWrongSign;
    if (std::abs(platform) > 2.0 * std::abs(vehicle)) return FalseCue::Kind::kTooStrong;
    return std::nullopt;
  }
  if (std::abs(vehicle) > 2.0 * threshold) return FalseCue::Kind::kMissing;
  return std::nullopt;
}

}  // namespace

std::string_view name_of(FalseCue::Kind kind) {
  switch (kind) {
    case FalseCue::Kind::kWrongSign:
      return "wrong sign";
    case FalseCue::Kind::kTooStrong:
      return "too strong";
    case FalseCue::Kind::kMissing:
      break;
  }
  return "missing";
}

std::vector<FalseCue> false_cues(Cue cue, std::span<const double> vehicle, std::span<const double> platform,
                                 double threshold, double begin, double step) {
  std::vector<FalseCue> found;
  for (const FalseCue::Kind kind : {FalseCue::Kind::kWrongSign, FalseCue::Kind::kTooStrong, FalseCue::Kind::kMissing}) {
    std::vector<FalseCue> of_kind;
    for (std::size_t k = 0; k < vehicle.size(); ++k) {
      if (kind_of(vehicle[k], platform[k], threshold) != kind) continue;
      const double t = begin + step * static_cast<double>(k), size = std::abs(platform[k] - vehicle[k]);
      if (of_kind.empty() || t - of_kind.back().end > kApart) {
        of_kind.push_back({cue, kind, t, t + step, size});
      } else {
        of_kind.back().end = t + step;
        of_kind.back().size = std::max(of_kind.back().size, size);
      }
    }
    std::copy_if(of_kind.begin(), of_kind.end(), std::back_inserter(found),
                 [](const FalseCue& f) { return f.end - f.begin >= kShortest; });
  }
  std::sort(found.begin(), found.end(), [](const FalseCue& a, const FalseCue& b) { return a.begin < b.begin; });
  return found;
}

}  // namespace veridyn::cueing
