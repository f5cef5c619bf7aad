#pragma once

#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn {

/// The message with which `work` refuses its input.
std::string why(const auto& work) {
  try {
    work();
  } catch (const InputError& wrong) {
    return wrong.what();
  }
  return "nothing was refused";
}

}  // namespace veridyn
