#include "veridyn/muscle/osim/osim_element.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle::osim {
namespace {

std::size_t line_of(std::string_view text, std::ptrdiff_t offset) {
  const auto end = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text)));
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + end, '\n'));
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  constexpr std::string_view kBlank = " \t\r\n,()";
  for (std::size_t begin = text.find_first_not_of(kBlank); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
    words.emplace_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlank, end);
  }
  return words;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  return std::string(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "");
}

/// Formats before 2.0 have other elements; OpenSim itself no longer reads them.
[[noreturn]] void refuse_old_format(const std::string& name, const std::string& version) {
  throw InputError(name, fmt::format("is an OpenSim model of {}, older than what is read (2.0 and later); open it in "
                                     "OpenSim 2 or 3 and save it",
                                     version));
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte > 0x7e) c = '?';
  }
  return text;
}

std::string last_part(std::string_view path) {
  while (!path.empty() && path.back() == '/') path.remove_suffix(1);
  const std::size_t slash = path.rfind('/');
  return std::string(slash == std::string_view::npos ? path : path.substr(slash + 1));
}

Document::Document(std::string text, std::string name, const char* type)
    : text_(std::move(text)), name_(std::move(name)), parsed_(text_) {
  if (text_.find('\0') != std::string::npos) {
    throw InputError(fmt::format("{}:{}", name_, line_of(text_, std::ssize(text_.substr(0, text_.find('\0'))))),
                     "holds a zero byte, so it is not an XML file");
  }
  const pugi::xml_parse_result result =
      tree_.load_buffer_inplace(parsed_.data(), parsed_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    throw InputError(fmt::format("{}:{}", name_, line_of(text_, result.offset)),
                     fmt::format("not well-formed XML: {}", result.description()));
  }
  const pugi::xml_node root = tree_.child("OpenSimDocument");
  if (!root) {
    // Formats up to 1.9 had the model as their root.
    for (const char* old : {"Model", "SimbodyModel", "SimmModel", "ActuatedModel_SDFast"})
      if (tree_.child(old)) refuse_old_format(name_, "format 1.9 or older");
    throw InputError(name_, fmt::format("has no OpenSimDocument element, so it is not an OpenSim {}",
                                        std::strcmp(type, "Model") == 0 ? "model" : type));
  }
  version_ = root.attribute("Version").as_int();
  if (version_ > 0 && version_ < 20000)
    refuse_old_format(name_, fmt::format("format {}.{}", version_ / 10000, version_ / 100 % 100));
  model_ = root.child(type);
  if (!model_) throw InputError(name_, fmt::format("its OpenSimDocument holds no {}", type));
  defaults_ = model_.child("defaults");
  if (!defaults_) defaults_ = root.child("defaults");
}

pugi::xml_node Document::defaults(const char* type) const { return defaults_.child(type); }

std::string Document::place(pugi::xml_node node) const {
  std::string object = node.name();
  if (const char* name = node.attribute("name").value(); *name != '\0')
    object += fmt::format(" '{}'", one_line(shortened(name)));
  return fmt::format("{}:{}: {}", name_, line_of(text_, node.offset_debug()), object);
}

void Element::fail(std::string_view property, std::string_view what) const {
  throw InputError(place(), one_line(fmt::format("{}: {}", property, what)));
}

pugi::xml_node Element::property(const char* name) const {
  if (const pugi::xml_node child = node_.child(name)) return child;
  return document_->defaults(node_.name()).child(name);
}

std::string Element::text_or(const char* name, std::string_view otherwise) const {
  const pugi::xml_node found = property(name);
  if (!found) return std::string(otherwise);
  std::string_view text = found.text().get();
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1));
}

std::vector<std::string> Element::words(const char* name) const { return split(property(name).text().get()); }

bool Element::flag_or(const char* name, bool otherwise) const {
  std::string text = text_or(name, "");
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (text.empty()) return otherwise;
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  fail(name, fmt::format("'{}' is neither true nor false", shortened(text)));
}

std::vector<double> Element::numbers(const char* name) const {
  std::vector<double> values;
  for (const std::string& word : words(name)) {
    double value = 0.0;
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      fail(name, fmt::format("'{}' is not a number", shortened(word)));
    }
    if (!std::isfinite(value)) fail(name, fmt::format("'{}' is not a finite number", shortened(word)));
    values.push_back(value);
  }
  return values;
}

double Element::number_or(const char* name, double otherwise) const {
  const std::vector<double> values = numbers(name);
  if (values.empty()) return otherwise;
  if (values.size() > 1) fail(name, fmt::format("{} numbers where one is expected", values.size()));
  return values.front();
}

double Element::not_negative_or(const char* name, double otherwise) const {
  const double value = number_or(name, otherwise);
  if (value < 0.0) fail(name, fmt::format("{} must not be negative", value));
  return value;
}

double Element::positive_or(const char* name, double otherwise) const {
  const double value = number_or(name, otherwise);
  if (!(value > 0.0)) fail(name, fmt::format("{} must be > 0", value));
  return value;
}

Eigen::Vector3d Element::vector_or(const char* name, const Eigen::Vector3d& otherwise) const {
  const std::vector<double> values = numbers(name);
  if (values.empty()) return otherwise;
  if (values.size() != 3) fail(name, fmt::format("{} numbers where three are expected", values.size()));
  return {values[0], values[1], values[2]};
}

std::vector<Element> Element::objects(const char* set) const {
  pugi::xml_node list = property(set);
  if (const pugi::xml_node objects = list.child("objects")) list = objects;
  std::vector<Element> elements;
  for (const pugi::xml_node child : list.children()) {
    if (child.type() == pugi::node_element && std::strcmp(child.name(), "groups") != 0) {
      elements.emplace_back(*document_, child);
    }
  }
  return elements;
}

}  // namespace veridyn::muscle::osim
