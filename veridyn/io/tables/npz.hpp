#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/npy.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io {

/// Whether bytes start as a ZIP archive does, which is what `numpy.savez` writes.
[[nodiscard]] bool is_npz(std::string_view bytes);

/// The arrays of a `.npz`.
struct NpzArrays {
  std::vector<std::pair<std::string, NpyArray>> arrays;  ///< by name
  std::vector<std::string> left_out;                     ///< what is no array of numbers, in words
};

/// Reads a `.npz`, stored or deflated. Its checksums tell damage from arrays of another kind (texts, objects), which
/// are left out.
/// @throws InputError naming source and array: a damaged archive, a wrong checksum, encrypted or too large members
/// (256 MiB each, 512 MiB together).
[[nodiscard]] NpzArrays read_npz_arrays(std::string_view bytes, const std::string& source);

/// A `.npz` as a log. The array of stamps, which the options name or which has a name by which stamps are known (`t`,
/// `Time`, `time_ms`, `timestamps`, ...), or else a rate, gives its time to every array with as many rows: `acc` with
/// three columns makes `acc[0]`, `acc[1]`, `acc[2]`. An array whose columns are packets of a game's telemetry is read
/// as such, see packets/packet_log.hpp.
/// @throws InputError as `read_npz_arrays`, and where no array holds stamps.
[[nodiscard]] Log read_npz(std::string_view bytes, const std::string& source, const TableOptions& options = {});

}  // namespace veridyn::io
