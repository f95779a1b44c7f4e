// SPDX-License-Identifier: Apache-2.0
// What a program says about itself.
#pragma once

#include <string>

#include "subjects/process.h"

namespace graze::subjects {

// Reads a program's answer to the line `describe` (description.said): a JSON object {"version": "1.2", "source": "…",
// "convention": "…", "outside": ["touching", …]}, in which every field is optional. Ignores any other answer, because a
// program need not support `describe`.   Throws: std::runtime_error that names the subject, for fields of other types.
void add_description(Description& description, const std::string& subject);

}  // namespace graze::subjects
