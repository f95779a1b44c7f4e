// SPDX-License-Identifier: Apache-2.0
// Toolchains compile and run a subject's source. Each toolchain is a variant of the subject's lanes.
// subjects/toolchains/built_in.toml has the built-in toolchains; users' files can add others (docs/toolchains.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// How a toolchain's compiler and processor treat products and sums, as documented. `graze toolchain` measures it.
//   rounded     Every operation rounds as written.
//   contracted  Products are fused into additions.
//   excess      Results keep more digits than their type has, as on the x87.
//   fast        The compiler rewrites operations, or approximates them.
enum class Rounding { rounded, contracted, excess, fast };

struct Toolchain {
  std::string name;         // also the variant of its lanes: "arm64-gcc"
  std::string cxx, cc;      // compilers for C++ and C, with flags; empty: none
  std::string run = {};     // the command that runs a program, with {} for its file; empty: the program itself
  std::string needs = {};   // Debian packages, in words
  std::string strict = {};  // flags with which every operation rounds as written
  Rounding rounding = Rounding::rounded;  // rounding without the strict flags
  std::string file = {};                  // the user's file that defines this toolchain; empty: built in
  friend bool operator==(const Toolchain&, const Toolchain&) = default;
};

std::string_view name(Rounding rounding);

// to_json makes the row of a campaign's record; toolchain_of_json reads it.   Throws: nlohmann::json::exception;
// std::runtime_error for an unknown rounding.
nlohmann::ordered_json to_json(const Toolchain& toolchain);
Toolchain toolchain_of_json(const nlohmann::ordered_json& row);

const std::vector<Toolchain>& built_in_toolchains();

// The toolchains in a file with this name and text.   Throws: std::runtime_error with one line: FILE:LINE: expected …,
// found ….
std::vector<Toolchain> parse_toolchains(const std::string& name, std::string_view text);

// The list for which selected_toolchains returns these toolchains.
std::string list_of(const std::vector<Toolchain>& toolchains);

// The toolchains in a list of names, shell patterns of names, "all", and files (*.toml). A file's toolchain replaces a
// built-in one with the same name, and the list can name it too.   Throws: UsageError; as parse_toolchains;
// std::runtime_error if a file cannot be read.
std::vector<Toolchain> selected_toolchains(const std::string& list);

// The program that a shell would start for the command, if it is missing. Empty if the program exists, is built into
// the shell, or has a quoted name, which only a shell can read.
std::string missing_program(std::string_view command);

// Why this machine cannot build or run the toolchain's programs: "no aarch64-linux-gnu-g++ (install
// g++-aarch64-linux-gnu, qemu-user)". Empty if the compiler and the command that runs programs are found.
std::string why_not_here(const Toolchain& toolchain);

}  // namespace graze::subjects
