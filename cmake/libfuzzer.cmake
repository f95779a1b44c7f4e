# SPDX-License-Identifier: Apache-2.0
# Sets GRAZE_LIBFUZZER to clang's libFuzzer without a main function, or to false if it is missing or does not link. Code
# built with any compiler can call this library; only the guided search (graze hunt) needs it.
if(NOT DEFINED GRAZE_LIBFUZZER)
  file(GLOB folders /usr/lib/llvm-*/lib/clang/*/lib/linux /usr/lib/clang/*/lib/linux)
  list(SORT folders COMPARE NATURAL ORDER DESCENDING)
  list(PREPEND folders /usr/lib/llvm-14/lib/clang/14.0.6/lib/linux)  # the version used for the measurements
  find_library(GRAZE_LIBFUZZER NAMES libclang_rt.fuzzer_no_main-${CMAKE_SYSTEM_PROCESSOR}.a PATHS ${folders} NO_DEFAULT_PATH)
  if(GRAZE_LIBFUZZER)
    file(WRITE ${CMAKE_BINARY_DIR}/libfuzzer.cpp "extern \"C\" int LLVMFuzzerRunDriver(int*, char***, int (*)(const unsigned char*, unsigned long));
int main(int count, char** words) { return LLVMFuzzerRunDriver(&count, &words, [](const unsigned char*, unsigned long) { return 0; }); }\n")
    try_compile(links ${CMAKE_BINARY_DIR}/libfuzzer ${CMAKE_BINARY_DIR}/libfuzzer.cpp
      LINK_LIBRARIES ${GRAZE_LIBFUZZER} Threads::Threads ${CMAKE_DL_LIBS})
    if(NOT links)
      set(GRAZE_LIBFUZZER FALSE CACHE FILEPATH "clang's libFuzzer" FORCE)
    endif()
  endif()
endif()
if(GRAZE_LIBFUZZER)
  message(STATUS "graze hunt: uses libFuzzer from ${GRAZE_LIBFUZZER}")
else()
  message(STATUS "graze hunt: unavailable (no libFuzzer found; Debian's package libclang-rt-14-dev has it)")
endif()
