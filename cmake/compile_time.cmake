# SPDX-License-Identifier: Apache-2.0
# What makes a release build short. Other builds compile each file by itself, so that each has to include what it uses; and
# lanes, twins, kernels, core, strata, oracle and cuda are compiled so in every build.
set(is_release FALSE)
if(CMAKE_BUILD_TYPE STREQUAL Release)
  set(is_release TRUE)
endif()

# Headers of libraries, read once for many targets. Two sets, as GCC wants the same flags where one is used.
set(has_precompiled FALSE)
if(is_release AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  set(has_precompiled TRUE)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/precompiled.cpp CONTENT "")
  foreach(level O1 O3)
    add_library(graze_precompiled_${level} OBJECT ${CMAKE_BINARY_DIR}/generated/precompiled.cpp)
    target_link_libraries(graze_precompiled_${level} PRIVATE graze_strict fmt::fmt nlohmann_json::nlohmann_json)
    target_compile_options(graze_precompiled_${level} PRIVATE -${level})
    target_precompile_headers(graze_precompiled_${level} PRIVATE <algorithm> <array> <bit> <charconv> <chrono> <cmath> <cstdint>
      <cstring> <filesystem> <fstream> <functional> <iostream> <map> <memory> <optional> <random> <regex> <set> <span> <sstream>
      <stdexcept> <string> <thread> <vector> <fmt/format.h> <nlohmann/json.hpp>)
  endforeach()
endif()

# graze_precompiled(LEVEL TARGET…): LEVEL is O3, or O1 where the compiler takes more time than the code ever will. It uses fmt.
function(graze_precompiled level)
  foreach(target IN LISTS ARGN)
    if(has_precompiled)
      # -fPIC: programs have -fPIE else, with which GCC refuses what was precompiled for libraries.
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-${level}$<SEMICOLON>-fPIC>)
      target_precompile_headers(${target} REUSE_FROM graze_precompiled_${level})
    endif()
  endforeach()
endfunction()

# graze_together(TARGET [file…]): its sources are compiled nine at once, but for these files: those that scripts/mutate
# compiles anew, and those with names that others have too. Of CLI11 and our own headers each file alone costs seconds.
function(graze_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${is_release} UNITY_BUILD_BATCH_SIZE 9)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
