#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle::testing {

/// The small tyre file with one text in place of another.
inline std::string replaced(const std::string& from, const std::string& to) {
  std::string text = small_tir();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The line with which a text is refused as a tyre file.
inline std::string message_of(const std::string& text) {
  try {
    (void)parse_tir(text, "t.tir");
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << "was accepted";
  return "";
}

}  // namespace veridyn::vehicle::testing
