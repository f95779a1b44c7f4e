// SPDX-License-Identifier: Apache-2.0
// The few lines of C++ that SQLite's C interface needs: an owner, statements, and errors as exceptions.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace graze::fuzz {

class Database {
 public:
  // Throws: std::runtime_error naming the file, here and in all that follows.
  explicit Database(const std::filesystem::path& file) : file_(file.string()) {
    sqlite3* handle = nullptr;
    const int rc = sqlite3_open(file_.c_str(), &handle);
    handle_.reset(handle);
    check(rc);
  }

  void execute(const char* sql) { check(sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr)); }

  void check(int rc) const {
    if (rc == SQLITE_OK || rc == SQLITE_ROW || rc == SQLITE_DONE) return;
    if (rc == SQLITE_NOTADB || rc == SQLITE_CORRUPT)
      throw std::runtime_error(file_ + ": expected a Graze campaign database, found a foreign or damaged file");
    if (rc == SQLITE_BUSY)
      throw std::runtime_error(file_ + ": expected to be alone, found another process that uses this campaign");
    throw std::runtime_error(file_ + ": " + sqlite3_errmsg(handle_.get()));
  }

  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::string file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

// A prepared statement: bind with operator(), then step; rows are read with integer() and text().
class Statement {
 public:
  Statement(const Database& database, const char* sql) : database_(&database) {
    sqlite3_stmt* handle = nullptr;
    database.check(sqlite3_prepare_v2(database.handle(), sql, -1, &handle, nullptr));
    handle_.reset(handle);
  }

  template <class... Value>
  Statement& operator()(const Value&... values) {
    sqlite3_reset(handle_.get());
    int column = 0;
    (bind(++column, values), ...);
    return *this;
  }

  // True while there is a row.
  bool step() {
    const int rc = sqlite3_step(handle_.get());
    database_->check(rc);
    if (rc != SQLITE_ROW) sqlite3_reset(handle_.get());
    return rc == SQLITE_ROW;
  }

  void run() {
    while (step()) {
    }
  }

  std::int64_t integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
    return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column)))
                 : std::string();
  }

 private:
  template <class Integer>
  requires std::is_integral_v<Integer>
  void bind(int column, Integer value) {
    database_->check(sqlite3_bind_int64(handle_.get(), column, static_cast<sqlite3_int64>(value)));
  }
  void bind(int column, std::string_view value) {
    database_->check(
        sqlite3_bind_text(handle_.get(), column, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT));
  }

  struct Finalize {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };
  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

}  // namespace graze::fuzz
