#include "veridyn/io/matlab/mat_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace veridyn::io {
namespace {

/// Marks an array of numbers as a reference to an object.
constexpr double kReference = 0xdd000000;
constexpr std::size_t kRegions = 5, kOffsets = 8, kFirstOffset = 8, kFirstName = 40;
/// Cells before the properties and after them.
constexpr std::size_t kBefore = 2, kAfter = 3;
constexpr double kDay_s = 86400.0;

bool is_whole(double value, double most) { return value >= 0.0 && value <= most && value == std::floor(value); }

std::uint32_t word_at(std::string_view bytes, std::size_t at, bool swap) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[at + i]);
    word |= static_cast<std::uint32_t>(byte) << (8U * static_cast<unsigned>(swap ? 3 - i : i));
  }
  return word;
}

/// A number on its own.
std::optional<double> scalar(const MatValue* value) {
  if (value == nullptr || value->kind != MatValue::Kind::kNumbers || value->numbers.size() != 1) return std::nullopt;
  return value->numbers.front();
}

const MatValue* found_in(const std::map<std::string, const MatValue*, std::less<>>& properties, std::string_view name) {
  const auto found = properties.find(name);
  return found == properties.end() ? nullptr : found->second;
}

std::string day_of(double seconds) {
  using namespace std::chrono;
  const year_month_day day{sys_days(days(static_cast<int>(std::floor(seconds / kDay_s))))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()), static_cast<unsigned>(day.month()),
                     static_cast<unsigned>(day.day()));
}

MatValue column(std::string name, std::vector<double> numbers) {
  MatValue made;
  made.name = std::move(name);
  made.kind = MatValue::Kind::kNumbers;
  made.extents = {numbers.size(), 1};
  made.numbers = std::move(numbers);
  return made;
}

}  // namespace

std::optional<MatObjects> MatObjects::read(std::vector<MatValue> cells, bool swap) {
  if (cells.size() < kBefore + kAfter) return std::nullopt;
  std::string bytes;
  for (const double v : cells.front().numbers) {
    if (!is_whole(v, 255.0)) return std::nullopt;
    bytes += static_cast<char>(static_cast<unsigned char>(v));
  }
  constexpr std::uint32_t kNewestVersion = 4;
  if (bytes.size() < kFirstName) return std::nullopt;
  const std::uint32_t version = word_at(bytes, 0, swap);
  if (version == 0 || version > kNewestVersion) return std::nullopt;
  MatObjects objects;
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < kOffsets; ++i) {
    offsets.push_back(word_at(bytes, kFirstOffset + 4 * i, swap));
    // Earlier versions have fewer regions, and zeros for the others.
    const bool needed = i <= kRegions;
    const std::size_t before = i == 0 ? kFirstName : offsets[i - 1];
    if (needed && (offsets[i] < before || offsets[i] > bytes.size() || (i > 0 && (offsets[i] - before) % 4 != 0)))
      return std::nullopt;
  }
  std::string_view names = std::string_view(bytes).substr(kFirstName, offsets[0] - kFirstName);
  while (!names.empty()) {
    const std::size_t end = std::min(names.find('\0'), names.size());
    if (end > 0) objects.names_.emplace_back(names.substr(0, end));
    names.remove_prefix(std::min(end + 1, names.size()));
  }
  if (objects.names_.size() != word_at(bytes, 4, swap)) return std::nullopt;
  for (std::size_t region = 0; region < kRegions; ++region) {
    std::vector<std::uint32_t> words;
    for (std::size_t at = offsets[region]; at < offsets[region + 1]; at += 4) words.push_back(word_at(bytes, at, swap));
    objects.regions_.push_back(std::move(words));
  }
  objects.cells_ = std::move(cells);
  return objects;
}

std::optional<MatObjects::Reference> MatObjects::reference(const MatValue& value) {
  // Mark, number of dimensions, dimensions, objects, class: of one object.
  const std::vector<double>& n = value.numbers;
  if (n.size() != 6 || n[0] != kReference || n[1] != 2.0 || n[2] != 1.0 || n[3] != 1.0) return std::nullopt;
  if (!is_whole(n[4], 1e9) || !is_whole(n[5], 1e9) || n[4] == 0.0 || n[5] == 0.0) return std::nullopt;
  return Reference{static_cast<std::uint32_t>(n[4]), static_cast<std::uint32_t>(n[5])};
}

std::string MatObjects::class_name(std::uint32_t id) const {
  const std::size_t at = std::size_t{4} * id;
  if (at + 4 > words(0).size()) return {};
  // One in a namespace is none of those that are read.
  const std::uint32_t space = words(0)[at], name = words(0)[at + 1];
  return space == 0 && name > 0 && name <= names_.size() ? names_[name - 1] : std::string();
}

std::optional<MatObjects::Properties> MatObjects::properties(const Reference& object, std::string_view of_class) const {
  const std::size_t at = std::size_t{6} * object.object;
  if (class_name(object.of_class) != of_class || at + 6 > words(2).size() || words(2)[at] != object.of_class)
    return std::nullopt;
  const std::uint32_t saved = words(2)[at + 3], usual = words(2)[at + 4];
  if ((saved == 0) == (usual == 0)) return std::nullopt;
  return saved != 0 ? block(1, saved) : block(3, usual);
}

std::optional<MatObjects::Properties> MatObjects::block(std::size_t region, std::uint32_t id) const {
  const std::vector<std::uint32_t>& all = words(region);
  constexpr std::uint32_t kProperty = 1;
  std::size_t at = 0;
  for (std::uint32_t i = 0; at < all.size(); ++i) {
    const std::size_t count = all[at];
    if (count > (all.size() - at - 1) / 3) return std::nullopt;
    if (i < id) {
      at += 1 + 3 * count;
      at += at % 2;
      continue;
    }
    Properties found;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t name = all[at + 1 + 3 * k], kind = all[at + 2 + 3 * k], cell = all[at + 3 + 3 * k];
      if (name == 0 || name > names_.size()) return std::nullopt;
      if (kind != kProperty) continue;
      if (cell >= cells_.size() - kBefore - kAfter) return std::nullopt;
      found.emplace(names_[name - 1], &cells_[kBefore + cell]);
    }
    return found;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> MatObjects::duration(const MatValue& value) const {
  const auto object = reference(value);
  const auto found = object ? properties(*object, "duration") : std::nullopt;
  const MatValue* const millis = found ? found_in(*found, "millis") : nullptr;
  if (millis == nullptr || millis->kind != MatValue::Kind::kNumbers) return std::nullopt;
  std::vector<double> seconds = millis->numbers;
  for (double& s : seconds) s *= 1e-3;
  return seconds;
}

std::optional<std::vector<double>> MatObjects::date(const MatValue& value) const {
  const auto object = reference(value);
  const auto found = object ? properties(*object, "datetime") : std::nullopt;
  const MatValue* const data = found ? found_in(*found, "data") : nullptr;
  if (data == nullptr || data->kind != MatValue::Kind::kNumbers) return std::nullopt;
  // Milliseconds since 1970; what is added to a number below its precision, 0.2 us, is left out.
  constexpr double kYear1900 = -2208988800.0, kYear2200 = 7258118400.0;
  std::vector<double> seconds = data->numbers;
  for (double& s : seconds) {
    s *= 1e-3;
    if (std::isfinite(s) && (s < kYear1900 || s > kYear2200)) return std::nullopt;
  }
  return seconds;
}

std::optional<std::vector<double>> MatObjects::times(const MatValue& value, std::size_t rows, bool& dates) const {
  const auto moments = [&](const MatValue& from) {
    auto found = duration(from);
    dates = !found;
    return found ? found : date(from);
  };
  if (value.kind != MatValue::Kind::kStruct) {
    auto found = moments(value);
    return found && found->size() == rows ? found : std::nullopt;
  }
  // Rows at a rate, or a step apart.
  const MatValue *const origin = value.find("origin"), *const step = value.find("stepSize");
  const auto at_rate = scalar(value.find("specifiedAsRate"));
  const auto begin = origin != nullptr ? moments(*origin) : std::nullopt;
  if (!begin || begin->size() != 1 || !at_rate) return std::nullopt;
  double interval = 0.0;
  if (*at_rate != 0.0) {
    const auto rate = scalar(value.find("sampleRate"));
    if (!rate || !(*rate > 0.0)) return std::nullopt;
    interval = 1.0 / *rate;
  } else {
    const auto apart = step != nullptr ? duration(*step) : std::nullopt;
    if (!apart || apart->size() != 1 || !(apart->front() > 0.0)) return std::nullopt;
    interval = apart->front();
  }
  std::vector<double> made(rows);
  for (std::size_t i = 0; i < rows; ++i) made[i] = begin->front() + interval * static_cast<double>(i);
  return made;
}

std::optional<MatValue> MatObjects::made_of(const std::string& name, const MatValue& data, const MatValue& names,
                                            const MatValue* units, double rows, double variables,
                                            const MatValue* row_times, std::vector<std::string>& left_out) const {
  if (data.kind != MatValue::Kind::kCell || names.kind != MatValue::Kind::kCell || !is_whole(rows, 1e9) ||
      static_cast<double>(data.items.size()) != variables || static_cast<double>(names.items.size()) != variables)
    return std::nullopt;
  const auto count = static_cast<std::size_t>(rows);
  const bool with_units =
      units != nullptr && units->kind == MatValue::Kind::kCell && units->items.size() == data.items.size();
  MatValue made;
  made.name = name;
  made.kind = MatValue::Kind::kStruct;
  if (row_times != nullptr) {
    bool dates = false;
    auto stamps = times(*row_times, count, dates);
    if (!stamps) return std::nullopt;
    if (dates && !stamps->empty() && std::isfinite(stamps->front())) {
      MatValue day;
      day.name = "date";
      day.kind = MatValue::Kind::kText;
      day.text = day_of(stamps->front());
      const double midnight = std::floor(stamps->front() / kDay_s) * kDay_s;
      for (double& t : *stamps) t -= midnight;
      made.items.push_back(std::move(day));
    }
    made.items.push_back(column("Time", *std::move(stamps)));
    made.items.back().row_times = true;
  }
  for (std::size_t i = 0; i < data.items.size(); ++i) {
    const MatValue &item = data.items[i], &label = names.items[i];
    if (label.kind != MatValue::Kind::kText || label.text.empty()) return std::nullopt;
    if (auto seconds = duration(item); seconds && seconds->size() == count) {
      made.items.push_back(column(label.text, *std::move(seconds)));
      made.items.back().unit = "s";
    } else if (item.kind == MatValue::Kind::kNumbers && !reference(item)) {
      if (item.extents.size() < 2 || item.extents[0] != count) return std::nullopt;
      made.items.push_back(item);
      made.items.back().name = label.text;
      if (with_units && units->items[i].kind == MatValue::Kind::kText) made.items.back().unit = units->items[i].text;
    } else {
      left_out.push_back(label.text);
    }
  }
  return made;
}

std::optional<MatValue> MatObjects::table(const MatValue& object, std::vector<std::string>& left_out) const {
  const auto which = reference(object);
  const auto found = which ? properties(*which, object.class_name) : std::nullopt;
  if (!found) return std::nullopt;
  if (object.class_name == "table") {
    const MatValue *const data = found_in(*found, "data"), *const names = found_in(*found, "varnames");
    const auto rows = scalar(found_in(*found, "nrows")), variables = scalar(found_in(*found, "nvars"));
    if (data == nullptr || names == nullptr || !rows || !variables) return std::nullopt;
    const MatValue* const more = found_in(*found, "props");
    const bool has_more = more != nullptr && more->kind == MatValue::Kind::kStruct;
    const MatValue* const units = has_more ? more->find("VariableUnits") : nullptr;
    return made_of(object.name, *data, *names, units, *rows, *variables, nullptr, left_out);
  }
  const MatValue* const any = object.class_name == "timetable" ? found_in(*found, "any") : nullptr;
  if (any == nullptr || any->kind != MatValue::Kind::kStruct) return std::nullopt;
  const MatValue *const data = any->find("data"), *const names = any->find("varNames"),
                        *const stamps = any->find("rowTimes");
  const auto rows = scalar(any->find("numRows")), variables = scalar(any->find("numVars"));
  if (data == nullptr || names == nullptr || stamps == nullptr || !rows || !variables) return std::nullopt;
  return made_of(object.name, *data, *names, any->find("varUnits"), *rows, *variables, stamps, left_out);
}

}  // namespace veridyn::io
