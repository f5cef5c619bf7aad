// Sentences of rows: the phrases of the table (checks/*.inc) with a row's numbers.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

using Value = std::variant<double, std::string>;

std::optional<Value> plain_value(const Evidence& row, std::string_view key) {
  if (const Figure* figure = row.figure(key)) return figure->value;
  if (key == "about") return row.about;
  if (key == "value") return row.value;
  if (key == "sigma") return row.sigma;
  if (key == "limit") return row.limit;
  if (key == "cause") return std::string(to_string(row.cause));
  return std::nullopt;
}

/// Of a key, or of one that ends with the unit in which it is said.
std::optional<Value> value_of(const Evidence& row, std::string_view key) {
  if (std::optional<Value> value = plain_value(row, key)) return value;
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{
      {{"_percent", 100.0}, {"_ms", 1000.0}, {"_deg", 180.0 / std::numbers::pi}}};
  for (const auto& [ending, factor] : kUnits) {
    if (!key.ends_with(ending)) continue;
    std::optional<Value> value = plain_value(row, key.substr(0, key.size() - ending.size()));
    if (value && std::holds_alternative<double>(*value)) return Value(factor * std::get<double>(*value));
  }
  return std::nullopt;
}

/// One place of a phrase, "value:.2f". What a row lacks is a mistake of its maker, and shown as "?".
std::string said(const Evidence& row, std::string_view place) {
  const std::size_t colon = place.find(':');
  const std::optional<Value> value = value_of(row, place.substr(0, colon));
  assert(value && "a phrase needs a figure that its row does not hold");
  if (!value) return "?";
  const std::string format = fmt::format("{{{}}}", colon == place.npos ? "" : place.substr(colon));
  return std::visit([&](const auto& v) { return fmt::format(fmt::runtime(format), v); }, *value);
}

std::string filled(std::string_view phrase, const Evidence& row) {
  std::string text;
  while (!phrase.empty()) {
    const std::size_t open = phrase.find('{');
    text += phrase.substr(0, open);
    if (open == phrase.npos) break;
    // A doubled brace is one that is meant.
    if (phrase.substr(open, 2) == "{{") {
      text += '{';
      phrase.remove_prefix(open + 2);
      continue;
    }
    const std::size_t close = phrase.find('}', open);
    text += said(row, phrase.substr(open + 1, close - open - 1));
    phrase.remove_prefix(close + 1);
  }
  return text;
}

std::string first_that_fits(const Phrases& phrases, const Evidence& row) {
  const auto found = std::ranges::find_if(phrases, [&](const Phrase& p) { return !p.text.empty() && p.fits(row); });
  return found == phrases.end() ? std::string() : filled(found->text, row);
}

}  // namespace

const Figure* Evidence::figure(std::string_view key) const {
  const auto found = std::ranges::find(figures, key, &Figure::key);
  return found == figures.end() ? nullptr : &*found;
}

std::string_view name_of(const Evidence& row) { return to_string(row.check); }

std::string_view unit_of(const Evidence& row) { return info_of(row.check).unit; }

bool mentions(std::string_view text, std::string_view name) {
  const auto in_word = [&](std::size_t k) {
    return k < text.size() && (std::isalnum(static_cast<unsigned char>(text[k])) != 0 || text[k] == '_');
  };
  for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1))
    if ((at == 0 || !in_word(at - 1)) && !in_word(at + name.size())) return true;
  return false;
}

std::string says(const Evidence& row) { return first_that_fits(info_of(row.check).says, row); }

std::string advice_of(const Evidence& row) {
  return row.outcome == Outcome::kPassed ? std::string() : first_that_fits(info_of(row.check).advice, row);
}

}  // namespace veridyn::estimation
