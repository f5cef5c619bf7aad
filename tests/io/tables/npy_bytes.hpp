#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace veridyn::testing {

/// A file as numpy.lib.format describes it.
inline std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  std::string header = dictionary;
  while ((8 + length_bytes + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (std::size_t k = 0; k < length_bytes; ++k) bytes += static_cast<char>(header.size() >> (8 * k) & 0xff);
  return bytes + header + data;
}

/// Numbers as they lie in memory.
template <typename Stored>
std::string bytes_of(const std::vector<Stored>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Stored)};
}

/// A file of an array of numbers; `shape` as Python writes it.
template <typename Stored>
std::string npy_array(const char* type, const std::vector<Stored>& values, const std::string& shape,
                      bool fortran = false, int version = 1) {
  return npy("{'descr': '" + std::string(type) + "', 'fortran_order': " + (fortran ? "True" : "False") +
                 ", 'shape': " + shape + ", }",
             bytes_of(values), version);
}

}  // namespace veridyn::testing
