#include "veridyn/numerics/batches/fingerprint.hpp"

#include <gtest/gtest.h>

#include <string>

namespace veridyn::numerics {
namespace {

TEST(Fingerprint, IsTheDocumentedHash) {
  // FNV-1a of the length 1 as eight bytes, then 'a', by hand.
  std::uint64_t expected = 0xcbf29ce484222325ULL;
  for (const int byte : {1, 0, 0, 0, 0, 0, 0, 0, 0x61})
    expected = (expected ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3ULL;
  Fingerprint print;
  print.add(std::string_view("a"));
  EXPECT_EQ(print.value(), expected);
}

TEST(Fingerprint, DistinguishesWhatLooksAlike) {
  const auto of = [](auto... values) {
    Fingerprint print;
    (print.add(values), ...);
    return print.value();
  };
  using Text = std::string_view;
  EXPECT_NE(of(Text("ab"), Text("c")), of(Text("a"), Text("bc")));
  EXPECT_NE(of(0.0), of(-0.0));
  EXPECT_NE(of(1.0), of(1.0 + 2.3e-16));
  EXPECT_NE(of(1.0, 2.0), of(2.0, 1.0));
}

}  // namespace
}  // namespace veridyn::numerics
