#include "tests/support/folders.hpp"

namespace veridyn::test {

std::filesystem::path source_folder() { return VERIDYN_SOURCE_DIR; }
std::filesystem::path shared_folder() { return source_folder() / ".." / "shared"; }

}  // namespace veridyn::test
