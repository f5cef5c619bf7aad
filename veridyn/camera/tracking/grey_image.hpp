#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace veridyn::camera {

/// A grey picture of 8 bits that somebody else holds: rows from the top, `stride` bytes apart.
struct GreyView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;

  [[nodiscard]] const std::uint8_t* row(int y) const noexcept { return data + y * stride; }
};

/// A grey picture of 8 bits.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< width x height, rows from the top

  [[nodiscard]] GreyView view() const noexcept { return {pixels.data(), width, height, width}; }
};

}  // namespace veridyn::camera
