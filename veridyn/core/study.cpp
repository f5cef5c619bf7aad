#include "veridyn/core/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_placeholders.hpp"
#include "veridyn/core/subject_files.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn {

namespace internal {

/// The whole document, shared by its tables; lives as long as any of them.
struct StudyDocument {
  toml::table root;
  std::string name;
  std::filesystem::path folder;
  std::vector<std::string> notes;
};

/// One table of the document that it keeps alive, with the keys that were read and the tables opened from it.
struct StudyNode {
  std::shared_ptr<StudyDocument> document;
  toml::table* table = nullptr;  ///< null for a table that is absent
  std::set<std::string, std::less<>> known;
  std::set<std::string, std::less<>> accepted;  ///< with all that is in them
  std::map<std::string, std::vector<std::pair<std::string, std::shared_ptr<StudyNode>>>, std::less<>> opened;
};

}  // namespace internal

namespace {

using internal::StudyDocument;
using internal::StudyNode;

std::string dotted(std::string_view path, std::string_view key) {
  if (path.empty()) return std::string(key);
  return key.empty() ? std::string(path) : fmt::format("{}.{}", path, key);
}

std::string_view kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::none:
      return "nothing";
    default:
      return "a date or time";
  }
}

toml::node* find(const StudyNode& node, std::string_view key) {
  return node.table == nullptr ? nullptr : node.table->get(key);
}

std::string place_of(const StudyNode& node, const toml::node* at, std::string_view path, std::string_view key) {
  const toml::node* anchor = at != nullptr ? at : node.table;
  std::string name = node.document ? node.document->name : "study";
  if (anchor != nullptr && anchor->source().path) name = *anchor->source().path;
  const auto line = anchor != nullptr ? anchor->source().begin.line : 0;
  const std::string full = dotted(path, key);
  if (line == 0) return full.empty() ? name : fmt::format("{}: {}", name, full);
  return full.empty() ? fmt::format("{}:{}", name, line) : fmt::format("{}:{}: {}", name, line, full);
}

/// Refuses a placeholder, together with all others of the study.
const toml::node& filled(const StudyNode& table, const toml::node& value, const std::string& place) {
  if (!internal::is_placeholder(value)) return value;
  std::vector<internal::Placeholder> all;
  if (table.document) internal::find_placeholders(table.document->root, "", all);
  throw InputError(place, internal::placeholder_refusal(value.as_string()->get(), value.source().begin.line, all));
}

double number_with_unit(const std::string& text, std::string_view unit, const std::string& place) {
  double number = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) {
    throw InputError(place, fmt::format("'{}' is not a number with a unit, such as \"1.5 {}\"", text, unit));
  }
  const std::string_view rest(stop, at(text.data() + text.size() - stop));
  const Unit expected = parse_unit(unit);
  if (rest.find_first_not_of(" \t") == std::string_view::npos) return expected.to_si(number);
  try {
    return parse_unit_like(rest, expected).to_si(number);
  } catch (const InputError& wrong) {
    throw InputError(place, wrong.what());
  }
}

double number_from(const toml::node& node, std::string_view unit, const std::string& place) {
  double number = 0.0;
  if (const auto text = node.value_exact<std::string>()) {
    number = number_with_unit(*text, unit, place);
  } else if (node.is_number()) {
    number = *node.value<double>();
  } else {
    throw InputError(place, fmt::format("is {}, expected a number [{}]", kind_of(node), unit));
  }
  if (!std::isfinite(number))
    throw InputError(place, fmt::format("is {}, expected a finite number [{}]", number, unit));
  return number;
}

std::string text_from(const toml::node& node, const std::string& place) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  throw InputError(place, fmt::format("is {}, expected a text in quotes", kind_of(node)));
}

/// The path in a text. A relative one is from the folder of the file that states it: the study's own, or the one that
/// gave the subject. The study then holds that one whole, since what it is written to does not say where a key is from.
std::filesystem::path path_from(toml::node& node, const StudyDocument* document, const std::string& place) {
  std::filesystem::path path = text_from(node, place);
  if (path.is_absolute() || document == nullptr) return path;
  const auto& source = node.source().path;  // an override has none
  if (!source || *source == document->name) return document->folder / path;
  path = std::filesystem::absolute(std::filesystem::path(*source).parent_path() / path);
  *node.as_string() = path.string();
  return path;
}

/// A table, or an array that holds tables, with something in it.
bool holds_keys(const toml::node& node) {
  if (const toml::table* table = node.as_table()) return !table->empty();
  const toml::array* array = node.as_array();
  return array != nullptr && std::any_of(array->begin(), array->end(), holds_keys);
}

void refuse_unknown(const StudyNode& node, const std::string& path) {
  if (node.table != nullptr) {
    const std::vector<std::string> known(node.known.begin(), node.known.end());
    for (const auto& [key, value] : *node.table) {
      if (node.accepted.contains(key.str())) continue;
      const bool read = node.known.contains(key.str());
      if (read && (node.opened.contains(key.str()) || !holds_keys(value))) continue;
      throw InputError(place_of(node, &value, path, key.str()),
                       read ? "is a table that nothing reads here" : "unknown key" + suggestion(key.str(), known));
    }
  }
  for (const auto& [key, children] : node.opened) {
    if (node.accepted.contains(key)) continue;
    for (const auto& [child_path, child] : children) refuse_unknown(*child, child_path);
  }
}

toml::table parsed(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}:{}", name, error.source().begin.line, error.source().begin.column),
                     fmt::format("not TOML: {}", error.description()));
  }
}

/// Puts keys of `other` into `table` where it does not have them, in tables within as well; those of `whole` are taken
/// or left as they are.
void fill_from(toml::table& table, toml::table&& other, std::string_view whole) {
  for (auto&& [key, value] : other) {
    toml::node* own = table.get(key.str());
    if (own == nullptr) {
      table.insert(key, std::move(value));
    } else if (own->is_table() && value.is_table()) {
      toml::table& within = *own->as_table();
      if (key.str() != whole) {
        fill_from(within, std::move(*value.as_table()), whole);
        continue;
      }
      for (auto&& [part, of_part] : *value.as_table())
        if (!within.contains(part.str())) within.insert(part, std::move(of_part));
    }
  }
}

/// The tables that may name such a file.
constexpr std::array<const char*, 3> kTablesOfSubjects = {"subject", "scale.model", "cue.vehicle"};

/// Puts the keys of the [subject] in the file that `table.file` names into the table, where it does not have them
/// itself: what an identification wrote is simulated, scaled or identified again by naming its subject.toml. A
/// coefficient of `model` is the study's or the file's as a whole, as with a built-in subject.
void take_subject_of_file(toml::table& table, const std::string& path, StudyDocument& document) {
  const toml::node* named = table.get("file");
  if (named == nullptr) return;
  // An override has no line.
  const std::string place = named->source().path
                                ? fmt::format("{}:{}: {}.file", document.name, named->source().begin.line, path)
                                : fmt::format("--set {}.file", path);
  std::filesystem::path file = text_from(*named, place);
  if (file.empty()) throw InputError(place, "is empty; expected a file such as out/identify/subject.toml");
  if (file.is_relative()) file = document.folder / file;
  if (!std::filesystem::is_regular_file(file)) throw InputError(place, fmt::format("{}: no such file", file.string()));
  toml::table other = parsed(read_file(file), file.string());
  toml::table* subject = other.get("subject") == nullptr ? nullptr : other.get("subject")->as_table();
  if (subject == nullptr) throw InputError(place, fmt::format("{} has no [subject]", file.string()));
  if (subject->contains("file"))
    throw InputError(place, fmt::format("{} takes its subject from another file; name that one", file.string()));
  table.erase("file");
  fill_from(table, std::move(*subject), "model");
  document.notes.push_back(fmt::format("{}: what this table does not give is taken from {}", place, file.string()));
}

void apply_override(toml::table& root, const std::string& text) {
  const std::string place = fmt::format("--set {}", text);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw InputError(place, "expected key=value");
  const std::string key = text.substr(0, equals);
  const std::string value = text.substr(equals + 1);
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    parsed.insert_or_assign("value", value);
  }
  toml::table* at = &root;
  std::stringstream parts(key);
  std::vector<std::string> names;
  for (std::string part; std::getline(parts, part, '.');) names.push_back(part);
  if (key.back() == '.' || std::find(names.begin(), names.end(), "") != names.end())
    throw InputError(place, fmt::format("'{}' is not a key, such as data.from", key));
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    if (at->get(names[i]) == nullptr) at->insert(names[i], toml::table{});
    at = at->get(names[i])->as_table();
    if (at == nullptr) throw InputError(place, fmt::format("'{}' is not a table", names[i]));
  }
  at->insert_or_assign(names.back(), std::move(*parsed.get("value")));
}

}  // namespace

StudyTable::StudyTable(std::string path) : node_(std::make_shared<StudyNode>()), path_(std::move(path)) {}

StudyTable::StudyTable(std::shared_ptr<StudyNode> node, std::string path)
    : node_(std::move(node)), path_(std::move(path)) {}

bool StudyTable::has(std::string_view key) const {
  node_->known.emplace(key);
  return find(*node_, key) != nullptr;
}

std::string_view StudyTable::renamed(std::string_view key, std::string_view old_key) const {
  if (find(*node_, key) != nullptr || find(*node_, old_key) == nullptr) return key;
  const std::string note = fmt::format("{}: this key is now called '{}'", place(old_key), key);
  std::vector<std::string>& notes = node_->document->notes;
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return old_key;
}

void StudyTable::accept(std::string_view key) const { node_->accepted.emplace(key); }

std::vector<std::string> StudyTable::keys() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  if (node_->table != nullptr) {
    for (const auto& [key, value] : *node_->table) found.emplace_back(key.source().begin, std::string(key.str()));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (auto& [position, name] : found) names.push_back(std::move(name));
  return names;
}

std::string StudyTable::place(std::string_view key) const { return place_of(*node_, find(*node_, key), path_, key); }

void StudyTable::fail(std::string_view key, std::string_view what) const { throw InputError(place(key), what); }

namespace {

toml::node& require(const StudyTable& table, const StudyNode& node, std::string_view key) {
  toml::node* found = find(node, key);
  if (found == nullptr) table.fail(key, "is missing");
  return *found;
}

}  // namespace

double StudyTable::number(std::string_view key, std::string_view unit) const {
  node_->known.emplace(key);
  return number_from(filled(*node_, require(*this, *node_, key), place(key)), unit, place(key));
}

double StudyTable::number_or(std::string_view key, std::string_view unit, double otherwise) const {
  return has(key) ? number(key, unit) : otherwise;
}

double StudyTable::positive(std::string_view key, std::string_view unit) const {
  const double value = number(key, unit);
  if (!(value > 0.0)) fail(key, fmt::format("= {} must be > 0", value));
  return value;
}

double StudyTable::positive_or(std::string_view key, std::string_view unit, double otherwise) const {
  return has(key) ? positive(key, unit) : otherwise;
}

std::optional<double> StudyTable::optional_number(std::string_view key, std::string_view unit) const {
  if (!has(key)) return std::nullopt;
  return number(key, unit);
}

long long StudyTable::integer(std::string_view key) const {
  node_->known.emplace(key);
  const toml::node& node = require(*this, *node_, key);
  if (!node.is_integer()) fail(key, fmt::format("is {}, expected a whole number", kind_of(node)));
  return *node.value<std::int64_t>();
}

long long StudyTable::integer_or(std::string_view key, long long otherwise) const {
  return has(key) ? integer(key) : otherwise;
}

bool StudyTable::flag_or(std::string_view key, bool otherwise) const {
  if (!has(key)) return otherwise;
  const toml::node& node = *find(*node_, key);
  if (!node.is_boolean()) fail(key, fmt::format("is {}, expected true or false", kind_of(node)));
  return *node.value<bool>();
}

std::string StudyTable::text(std::string_view key) const {
  node_->known.emplace(key);
  return text_from(filled(*node_, require(*this, *node_, key), place(key)), place(key));
}

std::string StudyTable::text_or(std::string_view key, std::string_view otherwise) const {
  return has(key) ? text(key) : std::string(otherwise);
}

std::string StudyTable::choice_or(std::string_view key, std::span<const std::string> choices,
                                  std::string_view otherwise) const {
  std::string chosen = text_or(key, otherwise);
  if (std::find(choices.begin(), choices.end(), chosen) == choices.end()) {
    fail(key, fmt::format("= '{}' is not one of {}", chosen, fmt::join(choices, ", ")));
  }
  return chosen;
}

std::vector<double> StudyTable::numbers(std::string_view key, std::string_view unit) const {
  node_->known.emplace(key);
  const toml::node& node = require(*this, *node_, key);
  const toml::array* array = node.as_array();
  if (array == nullptr) return {number(key, unit)};
  std::vector<double> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string element = fmt::format("{}[{}]", place(key), i);
    values.push_back(number_from(filled(*node_, *array->get(i), element), unit, element));
  }
  return values;
}

std::vector<std::string> StudyTable::texts(std::string_view key) const {
  node_->known.emplace(key);
  const toml::node& node = require(*this, *node_, key);
  const toml::array* array = node.as_array();
  if (array == nullptr) return {text_from(node, place(key))};
  std::vector<std::string> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    values.push_back(text_from(*array->get(i), fmt::format("{}[{}]", place(key), i)));
  }
  return values;
}

std::filesystem::path StudyTable::file(std::string_view key) const {
  node_->known.emplace(key);
  return path_from(require(*this, *node_, key), node_->document.get(), place(key));
}

std::vector<std::filesystem::path> StudyTable::files(std::string_view key) const {
  node_->known.emplace(key);
  toml::node& node = require(*this, *node_, key);
  toml::array* array = node.as_array();
  if (array == nullptr) return {path_from(node, node_->document.get(), place(key))};
  std::vector<std::filesystem::path> paths;
  for (std::size_t i = 0; i < array->size(); ++i)
    paths.push_back(path_from(*array->get(i), node_->document.get(), fmt::format("{}[{}]", place(key), i)));
  return paths;
}

bool StudyTable::is_table(std::string_view key) const { return has(key) && find(*node_, key)->is_table(); }
bool StudyTable::is_array(std::string_view key) const { return has(key) && find(*node_, key)->is_array(); }
bool StudyTable::is_text(std::string_view key) const { return has(key) && find(*node_, key)->is_string(); }
bool StudyTable::is_number(std::string_view key) const { return has(key) && find(*node_, key)->is_number(); }

StudyTable StudyTable::table(std::string_view key) const {
  node_->known.emplace(key);
  const toml::node& node = require(*this, *node_, key);
  if (!node.is_table()) fail(key, fmt::format("is {}, expected a table", kind_of(node)));
  return table_or_empty(key);
}

StudyTable StudyTable::table_or_empty(std::string_view key) const {
  node_->known.emplace(key);
  toml::node* found = find(*node_, key);
  if (found != nullptr && !found->is_table()) fail(key, fmt::format("is {}, expected a table", kind_of(*found)));
  auto& opened = node_->opened[std::string(key)];
  const std::string child_path = dotted(path_, key);
  // The same node for every opening, so that keys read through one are known to all.
  if (opened.empty()) {
    auto child = std::make_shared<StudyNode>();
    child->document = node_->document;
    child->table = found == nullptr ? nullptr : found->as_table();
    opened.emplace_back(child_path, std::move(child));
  }
  return StudyTable(opened.front().second, child_path);
}

std::vector<StudyTable> StudyTable::tables(std::string_view key) const {
  if (!has(key)) return {};
  toml::node& node = *find(*node_, key);
  toml::array* array = node.as_array();
  if (array == nullptr) fail(key, fmt::format("is {}, expected an array of tables [[{}]]", kind_of(node), key));
  auto& opened = node_->opened[std::string(key)];
  std::vector<StudyTable> result;
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (opened.size() <= i) {
      toml::table* table = array->get(i)->as_table();
      const std::string child_path = fmt::format("{}[{}]", dotted(path_, key), i);
      if (table == nullptr) fail(key, fmt::format("[{}] is {}, expected a table", i, kind_of(*array->get(i))));
      auto child = std::make_shared<StudyNode>();
      child->document = node_->document;
      child->table = table;
      opened.emplace_back(child_path, std::move(child));
    }
    result.push_back(StudyTable(opened[i].second, opened[i].first));
  }
  return result;
}

void StudyTable::finish() const { refuse_unknown(*node_, path_); }

Study Study::load(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return parse(read_file(path), path.string(), path.parent_path(), overrides);
}

Study Study::parse(std::string_view text, std::string name, const std::filesystem::path& folder,
                   std::span<const std::string> overrides) {
  auto document = std::make_shared<StudyDocument>();
  document->name = name;
  document->folder = folder;
  document->root = parsed(text, name);
  for (const std::string& text_of_override : overrides) apply_override(document->root, text_of_override);
  for (const char* path : kTablesOfSubjects) {
    if (toml::table* table = document->root.at_path(path).as_table()) take_subject_of_file(*table, path, *document);
  }
  auto node = std::make_shared<StudyNode>();
  node->document = document;
  node->table = &document->root;
  Study study;
  study.root_ = StudyTable(std::move(node), "");
  study.name_ = std::move(name);
  study.folder_ = folder;
  return study;
}

std::vector<std::filesystem::path> subject_files(std::string_view text, const std::string& name,
                                                 const std::filesystem::path& folder,
                                                 std::span<const std::string> overrides) {
  toml::table root = parsed(text, name);
  for (const std::string& text_of_override : overrides) apply_override(root, text_of_override);
  std::vector<std::filesystem::path> files;
  for (const char* path : kTablesOfSubjects) {
    const toml::table* table = root.at_path(path).as_table();
    const toml::node* named = table == nullptr ? nullptr : table->get("file");
    if (named == nullptr) continue;
    std::filesystem::path file = text_from(*named, fmt::format("{}: {}.file", name, path));
    if (file.is_relative()) file = folder / file;
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  }
  return files;
}

const std::vector<std::string>& Study::notes() const { return root_.node_->document->notes; }

std::string Study::to_toml() const {
  std::ostringstream text;
  text << *root_.node_->table << '\n';
  return text.str();
}

}  // namespace veridyn
