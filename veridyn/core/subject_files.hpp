#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn {

/// The files from which a study takes a subject (`[subject] file`, and of [scale.model] and [cue.vehicle]), each once:
/// what `Study::parse` reads beside the text. @throws InputError as that one for what is no TOML, and a `file` that is
/// no text
[[nodiscard]] std::vector<std::filesystem::path> subject_files(std::string_view text, const std::string& name,
                                                               const std::filesystem::path& folder,
                                                               std::span<const std::string> overrides = {});

}  // namespace veridyn
