#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "veridyn/core/error.hpp"

namespace veridyn {

/// What `work` returns. A mechanism that knows nothing of studies names its own options in its InputError; it is thrown
/// again at the place where the user wrote them.
template <typename Work>
auto at_place(std::string_view place, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw InputError(place, what.substr(std::min(what.size(), error.place().size() + 2)));
  }
}

}  // namespace veridyn
