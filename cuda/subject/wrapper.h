// SPDX-License-Identifier: Apache-2.0
// The kernel around a user's function, and which of float and double the function takes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::cuda {

// The source with the kernel of cuda_subject.h behind it; lines keep their numbers.
std::string wrapped(const std::string& text, const std::filesystem::path& source, const std::string& function,
                    Scalar scalar);

// The scalar of the function, float where it takes both. `compile` throws CompileError.
// Throws: UsageError in one line, with the user's file and line, when the source does not compile, or says what there
// is where no function of the name takes two triangles.
Scalar scalar_of(const std::string& text, const std::filesystem::path& source, const std::string& function,
                 const std::function<std::string(const std::string& whole)>& compile);

}  // namespace graze::cuda
