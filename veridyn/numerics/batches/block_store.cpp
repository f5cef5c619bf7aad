#include "veridyn/numerics/batches/block_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <ctime>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/numerics/batches/block_file.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"
#include "veridyn/numerics/ranks/shared_work.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::numerics {

namespace fs = std::filesystem;

namespace {

constexpr const char* kManifest = "checkpoint.txt";
constexpr std::string_view kManifestFormat = "veridyn checkpoint 1";

/// Processor time of the calling thread [s].
double thread_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::vector<std::string> manifest_lines(const BlockStore::Identity& identity) {
  std::vector<std::string> lines = {std::string(kManifestFormat)};
  for (const auto& [name, value] : identity) {
    std::string line = fmt::format("{}: {}", name, value);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return lines;
}

/// A line as a message quotes it.
std::string quoted(const std::vector<std::string>& lines, std::size_t i) {
  constexpr std::size_t kLongest = 100;
  if (i >= lines.size()) return "nothing";
  return lines[i].size() <= kLongest ? fmt::format("'{}'", lines[i])
                                     : fmt::format("'{}...'", lines[i].substr(0, kLongest));
}

/// Of what all processes compute together.
std::uint64_t key_of(const Batch& batch) {
  Fingerprint key;
  key.add(batch.name);
  for (const std::size_t number : {batch.items, batch.items_per_block, batch.values_per_item})
    key.add(static_cast<std::uint64_t>(number));
  key.add(batch.fingerprint);
  return key.value();
}

/// The number of an item in; its processor time and its values out.
SharedWork::Compute item_of(const Batch& batch) {
  return [&batch](std::span<const double> request, std::vector<double>& reply) {
    const auto item = static_cast<std::size_t>(request.front());
    reply.assign(1 + batch.values_per_item, 0.0);
    const double begun = thread_seconds();
    if (batch.fill) {
      batch.fill(item, std::span(reply).subspan(1));
    } else {
      reply[1] = batch.value(item);
    }
    reply.front() = thread_seconds() - begun;
  };
}

/// A complete result as one list of numbers, and back.
std::vector<double> packed(const BatchValues& result) {
  std::vector<double> all = {result.processor_seconds};
  all.insert(all.end(), result.values.begin(), result.values.end());
  return all;
}

BatchValues unpacked(std::vector<double> all) {
  const double seconds = all.front();
  all.erase(all.begin());
  return {.values = std::move(all), .processor_seconds = seconds};
}

}  // namespace

/// View of a batch at work, with what is there of its blocks: the batch must outlive it.
struct BlockStore::Round {
  explicit Round(const Batch& of)
      : batch(&of),
        blocks((of.items + of.items_per_block - 1) / of.items_per_block),
        there(blocks, 0),
        seconds(blocks, 0.0),
        values(of.items * of.values_per_item) {}

  [[nodiscard]] std::size_t first(std::size_t block) const { return block * batch->items_per_block; }
  [[nodiscard]] std::size_t size(std::size_t block) const {
    return std::min(batch->items_per_block, batch->items - first(block));
  }
  /// The block's values among all.
  [[nodiscard]] std::size_t first_value(std::size_t block) const { return first(block) * batch->values_per_item; }
  [[nodiscard]] std::size_t values_in(std::size_t block) const { return size(block) * batch->values_per_item; }
  [[nodiscard]] std::size_t absent() const {
    return static_cast<std::size_t>(std::count(there.begin(), there.end(), 0));
  }
  [[nodiscard]] double fraction(std::size_t done) const {
    return batch->items == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(batch->items);
  }

  const Batch* batch;
  std::size_t blocks;
  std::vector<char> there;  ///< by block; not bool: threads write side by side
  std::vector<double> seconds;
  std::vector<double> values;
};

BlockStore::BlockStore(fs::path folder, const Identity& identity, const ProcessShare& share, Ranks ranks)
    : folder_(std::move(folder)), share_(share), ranks_(std::move(ranks)) {
  open(identity);
}

void BlockStore::open(const Identity& identity) const {
  make_folder(folder_);
  const fs::path path = folder_ / kManifest;
  const std::vector<std::string> here = manifest_lines(identity);
  if (!fs::exists(path)) {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      // Another share may be beginning the same folder; what it writes comes after its manifest.
      if (!entry.path().filename().string().starts_with(kManifest) && !fs::exists(path))
        throw InputError(folder_.string(), fmt::format("holds {} and is no checkpoint; choose a new or an empty folder",
                                                       entry.path().filename().string()));
    }
    std::string text;
    for (const std::string& line : here) text += line + "\n";
    // Processes of two machines may have the same number: each has a name of its own before the last.
    const fs::path own = folder_ / fmt::format("{}.{}", kManifest, share_.index + 1);
    write_file(own, text, path.string());
    fs::rename(own, path);
  }
  const std::vector<std::string> there = lines_of(read_file(path));
  if (there.empty() || !there.front().starts_with(kManifestFormat.substr(0, kManifestFormat.rfind(' '))))
    throw InputError(path.string(), "is no checkpoint; choose another folder");
  const std::size_t most = std::max(here.size(), there.size());
  for (std::size_t i = 0; i < most; ++i) {
    if (i >= here.size() || i >= there.size() || here[i] != there[i])
      throw InputError(folder_.string(), fmt::format("is of another study or version: {} there, {} here; choose "
                                                     "another folder, or remove this one",
                                                     quoted(there, i), quoted(here, i)));
  }
}

fs::path BlockStore::path_of(const Batch& batch, std::size_t block) const {
  return folder_ / fmt::format("{}-{:06}.block", batch.name, block);
}

bool BlockStore::read(Round& round, std::size_t block, bool warn) {
  if (folder_.empty()) return false;
  const fs::path path = path_of(*round.batch, block);
  Block b{.batch = round.batch->name,
          .fingerprint = round.batch->fingerprint,
          .first = round.first_value(block),
          .values = std::vector<double>(round.values_in(block))};
  switch (read_block(path, b)) {
    case BlockState::kAbsent:
      return false;
    case BlockState::kDamaged:
      if (warn) warnings_.push_back(fmt::format("{}: is damaged and is computed again", path.string()));
      return false;
    case BlockState::kOtherBatch:
      throw InputError(
          path.string(),
          "was computed from other numbers than here, although the study is the same: by another build, or "
          "on a machine whose processor rounds otherwise; go on there, or choose another folder");
    case BlockState::kRead:
      break;
  }
  std::copy(b.values.begin(), b.values.end(), round.values.begin() + b.first);
  round.seconds[block] = b.seconds;
  round.there[block] = 1;
  return true;
}

bool BlockStore::compute_share(Round& round, SharedWork& work, Progress& progress) const {
  std::vector<std::size_t> mine;
  std::size_t items = 0, done_before = 0;
  for (std::size_t b = 0; b < round.blocks; ++b) {
    if (round.there[b] != 0) {
      done_before += round.size(b);
    } else if (share_.computes(b)) {
      mine.push_back(b);
      items += round.size(b);
    }
  }
  // Items are handed out across blocks, so that no thread waits for the last of a block.
  const Batch& batch = *round.batch;
  std::vector<double> seconds(items);
  std::vector<std::atomic<std::size_t>> left(mine.size());
  for (std::size_t k = 0; k < mine.size(); ++k) left[k] = round.size(mine[k]);
  const auto finish = [&](std::size_t k) {
    const std::size_t block = mine[k], from = k * batch.items_per_block;
    for (std::size_t i = 0; i < round.size(block); ++i) round.seconds[block] += seconds[from + i];
    if (!folder_.empty()) {
      const auto first = round.values.begin() + static_cast<std::ptrdiff_t>(round.first_value(block));
      write_block(path_of(batch, block),
                  {.batch = batch.name,
                   .fingerprint = batch.fingerprint,
                   .first = round.first_value(block),
                   .values = std::vector<double>(first, first + static_cast<std::ptrdiff_t>(round.values_in(block))),
                   .seconds = round.seconds[block]});
    }
    round.there[block] = 1;
  };
  const auto one = [&](std::size_t item) {
    const std::size_t k = item / batch.items_per_block;  // only the last block is short
    const std::size_t i = round.first(mine[k]) + item % batch.items_per_block;
    std::vector<double> reply;
    work.ask(std::array{static_cast<double>(i)}, reply);
    seconds[item] = reply.front();
    std::copy(reply.begin() + 1, reply.end(),
              round.values.begin() + static_cast<std::ptrdiff_t>(i * batch.values_per_item));
    if (--left[k] == 0) finish(k);
  };
  return parallel_for(items, work.threads(), one,
                      [&](std::size_t done) { return progress.update(round.fraction(done_before + done)); });
}

BatchValues BlockStore::compute(const Batch& batch, Progress& progress) {
  SharedWork work(ranks_, key_of(batch), progress.threads(), item_of(batch));
  if (!ranks_.first()) return unpacked(work.serve());
  Round round(batch);
  missing_ = 0;
  last_blocks_ = round.blocks;
  blocks_ += round.blocks;
  for (std::size_t b = 0; b < round.blocks; ++b) found_ += read(round, b, true) ? 1U : 0U;
  const bool proceed = compute_share(round, work, progress);
  if (proceed) {
    // Other shares may have gone on meanwhile.
    for (std::size_t b = 0; b < round.blocks; ++b) {
      if (round.there[b] == 0) static_cast<void>(read(round, b, false));
    }
    missing_ = round.absent();
  }
  BatchValues result{.values = std::move(round.values), .completed = proceed && missing_ == 0};
  for (const double s : round.seconds) result.processor_seconds += s;
  if (result.completed) work.finish(packed(result));
  return result;
}

}  // namespace veridyn::numerics
