#include "veridyn/io/opensim/storage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::io {
namespace {

constexpr const char* kMotion =
    "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\n"
    "time\tshoulder\telbow\n0.0\t1.5\t-2e1\n0.1 \t 3 \t +4\n";

std::string error_of(std::string_view text) {
  try {
    static_cast<void>(parse_storage(text, "a.mot"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Storage, ReadsHeaderLabelsAndRows) {
  const Storage storage = parse_storage(kMotion, "a.mot");
  EXPECT_EQ(storage.name, "Coordinates");
  EXPECT_TRUE(storage.in_degrees);
  EXPECT_EQ(storage.labels, (std::vector<std::string>{"shoulder", "elbow"}));
  EXPECT_EQ(storage.time, (std::vector<double>{0.0, 0.1}));
  EXPECT_EQ(storage.column(1), (std::vector<double>{-20.0, 4.0}));
}

TEST(Storage, WhatIsWrittenReadsBackToTheSameDoubles) {
  Storage storage = parse_storage(kMotion, "a.mot");
  storage.values = {0.1, 1.0 / 3.0, -1e-300, 12345678.9};
  const Storage back = parse_storage(to_storage_text(storage), "b.sto");
  EXPECT_EQ(back.values, storage.values);
  EXPECT_EQ(back.time, storage.time);
  EXPECT_EQ(back.labels, storage.labels);
  EXPECT_EQ(back.in_degrees, storage.in_degrees);
}

TEST(Storage, BadFilesGetOneLineThatNamesThePlace) {
  using ::testing::HasSubstr;
  EXPECT_THAT(error_of("Coordinates\ntime\ta\n0\t1\n"), HasSubstr("endheader"));
  EXPECT_THAT(error_of("x\nendheader\na\tb\n0\t1\n"), HasSubstr("a.mot:3: the first column must be 'time'"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\n0\t1\t2\n"), HasSubstr("a.mot:4: 3 numbers under 2 labels"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\n0\tnan\n"), HasSubstr("a.mot:4: column 'a': nan is not finite"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\n0\tone\n"), HasSubstr("'one' is not a number"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\n1\t1\n1\t2\n"), HasSubstr("a.mot:5: time 1 after 1 does not increase"));
  EXPECT_THAT(error_of("x\nnRows=3\nendheader\ntime\ta\n1\t1\n"), HasSubstr("ends after 1 of 3 rows"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\ta\n1\t1\t2\n"), HasSubstr("two columns 'a'"));
  EXPECT_THAT(error_of("x\nendheader\ntime\ta\n"), HasSubstr("has no rows"));
}

TEST(Storage, EveryTruncationIsReadOrRefusedInOneLine) {
  const std::string text = kMotion;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const std::string message = error_of(text.substr(0, n));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace veridyn::io
