// SPDX-License-Identifier: Apache-2.0
#include "fuzz/pack/archive.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include "core/cannot.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kPackId = 0x67726170;  // "grap"
constexpr const char* kTable = "CREATE TABLE sqlar(name TEXT PRIMARY KEY, mode INT, mtime INT, sz INT, data BLOB)";
constexpr int kFileMode = S_IFREG | 0644, kProgramMode = S_IFREG | 0755;
constexpr std::size_t kMostFiles = 100'000, kLongestName = 1000, kLongestPart = 255;
constexpr std::string_view kMagic{"SQLite format 3\0", 16};
constexpr std::size_t kApplicationAt = 68;  // in the file's first 100 bytes; big-endian

// Thrown for a defect in an archive. The message does not name the archive.
struct BadArchive : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Throws: BadArchive if a file has the same name as another file's folder.
void expect_no_folder(const std::vector<PackedFile>& files) {
  std::vector<std::string> names;
  for (const PackedFile& file : files) names.push_back(file.name);
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    const std::string inside = name + '/';
    const auto next = std::lower_bound(names.begin(), names.end(), inside);
    if (next != names.end() && next->starts_with(inside))
      throw BadArchive(fmt::format("{} is both a file and a folder", shown_path(name)));
  }
}

void expect_our_table(SQLite::Database& database) {
  if (database.execAndGet("PRAGMA application_id").getInt64() != kPackId) throw BadArchive("it is not a Graze pack");
  SQLite::Statement query(database, "SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL");
  std::size_t tables = 0;
  for (; query.executeStep(); ++tables) {
    if (query.getColumn(0).getString() != kTable) throw BadArchive("it has other tables, triggers or views");
  }
  if (tables != 1) throw BadArchive("its table is missing or occurs twice");
}

std::vector<PackedFile> files_of(SQLite::Database& database, std::size_t most_bytes) {
  expect_our_table(database);
  SQLite::Statement query(database, "SELECT name, mode, sz, data FROM sqlar ORDER BY name");
  std::vector<PackedFile> files;
  std::size_t bytes = 0;
  while (query.executeStep()) {
    const SQLite::Column name = query.getColumn(0), mode = query.getColumn(1), size = query.getColumn(2),
                         data = query.getColumn(3);
    const std::string text = name.isText() ? name.getString() : "";
    if (!may_be_packed(text)) throw BadArchive(fmt::format("it has a file named {}", shown_path(text)));
    if (files.size() == kMostFiles) throw BadArchive(fmt::format("it has more than {} files", kMostFiles));
    if (!files.empty() && files.back().name >= text) throw BadArchive(shown_path(text) + " occurs twice");
    if (!mode.isInteger() || (mode.getInt64() != kFileMode && mode.getInt64() != kProgramMode))
      throw BadArchive(shown_path(text) + " is not a regular file; it may be a link or a device");
    if (!(data.isBlob() || data.isNull()) || !size.isInteger() || size.getInt64() != data.getBytes())
      throw BadArchive(shown_path(text) + " is compressed, or its size is wrong");
    bytes += static_cast<std::size_t>(data.getBytes());
    if (bytes > most_bytes) throw BadArchive("its files are larger than the archive");
    const char* begin = static_cast<const char*>(data.getBlob());
    files.push_back({text, mode.getInt64() == kProgramMode,
                     begin ? std::string(begin, static_cast<std::size_t>(data.getBytes())) : std::string()});
  }
  expect_no_folder(files);
  return files;
}

}  // namespace

bool may_be_packed(std::string_view name) {
  if (name.empty() || name.size() > kLongestName) return false;
  if (std::any_of(name.begin(), name.end(),
                  [](char c) { return (static_cast<unsigned char>(c) < ' ') || c == '\x7f' || c == '\\'; }))
    return false;
  for (std::size_t begin = 0, end; begin <= name.size(); begin = end + 1) {
    end = std::min(name.find('/', begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part.empty() || part == "." || part == ".." || part.size() > kLongestPart) return false;
  }
  return true;
}

std::string archive_of(std::vector<PackedFile> files) {
  std::sort(files.begin(), files.end(), [](auto& l, auto& r) { return l.name < r.name; });
  expect_no_folder(files);
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  database.exec(fmt::format("PRAGMA application_id = {}; {}", kPackId, kTable));
  SQLite::Transaction transaction(database);
  SQLite::Statement put(database, "INSERT INTO sqlar VALUES(?, ?, 0, ?, ?)");
  for (const PackedFile& file : files) {
    if (!may_be_packed(file.name))
      throw std::runtime_error(cannot("pack", file.name, "a file in a pack cannot have this name; rename it"));
    constexpr std::size_t kMostBytes = 1'000'000'000;  // SQLite's limit for one value
    if (file.bytes.size() > kMostBytes)
      throw std::runtime_error(cannot("pack", file.name, "it has more than 10^9 bytes"));
    put.bind(1, file.name);
    put.bind(2, file.is_program ? kProgramMode : kFileMode);
    put.bind(3, static_cast<std::int64_t>(file.bytes.size()));
    put.bind(4, file.bytes.data(), static_cast<int>(file.bytes.size()));
    put.exec();
    put.reset();
  }
  transaction.commit();
  return file_bytes(database);
}

bool is_archive(const fs::path& file) {
  std::string head = beginning_of(file, kApplicationAt + 4);
  head.resize(kApplicationAt + 4);
  std::uint32_t id = 0;
  for (std::size_t i = kApplicationAt; i < head.size(); ++i) id = id << 8 | static_cast<unsigned char>(head[i]);
  return head.starts_with(kMagic) && id == kPackId;
}

std::vector<PackedFile> read_archive(const fs::path& file) {
  std::string bytes = read_whole(file, NamedBy::user);
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  try {
    if (bytes.empty()) throw BadArchive("it is missing or empty");
    SQLite::Database database(":memory:", SQLite::OPEN_READWRITE);
    for (const int option :
         {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
      sqlite3_db_config(database.getHandle(), option, 0, nullptr);
    // The archive is read from memory, so that SQLite does not read a log or journal beside it.
    if (sqlite3_deserialize(database.getHandle(), "main", reinterpret_cast<unsigned char*>(bytes.data()), size, size,
                            SQLITE_DESERIALIZE_READONLY) != SQLITE_OK)
      throw BadArchive("it is not a Graze pack");
    return files_of(database, bytes.size());
  } catch (const BadArchive& error) {
    throw corpus::FormatError(cannot("use", file, std::string(error.what()) + "; get the pack from its source again"));
  } catch (const SQLite::Exception& error) {
    throw corpus::FormatError(cannot("use", file,
                                     fmt::format("it is not a Graze pack, or it is damaged ({}); get it from its "
                                                 "source again",
                                                 printable(error.what()))));
  }
}

void unpack(const std::vector<PackedFile>& files, const fs::path& folder) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder, error)))
    throw UsageError(cannot("unpack into", folder, "it already exists; move it away"));
  if (!fs::create_directory(folder, error))
    throw std::runtime_error(cannot("make the folder", folder, error.message()));
  for (const PackedFile& file : files) {
    if (!may_be_packed(file.name)) throw std::logic_error("a file that may not be packed");
    const fs::path to = folder / file.name;
    fs::create_directories(to.parent_path());
    write_whole(to, file.bytes);
    if (file.is_program) fs::permissions(to, fs::perms::owner_exec, fs::perm_options::add);
  }
}

}  // namespace graze::fuzz
