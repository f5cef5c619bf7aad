#pragma once

#include <filesystem>

namespace veridyn::test {

/// The project's own folder: examples, studies.
[[nodiscard]] std::filesystem::path source_folder();

/// Where recordings and models by others may lie. They are not part of the project: tests that read them skip where the
/// folder is missing.
[[nodiscard]] std::filesystem::path shared_folder();

}  // namespace veridyn::test
