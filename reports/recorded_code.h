// SPDX-License-Identifier: Apache-2.0
// The foreign code that a result records, and how it differs between two results.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// Returns [{"name", "what", "hash", "source_hash", "compiler", "flags", "environment", "contraction"}] without empty
// fields; null without subjects. "contraction" has the plans by toolchain.   recorded: the result of subjects::record.
nlohmann::ordered_json code_json(const nlohmann::ordered_json& recorded);

// "P/m.cpp (hash 0a…, by g++ … -O3, CXX=g++)" for a row of code_json.
std::string code_words(const nlohmann::ordered_json& of);

// Returns a sentence for each subject whose code differs between two results. "subjects" (code_json) may be missing.
std::vector<std::string> code_differences(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after);

}  // namespace graze::reports
