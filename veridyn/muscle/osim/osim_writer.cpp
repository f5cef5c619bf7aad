#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

struct Edit {
  std::size_t begin = 0;
  std::size_t length = 0;
  std::string text;
};

pugi::xml_node find_muscle(const osim::Document& document, const std::string& name) {
  for (const auto& elements :
       {osim::Element(document, document.model()).objects("ForceSet"), osim::components_of(document)})
    for (const osim::Element& element : elements)
      if (osim::is_muscle(element.type()) && element.name() == name) return element.node();
  return {};
}

/// Where the text of `property` is, or where such a property can be added.
Edit edit_of(const std::string& text, pugi::xml_node muscle, const char* property, double value) {
  const std::string number = fmt::format("{}", value);
  const pugi::xml_node node = muscle.child(property);
  const auto offset = [](pugi::xml_node n) { return static_cast<std::size_t>(n.offset_debug()); };
  for (const pugi::xml_node part : node.children()) {
    if (part.type() != pugi::node_pcdata) continue;
    const std::size_t begin = offset(part);
    const std::size_t end = text.find('<', begin);
    // Blanks around the number stay.
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n", begin), end);
    const std::size_t last = text.find_last_not_of(" \t\r\n", end - 1);
    return {first, last + 1 - first, number};
  }
  const std::size_t open = text.find('>', offset(node ? node : muscle));
  if (node && text[open - 1] == '/') {  // <name />
    const std::size_t begin = text.rfind('<', open);
    return {begin, open + 1 - begin, fmt::format("<{0}>{1}</{0}>", property, number)};
  }
  if (node) return {open + 1, 0, number};
  return {open + 1, 0, fmt::format("<{0}>{1}</{0}>", property, number)};
}

}  // namespace

std::string OsimFile::text_with(const Model& changed) const {
  std::vector<Edit> edits;
  for (const Muscle& muscle : changed.muscles) {
    const int index = model_.muscle(muscle.name());
    if (index < 0) throw InputError(document_->name(), fmt::format("has no muscle '{}' to write to", muscle.name()));
    const MusculotendonParameters<double>& old = model_.muscles[index].parameters.musculotendon;
    const pugi::xml_node node = find_muscle(*document_, muscle.name());
    for (std::size_t i = 0; i < kMusculotendonFields.size(); ++i) {
      const double value = field_of(muscle.parameters.musculotendon, i);
      if (value != field_of(old, i)) {
        constexpr std::size_t kVmax = 4;
        if (osim::is_schutte(node.name()) && i >= kVmax)
          throw InputError(document_->place(node),
                           fmt::format("has no {} that could be written", kMusculotendonFields[i].name));
        edits.push_back(edit_of(document_->text(), node, kMusculotendonFields[i].name, value));
      }
    }
  }
  std::stable_sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
  std::string text;
  std::size_t at = 0;
  for (const Edit& edit : edits) {
    text.append(document_->text(), at, edit.begin - at);
    text += edit.text;
    at = edit.begin + edit.length;
  }
  text.append(document_->text(), at, std::string::npos);
  return text;
}

void OsimFile::write(const Model& changed, const std::filesystem::path& path) const {
  write_file(path, text_with(changed));
}

}  // namespace veridyn::muscle
