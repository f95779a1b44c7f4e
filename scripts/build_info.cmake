# SPDX-License-Identifier: Apache-2.0
# Writes OUT, a header with the commit that is built. Runs in every build; OUT is not touched if nothing has changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define GRAZE_COMMIT \"${commit}\"\n")
