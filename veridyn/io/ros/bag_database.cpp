#include "veridyn/io/ros/bag_database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/ros/mcap_chunk.hpp"
#include "veridyn/io/ros/ros_log.hpp"

namespace veridyn::io {
namespace internal {
namespace {

/// Largest text or message that is taken out of a database [bytes].
constexpr int kLargestValue = 256 << 20;
/// Read directly from the file, not copied through SQLite's cache [bytes].
constexpr long long kMapped = 1LL << 40;

struct CloseDatabase {
  void operator()(sqlite3* database) const { (void)sqlite3_close_v2(database); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { (void)sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

std::string_view text_of(sqlite3_stmt* statement, int column) {
  const void* const text = sqlite3_column_blob(statement, column);
  const int size = sqlite3_column_bytes(statement, column);
  return text == nullptr ? std::string_view()
                         : std::string_view(static_cast<const char*>(text), static_cast<std::size_t>(size));
}

/// What a file from anywhere must not do: run what its schema says, take all memory.
void make_safe(sqlite3* database) {
  (void)sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kLargestValue);
  (void)sqlite3_limit(database, SQLITE_LIMIT_VDBE_OP, 25'000);
  (void)sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  (void)sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  (void)sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  (void)sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  (void)sqlite3_exec(database, "PRAGMA cell_size_check=ON; PRAGMA query_only=ON", nullptr, nullptr, nullptr);
  (void)sqlite3_exec(database, fmt::format("PRAGMA mmap_size={}", kMapped).c_str(), nullptr, nullptr, nullptr);
}

class BagReader {
 public:
  BagReader(sqlite3* database, RosLog& messages, Log& log) : database_(database), messages_(messages), log_(log) {}

  void run(const std::string& source) {
    make_safe(database_);
    if (!has_table("topics") || !has_table("messages")) {
      if (failed_) throw InputError(source, fmt::format("is a damaged SQLite database: {}", failure_));
      throw InputError(source, "is an SQLite database, but no bag of ROS 2: it has no tables topics and messages");
    }
    read_definitions();
    read_topics();
    read_messages();
    if (failed_) {
      ++log_.damage.records_lost;
      log_.damage.notes.push_back(fmt::format("damaged, read as far as it goes: {}", failure_));
    }
    if (unknown_topics_ > 0)
      log_.damage.notes.push_back(fmt::format("{} messages of topics that are not described", unknown_topics_));
    if (not_unpacked_ > 0)
      log_.damage.notes.push_back(fmt::format("{} messages that cannot be unpacked", not_unpacked_));
  }

 private:
  Statement prepare(const std::string& query) {
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(database_, query.c_str(), static_cast<int>(query.size()), &made, nullptr) != SQLITE_OK)
      note_failure();
    return Statement(made);
  }

  void note_failure() {
    if (failed_) return;
    failed_ = true;
    failure_ = one_line(sqlite3_errmsg(database_));
  }

  /// Steps to the next row; false at the end, and where it cannot be read.
  bool next(sqlite3_stmt* statement) {
    if (statement == nullptr) return false;
    const int state = sqlite3_step(statement);
    if (state != SQLITE_ROW && state != SQLITE_DONE) note_failure();
    return state == SQLITE_ROW;
  }

  /// A table of its own: neither view nor virtual.
  bool has_table(const char* name) {
    const Statement statement = prepare("SELECT 1 FROM sqlite_schema WHERE type='table' AND rootpage>0 AND name=?1");
    if (!statement) return false;
    (void)sqlite3_bind_text(statement.get(), 1, name, -1, SQLITE_STATIC);
    return next(statement.get());
  }

  void read_definitions() {
    if (!has_table("message_definitions")) return;
    const Statement rows = prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    while (next(rows.get())) {
      Definition definition;
      definition.encoding = text_of(rows.get(), 1);
      definition.text = text_of(rows.get(), 2);
      // Of a topic whose definition was not found rosbag2 writes the encoding "unknown".
      if (definition.text.empty()) continue;
      definitions_.emplace(text_of(rows.get(), 0), std::move(definition));
    }
  }

  void read_topics() {
    const Statement rows = prepare("SELECT id, name, type, serialization_format FROM topics");
    while (next(rows.get())) {
      RosTopic topic;
      topic.name = text_of(rows.get(), 1);
      topic.type = text_of(rows.get(), 2);
      topic.encoding = text_of(rows.get(), 3);
      if (const auto definition = definitions_.find(topic.type); definition != definitions_.end()) {
        topic.schema_encoding = definition->second.encoding;
        topic.schema = definition->second.text;
      }
      topics_.emplace(sqlite3_column_int64(rows.get(), 0), messages_.topic(topic));
    }
  }

  void read_messages() {
    const Statement rows = prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY rowid");
    while (next(rows.get())) {
      const auto topic = topics_.find(sqlite3_column_int64(rows.get(), 0));
      if (topic == topics_.end()) {
        ++unknown_topics_;
        ++log_.damage.records_lost;
        continue;
      }
      const Nanoseconds logged = sqlite3_column_int64(rows.get(), 1);
      std::string_view data = text_of(rows.get(), 2);
      if (is_zstd(data)) {
        if (!unpack_zstd_message(data, buffer_)) {
          ++not_unpacked_;
          ++log_.damage.records_lost;
          continue;
        }
        data = buffer_;
      }
      messages_.add(topic->second, logged, data);
    }
  }

  struct Definition {
    std::string encoding, text;
  };

  sqlite3* database_;
  RosLog& messages_;
  Log& log_;
  std::map<std::string, Definition, std::less<>> definitions_;
  std::map<long long, std::size_t> topics_;
  std::string buffer_;
  bool failed_ = false;
  std::string failure_;
  std::uint64_t unknown_topics_ = 0, not_unpacked_ = 0;
};

Database open_file(const std::filesystem::path& path) {
  // As a URI, in which some characters stand for themselves only when they are escaped.
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    const bool itself = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                        c == '.' || c == '_' || c == '-';
    uri += itself ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  // What a recorder that was stopped left in its write-ahead log belongs to the bag; without one nothing is to be
  // locked, nor files made next to it.
  std::error_code none;
  const bool with_log = std::filesystem::exists(path.string() + "-wal", none);
  uri += with_log ? "?mode=ro" : "?mode=ro&immutable=1";
  sqlite3* made = nullptr;
  const int state = sqlite3_open_v2(uri.c_str(), &made, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database(made);
  if (state != SQLITE_OK || made == nullptr)
    throw InputError(path.string(), fmt::format("cannot be opened as an SQLite database: {}",
                                                made == nullptr ? "no memory" : printable(sqlite3_errmsg(made))));
  return database;
}

Log empty_log(std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "ROS 2 bag";
  return log;
}

Log finished(Log log, RosLog& messages) {
  messages.finish(log);
  internal::finish(log);
  return log;
}

}  // namespace

void add_bag_database(const std::filesystem::path& path, RosLog& messages, Log& log) {
  const Database database = open_file(path);
  BagReader(database.get(), messages, log).run(path.string());
}

}  // namespace internal

bool is_sqlite(std::string_view bytes) { return bytes.starts_with("SQLite format 3"); }

Log read_bag_database(const std::filesystem::path& path) {
  if (!is_sqlite(MappedFile(path).bytes())) throw InputError(path.string(), "is no SQLite database");
  Log log = internal::empty_log(path.string());
  internal::RosLog messages;
  internal::add_bag_database(path, messages, log);
  return internal::finished(std::move(log), messages);
}

Log read_bag_database(std::string_view bytes, std::string source) {
  Log log = internal::empty_log(std::move(source));
  if (!is_sqlite(bytes)) throw InputError(log.source, "is no SQLite database");
  std::string copy(bytes);
  // A database in memory has no write-ahead log: its versions of the format say so.
  constexpr std::size_t kVersions = 18;
  if (copy.size() > kVersions + 1) copy[kVersions] = copy[kVersions + 1] = 1;
  sqlite3* made = nullptr;
  const int state = sqlite3_open_v2(":memory:", &made, SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY, nullptr);
  const internal::Database database(made);
  const auto size = static_cast<sqlite3_int64>(copy.size());
  if (state != SQLITE_OK || sqlite3_deserialize(made, "main", reinterpret_cast<unsigned char*>(copy.data()), size, size,
                                                SQLITE_DESERIALIZE_READONLY) != SQLITE_OK)
    throw InputError(log.source, "cannot be opened as an SQLite database");
  internal::RosLog messages;
  internal::BagReader(made, messages, log).run(log.source);
  return internal::finished(std::move(log), messages);
}

}  // namespace veridyn::io
