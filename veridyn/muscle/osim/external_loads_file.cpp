#include "veridyn/muscle/osim/external_loads_file.hpp"

#include <fmt/format.h>

#include <string_view>

#include "veridyn/core/files.hpp"
#include "veridyn/muscle/osim/osim_element.hpp"

namespace veridyn::muscle {
namespace {

using osim::Document;
using osim::Element;

/// "Unassigned" is OpenSim's word for an empty text.
std::string named_or(const Element& e, const char* property, const std::string& otherwise) {
  std::string text = e.text_or(property, otherwise);
  if (text.empty() || text == "Unassigned") return otherwise;
  return text;
}

ExternalLoadSource source_of(const Element& e, std::vector<std::string>& warnings) {
  ExternalLoadSource source;
  source.name = e.name();
  source.place = e.place();
  source.body = named_or(e, "applied_to_body", "");
  if (source.body.empty()) e.fail("applied_to_body", "names no body");
  source.force_frame = named_or(e, "force_expressed_in_body", "ground");
  source.point_frame = named_or(e, "point_expressed_in_body", "ground");
  source.force = named_or(e, "force_identifier", "");
  source.point = named_or(e, "point_identifier", "");
  source.moment = named_or(e, "torque_identifier", "");
  if (source.force.empty() && source.moment.empty())
    e.fail("force_identifier", "neither force_identifier nor torque_identifier names columns");
  if (source.force.empty() && !source.point.empty())
    warnings.push_back(fmt::format("{}: point_identifier without force_identifier has no effect", source.place));
  if (const std::string data = named_or(e, "data_source_name", ""); !data.empty())
    warnings.push_back(fmt::format("{}: data_source_name '{}' is not used; its columns are those of the datafile",
                                   source.place, data));
  return source;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

ExternalLoadsFile parse_external_loads(std::string text, std::string name, const std::filesystem::path& folder) {
  const Document document(std::move(text), std::move(name), "ExternalLoads");
  const Element root(document, document.model());
  ExternalLoadsFile file;
  if (const std::string data = named_or(root, "datafile", ""); !data.empty()) file.data = folder / data;
  if (const std::string moved = named_or(root, "external_loads_model_kinematics_file", ""); !moved.empty())
    file.warnings.push_back(fmt::format(
        "{}: external_loads_model_kinematics_file '{}' is not used: points are where point_expressed_in_body has them",
        document.name(), moved));
  for (const pugi::xml_node node : document.model().child("objects").children()) {
    if (node.type() != pugi::node_element) continue;
    const Element e(document, node);
    if (e.type() != "ExternalForce") {
      file.warnings.push_back(fmt::format("{}: not used, only ExternalForce is", e.place()));
      continue;
    }
    if (e.flag_or("appliesForce", true) && !e.flag_or("isDisabled", false))
      file.sources.push_back(source_of(e, file.warnings));
  }
  if (file.sources.empty()) file.warnings.push_back(fmt::format("{}: holds no force that acts", document.name()));
  return file;
}

ExternalLoadsFile read_external_loads(const std::filesystem::path& path) {
  return parse_external_loads(read_file(path), path.string(), path.parent_path());
}

std::string to_external_loads_text(std::span<const ExternalLoadSource> sources, const std::string& data) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\" ?>\n<OpenSimDocument Version=\"40000\">\n"
      "\t<ExternalLoads name=\"external_loads\">\n\t\t<objects>\n";
  for (const ExternalLoadSource& s : sources) {
    text += fmt::format("\t\t\t<ExternalForce name=\"{}\">\n", escaped(s.name));
    const auto property = [&](const char* name, const std::string& value) {
      text += fmt::format("\t\t\t\t<{}>{}</{}>\n", name, escaped(value), name);
    };
    property("applied_to_body", s.body);
    property("force_expressed_in_body", s.force_frame);
    property("point_expressed_in_body", s.point_frame);
    property("force_identifier", s.force);
    property("point_identifier", s.point);
    property("torque_identifier", s.moment);
    text += "\t\t\t</ExternalForce>\n";
  }
  return text + fmt::format(
                    "\t\t</objects>\n\t\t<groups />\n\t\t<datafile>{}</datafile>\n\t</ExternalLoads>\n"
                    "</OpenSimDocument>\n",
                    escaped(data));
}

}  // namespace veridyn::muscle
