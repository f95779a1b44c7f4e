// SPDX-License-Identifier: Apache-2.0
// A program's description of itself.
#pragma once

#include <string>

#include "subjects/process.h"

namespace graze::subjects {

// Reads a program's answer to the line `describe` (description.said): a JSON object {"version": "1.2", "source": "…",
// "convention": "…", "outside": ["touching", …]}. Every field is optional. Ignores an answer that is not a JSON object,
// because a program need not support `describe`. Prints a warning on standard error if there was no answer.
// Throws: std::runtime_error that names the subject, for an unknown field, a wrong type, or an answer of 8 KiB or more.
void add_description(Description& description, const std::string& subject);

}  // namespace graze::subjects
