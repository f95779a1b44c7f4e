// SPDX-License-Identifier: Apache-2.0
// Toolchains compile a subject's source and run it. Each toolchain is a variant of the subject's lanes. The file
// subjects/toolchains/built_in.toml has the built-in toolchains; a user's file can add others (docs/toolchains.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// The documented treatment of products and sums by a toolchain's compiler and processor. `graze toolchain` measures
// this treatment.
//   rounded     Every operation rounds as written.
//   contracted  Products are fused into additions.
//   excess      Results keep more digits than their type has, as on the x87.
//   fast        The compiler rewrites operations, or approximates them.
enum class Rounding { rounded, contracted, excess, fast };

struct Toolchain {
  std::string name;         // and variant of its lanes: "arm64-gcc"
  std::string cxx, cc;      // the compilers of C++ and C, with flags; empty: none
  std::string run = {};     // the command that runs a program, with {} for its file; empty: the program itself
  std::string needs = {};   // Debian packages, in words
  std::string strict = {};  // flags with which every operation rounds as written
  Rounding rounding = Rounding::rounded;  // without these flags
  std::string file = {};                  // the user's file that defines this toolchain; empty: built in
  friend bool operator==(const Toolchain&, const Toolchain&) = default;
};

std::string_view name(Rounding rounding);

// to_json makes the row of a campaign's record; toolchain_of_json reads it.   Throws: nlohmann::json::exception;
// std::runtime_error for an unknown rounding.
nlohmann::ordered_json to_json(const Toolchain& toolchain);
Toolchain toolchain_of_json(const nlohmann::ordered_json& row);

const std::vector<Toolchain>& built_in_toolchains();

// The toolchains of a file with this name and text.   Throws: std::runtime_error of one line: FILE:LINE: expected …,
// found ….
std::vector<Toolchain> parse_toolchains(const std::string& name, std::string_view text);

// The list from which selected_toolchains finds these toolchains again.
std::string list_of(const std::vector<Toolchain>& toolchains);

// The toolchains of a list. The list may have names, shell patterns of names, "all", and files (*.toml). A file's
// toolchain replaces a built-in one of the same name, and the list can name it too.   Throws: UsageError; as
// parse_toolchains; std::runtime_error if a file cannot be read.
std::vector<Toolchain> selected_toolchains(const std::string& list);

// The program that a shell would start for the command, if that program is missing. Empty if the program exists, is a
// command of the shell itself, or has a quoted name, which only a shell can read.
std::string missing_program(std::string_view command);

// The reason why this machine cannot make or run programs of the toolchain: "no aarch64-linux-gnu-g++ (install
// g++-aarch64-linux-gnu, qemu-user)". Empty if the compiler and the command that runs programs are found.
std::string why_not_here(const Toolchain& toolchain);

}  // namespace graze::subjects
