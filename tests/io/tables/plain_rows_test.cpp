#include "veridyn/io/tables/plain_rows.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::io {
namespace {

constexpr std::size_t kRows = 120000;

/// Some 6 MB of rows of four cells; `change` makes of the text of a row what it is to be.
template <typename Change>
std::string rows_with(const Change& change) {
  std::string text;
  for (std::size_t i = 0; i < kRows; ++i) {
    const auto x = static_cast<double>(i);
    text += change(i, fmt::format("{},{},{},{}\n", 0.01 * x, std::sin(x), i % 7 == 3 ? "" : fmt::format("{}", x * x),
                                  1e-9 * std::cos(0.3 * x)));
  }
  return text;
}

std::string as_it_is(std::size_t, std::string row) { return row; }

std::optional<std::vector<std::vector<double>>> in_parts(std::string_view rows, int threads) {
  return internal::read_plain_rows(rows, {}, {.count = 4, .time = 0, .time_scale = 1.0}, threads);
}

/// All that comes of reading: numbers to the last bit, notes, or the error.
std::string outcome(const std::string& rows, int threads) {
  TableOptions options;
  options.threads = threads;
  try {
    const Log log = read_csv("time[s],a,b,c\n" + rows, "flight.csv", options);
    std::string text;
    const LogTopic& topic = log.topics.front();
    for (const double t : *topic.time) text += fmt::format("{:a} ", t);
    for (const LogField& field : topic.fields) {
      text += field.name;
      for (std::size_t i = 0; i < topic.time->size(); ++i) text += fmt::format(" {:a}", field.values.number(i));
    }
    for (const std::string& note : log.damage.notes) text += "\n" + note;
    return text;
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PlainRows, AreThoseOfReadingRowByRow) {
  const std::string rows = rows_with(as_it_is);
  ASSERT_FALSE(in_parts(rows, 1).has_value());
  ASSERT_TRUE(in_parts(rows, 2).has_value());
  const std::string one = outcome(rows, 1);
  for (const int threads : {2, 3, 7}) EXPECT_TRUE(outcome(rows, threads) == one) << threads;
  const std::string cut_newline = rows.substr(0, rows.size() - 1);
  ASSERT_TRUE(in_parts(cut_newline, 3).has_value());
  EXPECT_TRUE(outcome(cut_newline, 3) == one);
  const std::string windows =
      rows_with([](std::size_t, std::string row) { return row.substr(0, row.size() - 1) + "\r\n"; });
  ASSERT_TRUE(in_parts(windows, 3).has_value());
  EXPECT_TRUE(outcome(windows, 3) == one);
}

// Whatever else stands anywhere in the table is found and said as by who reads row by row.
TEST(PlainRows, LeaveWhatIsNotPlainToReadingRowByRow) {
  for (const std::size_t at : {kRows / 2, kRows - 2}) {
    for (const char* const other : {"{},inf,1,2\n", "{},word,1,2\n", "{},\"1\n\",1,2\n", "{},1,2\n", "{},1,2,3,4\n",
                                    "{},1,2,3,\n", "0,1,2,3\n", ",1,2,3\n", "\n", "# remark\n", "nan,1,2,3\n"}) {
      const std::string rows = rows_with([&](std::size_t i, std::string row) {
        return i == at ? fmt::format(fmt::runtime(other), 0.01 * static_cast<double>(i)) : std::move(row);
      });
      EXPECT_FALSE(in_parts(rows, 3).has_value()) << other;
      EXPECT_TRUE(outcome(rows, 3) == outcome(rows, 1)) << other << " in row " << at;
    }
  }
  const std::string cut = rows_with([](std::size_t i, std::string row) { return i + 1 == kRows ? "1e9,2" : row; });
  EXPECT_FALSE(in_parts(cut, 3).has_value());
  EXPECT_TRUE(outcome(cut, 3) == outcome(cut, 1));
}

TEST(PlainRows, SeeTimeGoBackWhereTheTableIsDivided) {
  const std::string rows = rows_with(as_it_is);
  const std::size_t half = rows.find('\n', rows.size() / 2) + 1;
  const std::string again = rows.substr(0, half) + rows.substr(0, rows.size() - half);
  EXPECT_FALSE(in_parts(again.substr(0, again.rfind('\n') + 1), 2).has_value());
}

}  // namespace
}  // namespace veridyn::io
