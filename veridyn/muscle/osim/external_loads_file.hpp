#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/model/external_load.hpp"

namespace veridyn::muscle {

/// OpenSim's ExternalLoads: which forces act on which bodies, and the file that has them over time.
struct ExternalLoadsFile {
  std::vector<ExternalLoadSource> sources;
  std::filesystem::path data;  ///< as the file names it, taken from its folder; empty: it names none
  std::vector<std::string> warnings;
};

/// Reads an ExternalLoads document of OpenSim 2 to 4. Forces that it switches off are left out. Data sources of single
/// forces and the kinematics file of old versions, which moved points before they were used, are warned of.
/// @throws InputError naming file, line and force: not XML, no ExternalLoads, a force without a body or identifiers.
[[nodiscard]] ExternalLoadsFile read_external_loads(const std::filesystem::path& path);
/// The same from text; `name` is used in messages, relative files are taken from `folder`.
[[nodiscard]] ExternalLoadsFile parse_external_loads(std::string text, std::string name,
                                                     const std::filesystem::path& folder);

/// As text that OpenSim 4 reads, with `data` as its data file.
[[nodiscard]] std::string to_external_loads_text(std::span<const ExternalLoadSource> sources, const std::string& data);

}  // namespace veridyn::muscle
