#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"

namespace veridyn::muscle {

/// What becomes of one model file: is it read, does it move, and what is missing.
struct ModelCheck {
  std::filesystem::path file;
  int version = 0;  ///< of the document
  std::size_t bodies = 0, coordinates = 0, muscles = 0;
  bool loads = false;
  bool simulates = false;
  std::string trouble;               ///< why it does not load or simulate; empty: it does both
  std::vector<std::string> missing;  ///< elements that are not understood, "HuntCrossleyForce 'contact'"
  std::size_t warnings = 0;
};

/// Reads a model and simulates it from its default pose with constant excitations of 0.05 for `duration` seconds.
/// Elements that are not understood and would change the motion are reasons not to simulate. Never throws for what is
/// in the file.
[[nodiscard]] ModelCheck check_model(const std::filesystem::path& file, Progress& progress, double duration = 0.2);

/// The .osim files of a folder and of the folders in it, by name.
[[nodiscard]] std::vector<std::filesystem::path> model_files(const std::filesystem::path& folder);

/// A table for people, a row a file, and a line of totals.
[[nodiscard]] std::string model_check_table(std::span<const ModelCheck> checks, const std::filesystem::path& folder);

}  // namespace veridyn::muscle
