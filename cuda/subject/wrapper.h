// SPDX-License-Identifier: Apache-2.0
// Appends a kernel to a user's source, and determines whether the user's function takes float or double.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/lanes/lanes.h"

namespace graze::cuda {

// The source, followed by the kernel kSubjectKernel. The source's lines keep their numbers.
std::string wrapped(const std::string& text, const std::filesystem::path& source, const std::string& function,
                    Scalar scalar);

// The function's scalar type; float if the function takes both types. `compile` throws CompileError.
// Throws: UsageError, one line with the user's file and line, when the source does not compile. Also throws UsageError
// when no function with that name takes two triangles; the message then names the type that was found.
Scalar scalar_of(const std::string& text, const std::filesystem::path& source, const std::string& function,
                 const std::function<std::string(const std::string& whole)>& compile);

}  // namespace graze::cuda
