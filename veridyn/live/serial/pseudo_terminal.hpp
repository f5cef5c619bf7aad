#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace veridyn::live {

/// The far end of a serial line without hardware, a pseudo-terminal: what a program opens under `device()` reads and
/// writes here. Raw from the beginning, so that nothing is echoed.
class PseudoTerminal {
 public:
  PseudoTerminal();
  /// With a name of its own beside that of the system: a symbolic link, which goes when the object does. A link that
  /// is in the way is replaced, as one is left by a program that was killed.
  /// @throws InputError at `name`: something else has it, or it cannot be made there
  explicit PseudoTerminal(const std::filesystem::path& name);
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  [[nodiscard]] const std::string& device() const { return device_; }
  /// That many bytes, or those that come within a second.
  std::vector<std::uint8_t> read(std::size_t count);
  /// What is there, at most as much as `out` holds; 0 where nothing is, or nobody has the other end open.
  std::size_t read_some(std::span<std::uint8_t> out);
  /// Hands bytes over. @return how many; the rest does not fit where nobody reads
  std::size_t write(std::span<const std::uint8_t> bytes);
  /// Whether the last reading found the other end open. While it is not, waiting for the descriptor returns at once.
  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] int descriptor() const { return master_; }

 private:
  int master_ = -1;
  bool open_ = false;
  std::string device_;
  std::filesystem::path name_;
};

}  // namespace veridyn::live
