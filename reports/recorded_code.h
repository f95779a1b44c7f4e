// SPDX-License-Identifier: Apache-2.0
// The code that is not ours in a result, and how it differs between two results.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// [{"name", "what", "hash", "source_hash", "compiler", "flags", "environment", "contraction"}] of what subjects::record
// gives, without what is empty; null without subjects. "contraction" has the plans by toolchain.
nlohmann::ordered_json code_json(const nlohmann::ordered_json& recorded);

// "P/m.cpp (hash 0a…, by g++ … -O3, CXX=g++)", of a row of code_json.
std::string code_words(const nlohmann::ordered_json& of);

// A sentence for each subject whose code differs between two results. Each may have "subjects" of code_json.
std::vector<std::string> code_differences(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after);

}  // namespace graze::reports
