#include "veridyn/muscle/osim/builtin_models.hpp"

#include <fmt/format.h>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::muscle {

OsimFile load_model(const std::string& name_or_path) {
  std::vector<std::string> names;
  for (const EmbeddedText& model : builtin_models()) {
    if (model.name == name_or_path)
      return OsimFile::parse(std::string(model.text), fmt::format("built-in model {}", model.name));
    names.emplace_back(model.name);
  }
  if (name_or_path.find('.') == std::string::npos && name_or_path.find('/') == std::string::npos) {
    throw InputError(name_or_path, fmt::format("there is no built-in model of this name{}; a file ends in .osim",
                                               suggestion(name_or_path, names)));
  }
  return OsimFile::load(name_or_path);
}

}  // namespace veridyn::muscle
