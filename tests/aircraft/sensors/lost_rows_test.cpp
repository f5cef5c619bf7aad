#include "veridyn/aircraft/sensors/lost_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace veridyn::aircraft {
namespace {

std::vector<double> stamps(double rate, std::size_t count) {
  std::vector<double> t;
  for (std::size_t k = 0; k < count; ++k) t.push_back(static_cast<double>(k) / rate);
  return t;
}

TEST(LostRows, TakeAllSamplesOfTheirStamp) {
  Recording r;
  const TimeBase fast = make_time_base(stamps(100.0, 20001)), slow = make_time_base(stamps(20.0, 4001));
  for (const auto& [name, base] : {std::pair("a", fast), std::pair("b", fast), std::pair("c", slow)})
    r.add(make_channel(name, "1", base, *base));
  lose_rows(r, 0.2, numerics::RandomStream(1, "lost rows"));
  const Channel &a = r.at("a"), &b = r.at("b"), &c = r.at("c");
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.value, *a.time) << "values stay with their stamps";
  EXPECT_EQ(c.value, *c.time);
  // Binomial: standard error of the share sqrt(0.16/20001); four of them.
  EXPECT_NEAR(static_cast<double>(a.size()) / 20001.0, 0.8, 0.012);
  for (const double t : stamps(20.0, 4001))
    EXPECT_EQ(std::ranges::binary_search(*a.time, t), std::ranges::binary_search(*c.time, t)) << t;
  // Each by itself: after a lost row the next one is lost as often as any.
  std::size_t lost = 0, both = 0;
  for (std::size_t k = 0; k + 1 < 20001; ++k) {
    const auto gone = [&](std::size_t i) {
      return !std::ranges::binary_search(*a.time, static_cast<double>(i) / 100.0);
    };
    if (!gone(k)) continue;
    ++lost;
    both += gone(k + 1) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(both) / static_cast<double>(lost), 0.2, 4.0 * 0.4 / std::sqrt(4000.0));
}

}  // namespace
}  // namespace veridyn::aircraft
