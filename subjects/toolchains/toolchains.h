// SPDX-License-Identifier: Apache-2.0
// Toolchains: ways to compile a subject's source and run it, each a variant of its lanes.
// subjects/toolchains/built_in.toml has the built-in ones; a user's file has further ones (docs/toolchains.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace graze::subjects {

// What a toolchain's compiler and processor do with products and sums, as documented. `graze toolchain` measures it.
//   rounded     every operation rounds as written
//   contracted  products are fused into additions
//   excess      results keep more digits than their type has, as on the x87
//   fast        the compiler rewrites operations, or approximates them
enum class Rounding { rounded, contracted, excess, fast };

struct Toolchain {
  std::string name;         // the variant of its lanes: "arm64-gcc"
  std::string cxx, cc;      // the compilers of C++ and C, with flags; empty: it has none
  std::string run = {};     // the command that runs a program, {} in place of its file; empty: the program itself
  std::string needs = {};   // Debian packages, in words
  std::string strict = {};  // flags with which every operation rounds as written
  Rounding rounding = Rounding::rounded;  // without these flags
  std::string file = {};                  // the user's file that has the row; empty: it is built in
  friend bool operator==(const Toolchain&, const Toolchain&) = default;
};

std::string_view name(Rounding rounding);

// The row of a campaign's record, and back.   Throws: nlohmann::json::exception.
nlohmann::ordered_json to_json(const Toolchain& toolchain);
Toolchain toolchain_of_json(const nlohmann::ordered_json& row);

const std::vector<Toolchain>& built_in_toolchains();

// The toolchains of a file with this name and text.   Throws: std::runtime_error of one line: FILE:LINE: expected …,
// found ….
std::vector<Toolchain> parse_toolchains(const std::string& name, std::string_view text);

// A list with which selected_toolchains finds these toolchains again.
std::string list_of(const std::vector<Toolchain>& toolchains);

// The toolchains of a list: names and shell patterns of built-in ones, "all", and files (*.toml), whose toolchains
// replace built-in ones of the same name and can be named too.   Throws: UsageError; as parse_toolchains;
// std::runtime_error if a file cannot be read.
std::vector<Toolchain> selected_toolchains(const std::string& list);

// The program that a shell would start for the command, if it is missing. Empty if it exists, or if only a shell can
// tell, as for a quoted word or the shell's own commands.
std::string missing_program(std::string_view command);

// Why programs of the toolchain cannot be made or run on this machine: "no aarch64-linux-gnu-g++ (install
// g++-aarch64-linux-gnu, qemu-user)". Empty if its programs are found.
std::string why_not_here(const Toolchain& toolchain);

}  // namespace graze::subjects
