# SPDX-License-Identifier: Apache-2.0
# Makes release builds faster. Other builds compile each file separately, which checks that each file includes the
# headers it uses. In every build, the lanes, twins, kernels, core, strata, oracle and cuda are compiled separately.
set(is_release FALSE)
if(CMAKE_BUILD_TYPE STREQUAL Release)
  set(is_release TRUE)
endif()

# Campaign builds turn warnings off to compile faster. Other builds show the warnings.
if(GRAZE_CAMPAIGN)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-w>)
endif()

# graze_cold(file…): in a campaign build, compiles these files of the current folder with -O1. None of
# their code may run for every pair.
function(graze_cold)
  if(GRAZE_CAMPAIGN)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O1)
  endif()
endfunction()

# Library headers, precompiled once for many targets. There are two sets, because GCC requires a target to have the same
# flags as its precompiled headers.
set(has_precompiled FALSE)
if(is_release AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  set(has_precompiled TRUE)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/precompiled.cpp CONTENT "")
  set(levels O1 O3)
  if(GRAZE_CAMPAIGN)
    set(levels O1)
  endif()
  foreach(level IN LISTS levels)
    add_library(graze_precompiled_${level} OBJECT ${CMAKE_BINARY_DIR}/generated/precompiled.cpp)
    target_link_libraries(graze_precompiled_${level} PRIVATE graze_strict fmt::fmt nlohmann_json::nlohmann_json)
    target_compile_options(graze_precompiled_${level} PRIVATE -${level})
    target_precompile_headers(graze_precompiled_${level} PRIVATE <algorithm> <array> <bit> <charconv> <chrono> <cmath> <cstdint>
      <cstring> <filesystem> <fstream> <functional> <iostream> <map> <memory> <optional> <random> <regex> <set> <span> <sstream>
      <stdexcept> <string> <thread> <vector> <fmt/format.h> <nlohmann/json.hpp>)
  endforeach()
endif()

# graze_precompiled(LEVEL TARGET…): precompiled headers for targets that use fmt. LEVEL is O3, or O1 for code that takes
# longer to compile than to run.
function(graze_precompiled level)
  if(GRAZE_CAMPAIGN)
    set(level O1)
  endif()
  foreach(target IN LISTS ARGN)
    if(has_precompiled)
      # By default, programs are compiled with -fPIE, and GCC would reject these headers, which are precompiled with
      # -fPIC for libraries.
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-${level}$<SEMICOLON>-fPIC>)
      target_precompile_headers(${target} REUSE_FROM graze_precompiled_${level})
    endif()
  endforeach()
endfunction()

# graze_together(TARGET [ALONE file…] [MUTATED file…]): a unity build in batches of nine sources, or of eighteen in a
# campaign build. Each batch compiles CLI11, our headers and the JSON library only once, which saves seconds per file.
# ALONE files are compiled separately because their private names clash with those of other files. MUTATED files are
# compiled separately because scripts/mutate compiles them one by one; a campaign build ignores MUTATED.
function(graze_together target)
  cmake_parse_arguments(arg "" "" "ALONE;MUTATED" ${ARGN})
  set(batch 9)
  if(GRAZE_CAMPAIGN)
    set(arg_MUTATED "")
    set(batch 18)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${is_release} UNITY_BUILD_BATCH_SIZE ${batch})
  set_source_files_properties(${arg_ALONE} ${arg_MUTATED} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
