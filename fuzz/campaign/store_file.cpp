// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/store_file.h"

#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <cctype>
#include <cerrno>
#include <iterator>
#include <memory>
#include <new>
#include <string_view>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/files.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kApplicationId = 0x67726173;  // "gras"
constexpr int kFormat = 6;

constexpr const char* kTables[] = {
    "CREATE TABLE campaign(text TEXT NOT NULL, checksum INTEGER NOT NULL)",
    R"(CREATE TABLE batch(id INTEGER PRIMARY KEY, source INTEGER NOT NULL, first INTEGER NOT NULL, pairs INTEGER NOT NULL,
  counts BLOB NOT NULL, checksum INTEGER NOT NULL))"};
constexpr const char* kColumns = "SELECT id, source, first, pairs, counts, checksum FROM batch ";

// SQLite's messages quote the offending text, including line breaks.
std::string one_line(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  return text;
}

// The last system error (errno) of the database or its log; 0 for none.
int last_errno(const SQLite::Database& database) {
  int error = 0;
  for (const int which : {SQLITE_FCNTL_FILE_POINTER, SQLITE_FCNTL_JOURNAL_POINTER}) {
    sqlite3_file* file = nullptr;
    sqlite3_file_control(database.getHandle(), "main", which, &file);
    if (error == 0 && file && file->pMethods) file->pMethods->xFileControl(file, SQLITE_FCNTL_LAST_ERRNO, &error);
  }
  return error;
}

// Calls body() and turns its errors into one line that names the file.   database: gives the system's reason.
template <class Body>
auto in_one_line(const fs::path& file, const Body& body, const std::optional<SQLite::Database>& database = {}) {
  constexpr const char* kGoOn =
      "run `graze fuzz` again with --discard-damaged to keep the batches whose checksum is correct";
  try {
    return body();
  } catch (const Damaged& error) {
    throw DamagedStore(cannot("use", file, fmt::format("it is damaged: {}; {}", error.what(), kGoOn)));
  } catch (const SQLite::Exception& error) {
    const int code = error.getErrorCode(), system = database ? last_errno(*database) : 0;
    if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
      throw std::runtime_error(cannot("use", file, "another process is using this campaign; wait until it has ended"));
    std::error_code unknown;
    if (code == SQLITE_FULL || (code == SQLITE_IOERR && fs::space(file.parent_path(), unknown).available < 65536))
      throw std::runtime_error(cannot("write", file, ENOSPC));
    if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY || code == SQLITE_PERM || code == SQLITE_IOERR)
      throw std::runtime_error(system != 0 ? cannot("read and write", file, system)
                                           : cannot("read and write", file, one_line(error.what())));
    throw DamagedStore(cannot("use", file,
                              fmt::format("it is not one of Graze's campaign databases, or it is damaged ({}); {}",
                                          one_line(error.what()), kGoOn)));
  }
}

fs::path database_file(const StoreSpec& spec) { return spec.directory / kDatabase; }

std::string text_of(const StoreSpec& spec) {
  Json text{{"spec", spec.spec}, {"build", spec.build}};
  if (!spec.shard.whole()) text["shard"] = spec.shard.name();
  return text.dump();
}

std::int64_t number(SQLite::Database& database, const char* sql) { return database.execAndGet(sql).getInt64(); }

// Throws: Damaged unless the database has our two tables and nothing else. A trigger, for example, could drop rows.
void expect_our_tables(SQLite::Database& database) {
  SQLite::Statement query(database, "SELECT sql FROM sqlite_schema ORDER BY rowid");
  std::size_t count = 0;
  for (; query.executeStep(); ++count) {
    if (count >= std::size(kTables) || query.getColumn(0).getString() != kTables[count])
      throw Damaged("it has tables, triggers or views that are not Graze's");
  }
  if (count != std::size(kTables)) throw Damaged("one of its tables is missing");
}

// Whether the database is empty.   Throws: std::runtime_error if the database has another format or is another
// program's; Damaged if it has other tables.
bool is_fresh(SQLite::Database& database, const fs::path& file) {
  const std::int64_t application = number(database, "PRAGMA application_id");
  if (application == 0 && number(database, "SELECT count(*) FROM sqlite_schema") == 0) return true;
  if (application != kApplicationId)
    throw std::runtime_error(cannot("use", file, "it is another program's database; choose another --out"));
  if (const auto format = number(database, "PRAGMA user_version"); format != kFormat)
    throw std::runtime_error(
        cannot("use", file,
               fmt::format("it has format {}, but this build reads format {}; choose another --out", format, kFormat)));
  expect_our_tables(database);
  return false;
}

void begin(SQLite::Database& database, const std::string& text) {
  SQLite::Transaction transaction(database);
  for (const char* table : kTables) database.exec(table);
  SQLite::Statement put(database, "INSERT INTO campaign VALUES(?, ?)");
  SQLite::bind(put, text, static_cast<std::int64_t>(fnv1a(text)));
  put.exec();
  database.exec(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, kFormat));
  transaction.commit();
}

// The campaign's identity as the database records it.   Throws: Damaged.
std::string recorded_text(SQLite::Database& database) {
  SQLite::Statement query(database, "SELECT text, checksum FROM campaign");
  if (!query.executeStep()) throw Damaged("the record of its campaign is missing");
  const std::string text = query.getColumn(0).getString();
  if (query.getColumn(1).getInt64() != static_cast<std::int64_t>(fnv1a(text)))
    throw Damaged("the record of its campaign does not match its checksum");
  if (query.executeStep()) throw Damaged("it has records of two campaigns");
  return text;
}

}  // namespace

std::string file_bytes(SQLite::Database& database) {
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> bytes(sqlite3_serialize(database.getHandle(), "main", &size, 0),
                                                              sqlite3_free);
  if (!bytes) throw std::bad_alloc();
  return {bytes.get(), bytes.get() + size};
}

std::string first_difference(const Json& expected, const Json& found) {
  const Json ours = expected.flatten(), theirs = found.flatten();  // "/lanes/0": "exact/f32/cpu"
  const auto value = [](const Json& of, const std::string& place) {
    return of.contains(place) ? of[place].dump(-1, ' ', false, Json::error_handler_t::replace) : "none";
  };
  for (const bool empty : {false, true}) {  // flatten() turns an empty list into null; such places come last
    for (const Json& side : {ours, theirs}) {
      for (const auto& [place, one] : side.items()) {
        if (one.is_null() != empty || (ours.contains(place) && theirs.contains(place) && ours[place] == theirs[place]))
          continue;
        return fmt::format("{} is {}, not {}", place.substr(1), value(theirs, place), value(ours, place));
      }
    }
  }
  return "the keys are in another order";
}

namespace {

// Requires: the text's checksum is correct.   Throws: UsageError if the text belongs to another campaign; Damaged.
void compare(const StoreSpec& spec, const std::string& text) {
  if (text == text_of(spec)) return;
  const Json found = parse_shallow(text);
  if (!found.is_object()) throw Damaged("its campaign is not a JSON object");
  if (const std::string shard = found.value("shard", "none"), own = spec.shard.whole() ? "none" : spec.shard.name();
      found["spec"] == spec.spec && shard != own)
    throw UsageError(cannot("use", spec.directory,
                            fmt::format("it holds another shard, {} instead of {}; choose another --out", shard, own)));
  const bool another = found["spec"] != spec.spec;
  throw UsageError(cannot(
      "use", spec.directory,
      fmt::format(
          "{}: {}; choose another --out", another ? "it holds another campaign" : "another build started its campaign",
          another ? first_difference(spec.spec, found["spec"]) : first_difference(spec.build, found["build"]))));
}

// The ranges seen so far, by source and first pair.
class Coverage {
 public:
  explicit Coverage(const StoreSpec& spec) : spec_(spec), pairs_(spec.sources.size()) {}

  // Throws: Damaged if the range is not within its source, or overlaps another.
  void take(const PairRange& range) {
    const std::uint64_t size = spec_.sources[static_cast<std::size_t>(range.source)].pairs;
    const PairRange share = share_of(spec_.shard, range.source, size);
    if (range.pairs == 0 || range.first < share.first || range.first > share.first + share.pairs ||
        range.pairs > share.first + share.pairs - range.first)
      throw Damaged(fmt::format("{} pairs from index {} on are outside this store's share of the {} pairs of {}",
                                range.pairs, range.first, size, id(range)));
    auto& pairs = pairs_[static_cast<std::size_t>(range.source)];
    const auto next = pairs.lower_bound(range.first);
    if ((next != pairs.end() && next->first < range.first + range.pairs) ||
        (next != pairs.begin() && std::prev(next)->first + std::prev(next)->second > range.first))
      throw Damaged(fmt::format("two batches hold the same pairs of {}, from index {} on", id(range), range.first));
    pairs.emplace(range.first, range.pairs);
  }

  std::string id(const PairRange& range) const { return spec_.sources[static_cast<std::size_t>(range.source)].id; }

 private:
  const StoreSpec& spec_;
  std::vector<std::map<std::uint64_t, std::uint64_t>> pairs_;
};

struct CheckedRow {
  PairRange range;
  StoredCounts counts;
};

// Requires: the query's columns are kColumns.   Throws: Damaged.
CheckedRow checked_row(SQLite::Statement& query, const StoreSpec& spec, std::uint64_t campaign) {
  const std::int64_t source = query.getColumn(1).getInt64(), first = query.getColumn(2).getInt64(),
                     pairs = query.getColumn(3).getInt64();
  const std::string where = fmt::format("batch {}", query.getColumn(0).getInt64());
  if (source < 0 || source >= static_cast<std::int64_t>(spec.sources.size()) || first < 0 || pairs <= 0)
    throw Damaged(fmt::format("{} has {} pairs, from {} on, of source {} of {} sources", where, pairs, first, source,
                              spec.sources.size()));
  const PairRange range{static_cast<int>(source), static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(pairs)};
  const std::string bytes = query.getColumn(4).getString();
  if (query.getColumn(5).getInt64() != static_cast<std::int64_t>(checksum(campaign, range, bytes)))
    throw Damaged(where + " does not match its checksum");
  try {
    return {range, from_bytes(bytes, range, spec.sources[static_cast<std::size_t>(source)].axis,
                              static_cast<int>(spec.lanes.size()))};
  } catch (const Damaged& error) {
    throw Damaged(fmt::format("in {} {}", where, error.what()));
  }
}

std::int64_t insert(SQLite::Database& database, std::uint64_t campaign, const PairRange& range,
                    const std::string& bytes) {
  SQLite::Statement put(database, "INSERT INTO batch(source, first, pairs, counts, checksum) VALUES(?, ?, ?, ?, ?)");
  SQLite::bind(put, range.source, static_cast<std::int64_t>(range.first), static_cast<std::int64_t>(range.pairs));
  put.bind(4, bytes.data(), static_cast<int>(bytes.size()));
  put.bind(5, static_cast<std::int64_t>(checksum(campaign, range, bytes)));
  put.exec();
  return database.getLastInsertRowid();
}

// Whether the database is unchanged since a run ended and sealed it; then any log beside it is another database's.
bool is_closed(const fs::path& database) {
  try {
    const Json status = read_status(database.parent_path());
    return status.is_object() && status.contains("hash") && status["hash"] == file_hash(database);
  } catch (const std::exception&) {  // the status cannot be used
    return false;
  }
}

// The files beside the database that SQLite would read although it did not write them for this database: damaged files,
// links, and files of other programs or databases.
// Throws: std::runtime_error for a pipe or a device.
std::vector<fs::path> unusable_files_of(const fs::path& database) {
  constexpr std::string_view kJournal = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7", kLog = "\x37\x7f\x06",
                             kIndex = "\x18\xe2\x2d";
  constexpr std::uintmax_t kPage = 4096;
  const std::uintmax_t size = fs::exists(database) ? fs::file_size(database) : 0;
  std::vector<fs::path> found;
  for (const auto& [suffix, begins] : {std::pair{"-wal", kLog}, {"-shm", kIndex}, {"-journal", kJournal}}) {
    const fs::path file = database.string() + suffix;
    struct stat there {};
    if (lstat(file.c_str(), &there) != 0) continue;
    expect_file(file);
    std::string begin = beginning_of(file, begins.size());
    begin.resize(begins.size());
    const bool is_empty = begin.find_first_not_of('\0') == begin.npos;  // SQLite clears the beginning of an old journal
    if (!S_ISREG(there.st_mode) || there.st_nlink != 1 || (begin != begins && !is_empty) ||
        (begins == kLog && there.st_size > 0 && is_closed(database)) ||
        // Graze's own journals are older than the database's second page, because the rest is written through a log.
        (begins == kJournal && !is_empty && size > kPage))
      found.push_back(file);
  }
  return found;
}

// Throws: DamagedStore if unusable_files_of finds a file.
void expect_usable_files_of(const fs::path& database) {
  for (const fs::path& file : unusable_files_of(database))
    throw DamagedStore(
        cannot("use", file,
               "it is damaged, a link, or from another database; move it away, or run `graze fuzz` again with "
               "--discard-damaged, which renames it"));
}

SQLite::Database opened(const fs::path& file, int how = SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
  expect_file(file);  // SQLite would wait for a pipe
  expect_usable_files_of(file);
  return {fs::absolute(file).string(), how};  // a relative name may begin like a URI
}

// Opens a store for reading. If its last run ended normally, the store is one file that no process writes to. A killed
// run leaves a log beside the file; the next reader merges the log into the file under an exclusive lock.
struct OpenedToRead {
  explicit OpenedToRead(const fs::path& directory)
      : lock(fs::exists(directory / (std::string(kDatabase) + "-wal"))
                 ? std::make_unique<FolderLock>(directory, FolderLock::WhenTaken::refuse)
                 : nullptr),
        database(lock ? opened(directory / kDatabase, SQLite::OPEN_READWRITE)
                      : SQLite::Database(as_uri(directory / kDatabase), SQLite::OPEN_READONLY | SQLite::OPEN_URI)) {
    // An exclusive reader needs no index file, but would not remove one left by another program.
    if (lock && !fs::exists(directory / (std::string(kDatabase) + "-shm")))
      database.exec("PRAGMA locking_mode = EXCLUSIVE");
  }

  static std::string as_uri(const fs::path& file) {
    expect_file(file);  // SQLite would wait for a pipe
    std::string uri = "file:";
    for (const char c : fs::absolute(file).string()) {
      const bool plain =
          std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '.' || c == '-' || c == '_';
      uri += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
    }
    return uri + "?immutable=1";
  }

  std::unique_ptr<FolderLock> lock;
  SQLite::Database database;
};

struct KeptRow {
  PairRange range;
  std::string bytes;
};

// Returns the rows whose checksums are correct. Reads from both ends, because a damaged B-tree can be read from each
// end up to the damage.
std::vector<KeptRow> rows_that_check(SQLite::Database& database, const StoreSpec& spec, std::uint64_t campaign,
                                     std::size_t& seen) {
  std::vector<KeptRow> kept;
  // A view could have infinitely many rows.
  if (number(database, "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'batch'") != 1) return kept;
  Coverage coverage(spec);
  for (const char* order : {"ORDER BY id", "ORDER BY id DESC"}) {
    try {
      SQLite::Statement query(database, std::string(kColumns) + order);
      for (; query.executeStep(); ++seen) {
        try {
          const CheckedRow row = checked_row(query, spec, campaign);
          coverage.take(row.range);
          kept.push_back({row.range, to_bytes(row.counts)});
        } catch (const Damaged&) {
        }
      }
      return kept;
    } catch (const SQLite::Exception&) {
    }
  }
  return kept;
}

// The first of FILE.damaged, FILE.damaged-2, … that does not exist.
fs::path place_of_damaged(const fs::path& file) {
  fs::path place = file.string() + ".damaged";
  for (int n = 2; fs::exists(fs::symlink_status(place)); ++n) place = fmt::format("{}.damaged-{}", file.string(), n);
  return place;
}

// The bytes of a new database file with these rows.
std::string bytes_of_store(const std::string& text, const std::vector<KeptRow>& rows) {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  begin(database, text);
  SQLite::Transaction transaction(database);
  for (const KeptRow& row : rows) insert(database, fnv1a(text), row.range, row.bytes);
  transaction.commit();
  return file_bytes(database);
}

// A row's checksum includes the campaign's checksum. So a row with a correct checksum belongs to this campaign, even if
// the rest of the database is damaged.
Salvage salvage(const StoreSpec& spec) {
  const fs::path file = behind_links(database_file(spec));
  const std::string text = text_of(spec);
  std::vector<KeptRow> kept;
  std::size_t seen = 0;
  for (const fs::path& left : unusable_files_of(file)) fs::rename(left, place_of_damaged(left));
  try {
    SQLite::Database database = opened(file);
    bool known = false;
    try {
      compare(spec, recorded_text(database));
      known = true;
    } catch (const Damaged&) {
    } catch (const SQLite::Exception&) {
    }
    kept = rows_that_check(database, spec, fnv1a(text), seen);
    if (!known && kept.empty() && seen > 0)
      throw std::runtime_error(cannot("recover", file, "no batch of this campaign can be read; choose another --out"));
  } catch (const SQLite::Exception&) {  // no row is readable
  }
  Salvage result{kept.size(), 0, place_of_damaged(file)};
  for (const KeptRow& row : kept) result.pairs += row.range.pairs;
  const std::string bytes = bytes_of_store(text, kept);
  copy_whole(file, result.damaged);
  fs::remove(file.string() + "-wal");  // the old database's log, already read
  write_whole(file, bytes);
  return result;
}

}  // namespace

// Like in_one_line, with this store's file and database.
template <class Body>
auto StoreFile::checked(const Body& body) {
  return in_one_line(file_, body, database_);
}

StoreFile::StoreFile(const StoreSpec& spec) : spec_(spec), file_(database_file(spec)), campaign_(fnv1a(text_of(spec))) {
  const bool has_results = fs::exists(spec.directory / "summary.json");
  const auto refuse = [&] {
    throw UsageError(cannot("resume", spec.directory, "it holds results but not their database; choose another --out"));
  };
  if (has_results && !fs::exists(file_)) refuse();  // before the database is created
  checked([&] {
    SQLite::Database& database = database_.emplace(opened(file_));
    const bool fresh = is_fresh(database, file_);
    if (fresh && has_results) refuse();
    // With a write-ahead log, a killed process loses only the current transaction.
    database.exec("PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;");
    if (fresh) return begin(database, text_of(spec));
    const std::string found = one_line(database.execAndGet("PRAGMA quick_check(1)").getString());
    if (found != "ok") throw Damaged(found);
    compare(spec, recorded_text(database));
  });
}

void StoreFile::for_each(const std::function<void(std::int64_t, const PairRange&, const StoredCounts&)>& visit) {
  checked([&] {
    Coverage coverage(spec_);
    SQLite::Statement query(*database_, kColumns);
    while (query.executeStep()) {
      const CheckedRow row = checked_row(query, spec_, campaign_);
      coverage.take(row.range);
      visit(query.getColumn(0).getInt64(), row.range, row.counts);
    }
  });
}

void StoreFile::shrink() {
  checked([&] { database_->exec("VACUUM"); });
}

void StoreFile::finish() {
  expect_in_place();
  checked([&] {
    if (database_->execAndGet("PRAGMA wal_checkpoint(TRUNCATE)").getInt() != 0)
      throw std::runtime_error(cannot("write", file_, "its log cannot be written back; run the same command again"));
  });
}

void StoreFile::expect_in_place() const {
  int has_moved = 0;
  sqlite3_file_control(database_->getHandle(), "main", SQLITE_FCNTL_HAS_MOVED, &has_moved);
  if (has_moved != 0)
    throw MovedStore(cannot("write", file_,
                            "it was moved, removed or replaced while this run used it; run the same "
                            "command again, alone in its folder"));
}

StoredCounts StoreFile::counts(std::int64_t id) {
  return checked([&] {
    SQLite::Statement query(*database_, std::string(kColumns) + "WHERE id = ?");
    query.bind(1, id);
    if (!query.executeStep()) throw Damaged(fmt::format("batch {} is missing", id));
    return checked_row(query, spec_, campaign_).counts;
  });
}

std::int64_t StoreFile::put(const PairRange& range, const StoredCounts& counts,
                            const std::vector<std::int64_t>& replaced) {
  expect_in_place();
  return checked([&] {
    SQLite::Transaction transaction(*database_);
    for (const std::int64_t id : replaced) database_->exec(fmt::format("DELETE FROM batch WHERE id = {}", id));
    const std::int64_t id = insert(*database_, campaign_, range, to_bytes(counts));
    transaction.commit();
    return id;
  });
}

bool is_empty_store(const fs::path& directory) {
  const fs::path file = directory / kDatabase;
  return in_one_line(file, [&] {
    OpenedToRead store(directory);
    return is_fresh(store.database, file);
  });
}

StoreSpec recorded_store(const fs::path& directory) {
  const fs::path file = directory / kDatabase;
  if (!fs::exists(file)) throw std::runtime_error(cannot("read", file, ENOENT));
  return in_one_line(file, [&] {
    OpenedToRead store(directory);
    if (is_fresh(store.database, file))
      throw std::runtime_error(
          cannot("use", file, "it is empty, so the campaign is lost; run the campaign again with another --out"));
    const Json text = parse_shallow(recorded_text(store.database));
    if (!text.is_object()) throw Damaged("its campaign is not a JSON object");
    try {
      StoreSpec spec{directory, text.at("spec"), text.at("build"), {}, text["spec"].at("lanes"), {}};
      if (!text.contains("shard")) return spec;
      const auto shard = parse_shard(text["shard"].get<std::string>());
      if (!shard) throw Damaged("its shard is " + shown(text["shard"].get<std::string>()));
      spec.shard = *shard;
      return spec;
    } catch (const Json::exception& error) {
      throw Damaged(one_line(error.what()));
    }
  });
}

void for_each_row(const StoreSpec& spec, const std::function<void(const PairRange&, const StoredCounts&)>& visit) {
  const std::uint64_t campaign = fnv1a(text_of(spec));
  Coverage coverage(spec);
  std::unique_ptr<OpenedToRead> store;
  std::unique_ptr<SQLite::Statement> query;
  const auto next = [&]() -> std::optional<CheckedRow> {
    if (!store) store = std::make_unique<OpenedToRead>(spec.directory);
    if (!query) query = std::make_unique<SQLite::Statement>(store->database, kColumns);
    if (!query->executeStep()) return {};
    CheckedRow row = checked_row(*query, spec, campaign);
    coverage.take(row.range);
    return row;
  };
  // `visit` is called outside in_one_line, because its exceptions do not come from the database.
  while (const auto row = in_one_line(database_file(spec), next)) visit(row->range, row->counts);
}

std::optional<Salvage> discard_damaged(const StoreSpec& spec) {
  if (!fs::exists(database_file(spec))) return {};
  const FolderLock alone(spec.directory, FolderLock::WhenTaken::refuse);
  try {
    StoreFile(spec).for_each([](std::int64_t, const PairRange&, const StoredCounts&) {});
    return {};
  } catch (const DamagedStore&) {
    return in_one_line(database_file(spec), [&] { return salvage(spec); });
  }
}

void remove_store(const fs::path& directory) {
  const std::string database = directory / kDatabase;
  for (const char* behind : {"", "-wal", "-shm", "-journal"}) fs::remove(database + behind);
  if (const std::string part = database + kPart; is_left_over(part)) fs::remove(part);
  for (const char* file : {"status.json", "timings.json"}) {
    try {
      if (!read_sealed(directory / file, "").is_null()) fs::remove(directory / file);
    } catch (const std::runtime_error&) {  // the run did not write it
    }
  }
  std::error_code not_empty;
  fs::remove(directory / "cases", not_empty);
  fs::remove(directory, not_empty);
}

}  // namespace graze::fuzz
