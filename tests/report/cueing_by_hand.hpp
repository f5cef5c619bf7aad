#pragma once

#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/cueing_study.hpp"

namespace veridyn::report::test {

/// What an algorithm made of a drive in which surge and roll are felt above thresholds of 0.1 m/s^2 and 3 deg/s, and
/// nothing else. The correlation of surge is `pearson`, without an interval.
inline cueing::AlgorithmResult algorithm_by_hand(std::string name, double pearson) {
  using cueing::Cue;
  cueing::AlgorithmResult a;
  a.run.algorithm = std::move(name);
  a.felt.time = {0.0, 1.0, 2.0};
  for (const Cue cue : cueing::kAllCues) {
    a.felt.threshold[cue] = cue < Cue::kRoll ? 0.1 : 3.0 * kDegree;
    a.felt.felt[cue] = {.vehicle = {0.0, 0.05, 0.0}, .platform = {0.0, 0.0, 0.0}};
    a.score.cues[cue].pearson = {.value = kNaN, .low = kNaN, .high = kNaN};
  }
  a.felt.felt[Cue::kSurge] = {.vehicle = {0.0, -2.0, 0.0}, .platform = {0.0, -1.0, 0.0}};
  a.felt.felt[Cue::kRoll] = {.vehicle = {0.0, 6.0 * kDegree, 0.0}, .platform = {0.0, 3.0 * kDegree, 0.0}};
  a.score.cues[Cue::kSurge].pearson = {.value = pearson, .low = kNaN, .high = kNaN};
  for (std::size_t k = 0; k < a.felt.time.size(); ++k)
    a.run.steps.push_back({.desired = {}, .ordered = {}, .reached = {}});
  return a;
}

inline cueing::CueingResult cueing_by_hand(const std::vector<std::pair<std::string, double>>& algorithms) {
  cueing::CueingResult result;
  for (const auto& [name, pearson] : algorithms) result.algorithms.push_back(algorithm_by_hand(name, pearson));
  return result;
}

}  // namespace veridyn::report::test
