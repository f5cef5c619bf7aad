#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/io/log/log.hpp"

namespace veridyn::testing {

/// That a log holds the variables of `small_mat`, whatever version of the format it was in.
inline void expect_small_mat(const io::Log& log) {
  const io::LogTopic* flight = log.find("flight");
  ASSERT_NE(flight, nullptr);
  EXPECT_THAT(*flight->time, ::testing::ElementsAre(0.0, 0.02, 0.04));
  EXPECT_DOUBLE_EQ(flight->find("p")->value(2), 0.3);
  EXPECT_DOUBLE_EQ(flight->find("q")->value(0), -1.0);
  EXPECT_EQ(log.information.at("flight.note"), "hi");
  const io::LogTopic* tables = log.find("");
  ASSERT_NE(tables, nullptr);
  EXPECT_THAT(tables->find("table")->shape, ::testing::ElementsAre(2U, 3U));
  EXPECT_DOUBLE_EQ(tables->find("table")->value(5), 6.0);
  const Recording recording = to_recording(log);
  EXPECT_THAT(recording.names(), ::testing::ElementsAre("flight.p", "flight.q"));
}

}  // namespace veridyn::testing
