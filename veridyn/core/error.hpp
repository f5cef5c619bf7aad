#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace veridyn {

/// The input is wrong: a file, a study, an option. Thrown at the boundary where the input is read.
///
/// `what()` is one line, "place: what", where the place names file and position as precisely as it is known
/// (`study.toml:14: subject.mass`, `flight.bin: byte 1024`) and the rest names value, rule and nearest valid choice.
/// The program prints it and ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  InputError(std::string_view place, std::string_view what);

  [[nodiscard]] const std::string& place() const noexcept { return place_; }

 private:
  std::string place_;
};

}  // namespace veridyn
