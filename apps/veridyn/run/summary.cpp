#include "apps/veridyn/run/summary.hpp"

#include <nlohmann/json.hpp>

#include "veridyn/io/results/json_text.hpp"

namespace veridyn::app {

struct SummaryWriter {
  using Tree = nlohmann::ordered_json;

  static Tree tree(const Summary& summary) { return std::visit(SummaryWriter{}, summary.value_); }

  Tree operator()(std::monostate) const { return nullptr; }
  Tree operator()(const Summary::Json& json) const { return Tree::parse(json.text); }
  Tree operator()(const Summary::Array& array) const {
    Tree result = Tree::array();
    for (const Summary& element : array) result.push_back(tree(element));
    return result;
  }
  Tree operator()(const Summary::Object& object) const {
    Tree result = Tree::object();
    for (const auto& [name, member] : object) result[name] = tree(member);
    return result;
  }
  template <typename Plain>
  Tree operator()(const Plain& value) const {
    return value;
  }
};

Summary::Summary(const std::vector<std::string>& texts) : value_(Array(texts.begin(), texts.end())) {}

Summary Summary::array(std::vector<Summary> elements) {
  Summary result;
  result.value_ = std::move(elements);
  return result;
}

Summary Summary::object(std::vector<Member> members) {
  Summary result;
  result.value_ = std::move(members);
  return result;
}

Summary Summary::json(std::string text) {
  Summary result;
  result.value_ = Json{std::move(text)};
  return result;
}

Summary& Summary::operator[](std::string_view name) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Object();
  auto& members = std::get<Object>(value_);
  for (auto& [known, member] : members) {
    if (known == name) return member;
  }
  return members.emplace_back(std::string(name), Summary()).second;
}

void Summary::push_back(Summary element) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Array();
  std::get<Array>(value_).push_back(std::move(element));
}

std::string Summary::to_json() const { return io::json_text(SummaryWriter::tree(*this), 2); }

}  // namespace veridyn::app
