# SPDX-License-Identifier: Apache-2.0
# graze.wasm: the lanes, their twins and the exact decision for browsers and Node, built with clang and wasi-libc. Sets
# GRAZE_WASM to the module's path; empty without the toolchain, in which case nothing needs the module.
set(GRAZE_WASM "")
if(GRAZE_CAMPAIGN)
  return()
endif()
find_program(GRAZE_WASM_CLANG NAMES clang++-14 clang++)
if(GRAZE_WASM_CLANG AND NOT DEFINED GRAZE_WASM_LINKS)
  file(WRITE ${CMAKE_BINARY_DIR}/wasm/links.cpp "#include <string>\nextern \"C\" int f(int n) { return static_cast<int>(std::string(n, 'x').size()); }\n")
  execute_process(COMMAND ${GRAZE_WASM_CLANG} --target=wasm32-wasi -std=c++20 -fignore-exceptions -mexec-model=reactor
    ${CMAKE_BINARY_DIR}/wasm/links.cpp -o ${CMAKE_BINARY_DIR}/wasm/links.wasm RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed)
    set(links FALSE)
  else()
    set(links TRUE)
  endif()
  set(GRAZE_WASM_LINKS ${links} CACHE BOOL "Whether clang links C++ for WebAssembly")
endif()
if(NOT GRAZE_WASM_LINKS)
  message(STATUS "graze.wasm and graze view: unavailable (no clang that links C++ for WebAssembly; Debian's packages lld-14, wasi-libc, libc++-14-dev-wasm32, libc++abi-14-dev-wasm32 and libclang-rt-14-dev-wasm32 bring it)")
  return()
endif()
message(STATUS "graze.wasm and graze view: by ${GRAZE_WASM_CLANG}")

set(wasm ${CMAKE_BINARY_DIR}/wasm)
file(MAKE_DIRECTORY ${wasm}/include)
file(CREATE_LINK ${RANDOM123_INCLUDE_DIR}/Random123 ${wasm}/include/Random123 SYMBOLIC)
# No contraction, as in graze_strict. A throw is a trap: see wasm/library.cpp.
set(wasm_flags --target=wasm32-wasi -std=c++20 -O2 -DNDEBUG -fignore-exceptions -fno-rtti -fno-math-errno -ffp-contract=off
  -Wno-inline-namespace-reopened-noninline -ffile-prefix-map=${PROJECT_SOURCE_DIR}/= -isystem ${CMAKE_CURRENT_SOURCE_DIR}/wasm/standard
  -include from_chars.h -I${PROJECT_SOURCE_DIR} -I${CMAKE_BINARY_DIR}/generated -isystem ${wasm}/include)

# graze_wasm_object(NAME SOURCE DEPENDS target… FLAGS flag…)
function(graze_wasm_object name source)
  cmake_parse_arguments(arg "" "" "DEPENDS;FLAGS" ${ARGN})
  set(object ${wasm}/${name}.o)
  add_custom_command(OUTPUT ${object} DEPFILE ${object}.d DEPENDS ${PROJECT_SOURCE_DIR}/${source} ${arg_DEPENDS} VERBATIM
    COMMENT "WebAssembly: ${name}"
    COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${GRAZE_WASM_CLANG} ${wasm_flags} ${arg_FLAGS} -MD -MT ${object} -MF ${object}.d
      -c ${PROJECT_SOURCE_DIR}/${source} -o ${object})
  set(wasm_objects ${wasm_objects} ${object} PARENT_SCOPE)
endfunction()

set(wasm_objects "")
foreach(source core/exact_blocks/decide core/lanes/lanes core/lanes/policies core/text analysis/blame analysis/lane_trace reports/wasm/drawing reports/wasm/library)
  get_filename_component(name ${source} NAME)
  graze_wasm_object(${name} ${source}.cpp)
endforeach()
graze_wasm_object(twin cuda/twin/twin.cpp DEPENDS graze_cuda)  # which has the generated records
# Random123 does not know WebAssembly. Its settings for RISC-V are right, and its test vectors are those of the strata.
graze_wasm_object(module reports/wasm/module.cpp FLAGS -D__riscv)
foreach(variant IN LISTS variants)
  if(variant_${variant}_runs_on STREQUAL host AND variant_${variant}_arithmetic STREQUAL rounded)
    graze_wasm_object(host_${variant} core/lanes/host_blocks.cpp FLAGS -DGRAZE_FP=${variant})
  endif()
  if(variant_${variant}_twin STREQUAL twin)
    set(twins ${variant} policy_${variant})
    if(variant_${variant}_arithmetic STREQUAL contracted)
      set(twins ${variant}_portable policy_${variant})
    endif()
    foreach(twin IN LISTS twins)
      string(REGEX REPLACE "^twin_policy_" "policy_twin_" namespace twin_${twin})
      set(kernels ${CMAKE_BINARY_DIR}/generated/cuda/generated/twin_${twin}.inc)
      graze_wasm_object(${namespace} cuda/twin/twin_kernels.cpp DEPENDS graze_twins_${twin}
        FLAGS -DGRAZE_FP=${namespace} "-DGRAZE_TWIN_KERNELS=\"${kernels}\"")
    endforeach()
  endif()
endforeach()
set(GRAZE_WASM ${wasm}/graze.wasm)
add_custom_command(OUTPUT ${GRAZE_WASM} DEPENDS ${wasm_objects} COMMENT "WebAssembly: graze.wasm" VERBATIM
  COMMAND ${GRAZE_WASM_CLANG} --target=wasm32-wasi -mexec-model=reactor -O2 -Wl,--strip-all -Wl,--wrap=fma ${wasm_objects} -o ${GRAZE_WASM})
add_custom_target(graze_wasm ALL DEPENDS ${GRAZE_WASM})

# Compares the module with the native build, in Node.
add_executable(graze_wasm_reference wasm/reference.cpp)
target_link_libraries(graze_wasm_reference PRIVATE graze_analysis_more)
set(GRAZE_WASM_PAIRS 10000 CACHE STRING "Pairs on which the tests compare graze.wasm with the native build")
