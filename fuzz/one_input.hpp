#pragma once

#include <string_view>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::fuzz {

/// Reads the bytes and checks what must hold of every log; an InputError is a proper answer.
template <typename Read>
int one_input(std::string_view bytes, Read read) {
  try {
    const io::Log log = read(bytes);
    VERIDYN_ASSERT(log.damage.bytes_lost <= bytes.size());
    for (const io::LogTopic& topic : log.topics) {
      if (!topic.time) continue;
      for (std::size_t i = 1; i < topic.size(); ++i) VERIDYN_ASSERT((*topic.time)[i - 1] <= (*topic.time)[i]);
      for (const io::LogField& field : topic.fields) VERIDYN_ASSERT(field.values.size() == topic.size());
    }
    (void)io::to_recording(log);
  } catch (const InputError&) {
  }
  return 0;
}

}  // namespace veridyn::fuzz
