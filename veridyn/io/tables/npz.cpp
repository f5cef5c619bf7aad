#include "veridyn/io/tables/npz.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zip.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_log.hpp"
#include "veridyn/io/tables/time_column.hpp"

namespace veridyn::io {
namespace {

// Of one array, and of all together: with the archive's copy of the one that is being read, below a gigabyte.
constexpr std::uint64_t kLargestArray = std::uint64_t{256} << 20U;
constexpr std::uint64_t kLargest = std::uint64_t{512} << 20U;
constexpr zip_int64_t kMostArrays = 10000;

std::string text_of(zip_error_t& error) {
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;

struct CloseMember {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

Archive open_archive(std::string_view bytes, const std::string& source) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* buffer = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (buffer == nullptr) throw InputError(source, "cannot be read as ZIP: " + text_of(error));
  zip_t* archive = zip_open_from_source(buffer, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (archive == nullptr) {
    zip_source_free(buffer);
    throw InputError(source, "is a damaged ZIP archive: " + text_of(error));
  }
  zip_error_fini(&error);
  return Archive(archive);
}

std::string member_bytes(zip_t* archive, zip_uint64_t index, const zip_stat_t& stat, const std::string& place) {
  const std::unique_ptr<zip_file_t, CloseMember> member(zip_fopen_index(archive, index, 0));
  if (!member) throw InputError(place, fmt::format("cannot be opened: {}", zip_strerror(archive)));
  std::string content(stat.size, '\0');
  std::size_t at = 0;
  while (at < content.size()) {
    const zip_int64_t read = zip_fread(member.get(), content.data() + at, content.size() - at);
    if (read <= 0) throw InputError(place, fmt::format("is damaged: {}", zip_file_strerror(member.get())));
    at += static_cast<std::size_t>(read);
  }
  // The checksum is compared at the end of the member.
  char end = 0;
  if (zip_fread(member.get(), &end, 1) != 0)
    throw InputError(place, fmt::format("is damaged: {}", zip_file_strerror(member.get())));
  return content;
}

/// Stamps [s], and the array that they are from, where they are from one.
struct NpzStamps {
  const NpyArray* array = nullptr;
  std::vector<double> time;
};

NpzStamps stamps_of(const NpzArrays& read, const std::string& source, const TableOptions& options, LogDamage& damage) {
  std::vector<std::string> names, candidates;
  std::size_t rows = 0;
  for (const auto& [name, array] : read.arrays) {
    names.push_back(name);
    if (array.columns.size() == 1) candidates.push_back(name);
    rows = std::max(rows, array.rows());
  }
  NpzStamps stamps;
  if (options.rate > 0.0) {
    for (std::size_t i = 0; i < rows; ++i) stamps.time.push_back(static_cast<double>(i) / options.rate);
    return stamps;
  }
  const auto found = internal::find_time_column(candidates, options, source);
  if (!found) {
    if (read.arrays.empty() && !read.left_out.empty())
      throw InputError(source, "holds no array of numbers: " + read.left_out.front());
    throw InputError(source,
                     fmt::format("holds no array of stamps (t, time or timestamps); it has {}; say which: time = "
                                 "{{ column = \"...\" }} or {{ rate = \"... Hz\" }} in [data]",
                                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  for (const auto& [name, array] : read.arrays) {
    if (name == candidates[*found] && array.columns.size() == 1) stamps.array = &array;
  }
  stamps.time = stamps.array->columns.front().numbers();
  const internal::TimeChoice choice = internal::time_scale({candidates[*found], ""}, options, stamps.time, source);
  for (double& stamp : stamps.time) stamp *= choice.scale;
  if (!choice.note.empty()) damage.notes.push_back(choice.note);
  return stamps;
}

/// The columns of an array one after the other as floats, where each may be a packet of floats; empty where not.
std::string as_packets(const NpyArray& array) {
  std::string bytes;
  if (array.shape.size() != 2 || array.rows() * sizeof(float) != known_packet("codemasters").size) return bytes;
  bytes.reserve(array.columns.size() * array.rows() * sizeof(float));
  for (const Column& column : array.columns) {
    for (std::size_t i = 0; i < array.rows(); ++i) {
      const auto number = static_cast<float>(column.number(i));
      bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }
  return bytes;
}

}  // namespace

bool is_npz(std::string_view bytes) { return bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06"); }

NpzArrays read_npz_arrays(std::string_view bytes, const std::string& source) {
  const Archive archive = open_archive(bytes, source);
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count > kMostArrays) throw InputError(source, fmt::format("holds {} files: is this a recording?", count));
  NpzArrays read;
  std::uint64_t total = 0;
  for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(count); ++i) {
    zip_stat_t stat;
    if (zip_stat_index(archive.get(), i, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0U || stat.name == nullptr)
      throw InputError(source, fmt::format("has a damaged entry, number {}", i + 1));
    std::string name = internal::printable(stat.name);
    const std::string place = fmt::format("{}: {}", source, name);
    total += stat.size;
    if (stat.size > kLargestArray || total > kLargest) {
      throw InputError(place, fmt::format("takes {} MiB, {} with those before; one array may take {}, all together {}",
                                          stat.size >> 20U, total >> 20U, kLargestArray >> 20U, kLargest >> 20U));
    }
    const std::string content = member_bytes(archive.get(), i, stat, place);
    try {
      NpyArray array = read_npy(content, name);
      if (name.ends_with(".npy")) name.resize(name.size() - 4);
      read.arrays.emplace_back(std::move(name), std::move(array));
    } catch (const InputError& other) {
      read.left_out.emplace_back(other.what());
    }
  }
  return read;
}

Log read_npz(std::string_view bytes, const std::string& source, const TableOptions& options) {
  NpzArrays read = read_npz_arrays(bytes, source);
  auto& arrays = read.arrays;
  for (const auto& [name, array] : arrays) {
    const std::string packets = as_packets(array);
    if (const PacketLayout* layout = packets_in(packets)) return packet_log(*layout, packets, source);
  }
  Log log;
  log.source = source;
  log.format = "NumPy arrays";
  NpzStamps stamps = stamps_of(read, source, options, log.damage);
  log.damage.notes.insert(log.damage.notes.end(), read.left_out.begin(), read.left_out.end());
  const std::size_t rows = stamps.time.size();
  OrderedStamps ordered = order_stamps(std::move(stamps.time));
  LogTopic topic;
  topic.spikes = ordered.spikes;
  topic.reordered = ordered.reordered;
  topic.doubled = ordered.doubled;
  const bool all = ordered.row.empty() && !ordered.time.empty();
  std::vector<std::string> unused;
  for (auto& [name, array] : arrays) {
    if (&array == stamps.array) continue;
    if (array.rows() != rows) {
      unused.push_back(name);
      continue;
    }
    const std::size_t count = array.columns.size();
    for (std::size_t c = 0; c < count; ++c) {
      LogField field;
      field.name = count > 1 ? fmt::format("{}[{}]", name, c) : name;
      field.values = all ? std::move(array.columns[c]) : array.columns[c].picked(ordered.row);
      topic.fields.push_back(std::move(field));
    }
  }
  topic.time = make_time_base(std::move(ordered.time));
  if (!unused.empty())
    log.damage.notes.push_back(
        fmt::format("arrays without a row for each of the {} stamps were left out: {}", rows, fmt::join(unused, ", ")));
  log.topics.push_back(std::move(topic));
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
