#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace veridyn::live::testing {

/// A pseudo-terminal: what a program opens under `device()` reads and writes here.
class PseudoTerminal {
 public:
  PseudoTerminal();
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  [[nodiscard]] const std::string& device() const { return device_; }
  /// That many bytes, or those that come within a second.
  std::vector<std::uint8_t> read(std::size_t count);
  /// What is there, at most as much as `out` holds.
  std::size_t read_some(std::span<std::uint8_t> out);
  void write(std::span<const std::uint8_t> bytes);

 private:
  int master_ = -1;
  std::string device_;
};

/// What a line is set to [bit/s].
int baud_of(int descriptor);

}  // namespace veridyn::live::testing
