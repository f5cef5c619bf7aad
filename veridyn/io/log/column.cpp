#include "veridyn/io/log/column.hpp"

#include <type_traits>

#include "veridyn/core/constants.hpp"

namespace veridyn::io {
namespace {

template <typename Values>
constexpr bool kIsText = std::is_same_v<std::decay_t<Values>, TextColumn>;

}  // namespace

std::size_t Column::size() const {
  return std::visit([](const auto& values) { return values.size(); }, storage_);
}

double Column::number(std::size_t i) const {
  return std::visit(
      [i](const auto& values) {
        if constexpr (kIsText<decltype(values)>) {
          return kNaN;
        } else {
          return static_cast<double>(values[i]);
        }
      },
      storage_);
}

std::vector<double> Column::numbers(double scale, double offset) const {
  return std::visit(
      [&](const auto& values) {
        std::vector<double> result;
        if constexpr (!kIsText<decltype(values)>) {
          result.resize(values.size());
          for (std::size_t i = 0; i < values.size(); ++i) result[i] = scale * static_cast<double>(values[i]) + offset;
        }
        return result;
      },
      storage_);
}

Column Column::picked(const std::vector<std::uint64_t>& rows) const {
  std::vector<double> chosen;
  chosen.reserve(rows.size());
  for (const std::uint64_t row : rows) chosen.push_back(number(row));
  return Column(std::move(chosen));
}

void Column::keep(std::size_t begin, std::size_t end) {
  std::visit(
      [&](auto& values) {
        if constexpr (kIsText<decltype(values)>) {
          values = values.part(begin, end);
        } else {
          values.resize(end);
          values.erase(values.begin(), values.begin() + begin);
        }
      },
      storage_);
}

void Column::shorten(std::size_t count) {
  std::visit([count](auto& values) { values.resize(count); }, storage_);
}

}  // namespace veridyn::io
