#include "veridyn/core/error.hpp"

namespace veridyn {

InputError::InputError(std::string_view place, std::string_view what)
    : std::runtime_error(place.empty() ? std::string(what) : std::string(place) + ": " + std::string(what)),
      place_(place) {}

}  // namespace veridyn
