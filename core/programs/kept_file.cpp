// SPDX-License-Identifier: Apache-2.0
#include "core/programs/kept_file.h"

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"

namespace graze {
namespace {

namespace fs = std::filesystem;

std::string line_of(std::string_view bytes, const fs::path& kept) {
  char line[40];
  std::snprintf(line, sizeof line, "\ngraze %016" PRIx64 "\n", fnv1a(bytes, fnv1a(kept.filename().string())));
  return line;
}

}  // namespace

void move_over(const fs::path& made, const fs::path& kept) {
  std::error_code error, none;
  fs::rename(made, kept, error);
  if (!error) return;
  const std::string why = fs::is_directory(kept, none) ? "a folder is in the way; remove it" : error.message();
  fs::remove(made, none);
  throw std::runtime_error(cannot("write", kept, why));
}

void keep_file(const fs::path& made, const fs::path& kept) {
  std::ofstream out(made, std::ios::binary | std::ios::app);
  std::string why;
  const std::optional<std::string> bytes = plain_file(made, why);
  if (!bytes) throw std::runtime_error(cannot("read", made, why));
  if (!(out << line_of(*bytes, kept)).flush()) throw std::runtime_error(cannot("write", made, errno));
  move_over(made, kept);
}

std::optional<std::string> kept_content(const fs::path& kept) {
  std::string why;
  std::optional<std::string> content = plain_file(kept, why);
  if (!content) return std::nullopt;
  std::string& bytes = *content;
  const std::size_t line = bytes.rfind("\ngraze ");
  if (line == bytes.npos) return std::nullopt;
  const std::string found = bytes.substr(line);
  bytes.resize(line);
  return found == line_of(bytes, kept) ? std::optional(bytes) : std::nullopt;
}

}  // namespace graze
