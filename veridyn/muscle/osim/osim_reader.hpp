#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

namespace osim {
class Document;
}

/// A model together with the file it was read from, so that it can be written back with nothing changed but what was
/// estimated.
class OsimFile {
 public:
  /// Reads an OpenSim model, formats 2.x to 4.x. Defaults blocks are respected; what is not understood is listed in
  /// `model().unsupported` and `model().warnings`.
  /// @throws InputError naming file, line and element: not XML, missing body or frame, several joints for a body,
  /// numbers that are not finite, negative masses and lengths, joints and functions that are not understood.
  [[nodiscard]] static OsimFile load(const std::filesystem::path& path);
  /// The same from text; `name` is used in messages.
  [[nodiscard]] static OsimFile parse(std::string text, std::string name);

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const std::string& text() const;

  /// The text of the file with the musculotendon parameters of `changed` in place of those in the file; a muscle is
  /// identified by its name. Numbers that did not change keep their bytes; a parameter that the file leaves to its
  /// defaults is added to the muscle. @throws InputError when `changed` has a muscle that the file does not.
  [[nodiscard]] std::string text_with(const Model& changed) const;
  /// Writes `text_with(changed)`, whole or not at all.
  void write(const Model& changed, const std::filesystem::path& path) const;

 private:
  OsimFile() = default;
  std::shared_ptr<const osim::Document> document_;
  Model model_;
};

/// `OsimFile::load(path).model()`
[[nodiscard]] Model read_osim(const std::filesystem::path& path);

}  // namespace veridyn::muscle
