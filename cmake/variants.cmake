# SPDX-License-Identifier: Apache-2.0
# Reads core/variants.inc. Sets `variants` (the names) and, for each NAME, the variables variant_NAME_runs_on,
# variant_NAME_arithmetic, variant_NAME_twin and variant_NAME_flags (a list; without -m… on processors other than x86).
set(variants_file ${CMAKE_CURRENT_LIST_DIR}/../core/variants.inc)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${variants_file})
file(STRINGS ${variants_file} rows REGEX "^GRAZE_VARIANT\\(")
foreach(row IN LISTS rows)
  if(NOT row MATCHES "^GRAZE_VARIANT\\(([a-z_]+), \"[a-z-]+\", ([a-z]+), ([a-z]+), ([a-z_]+), \"[^\"]*\", \"([^\"]*)\"\\)$")
    message(FATAL_ERROR "${variants_file}: expected a row of seven columns, found: ${row}")
  endif()
  set(name ${CMAKE_MATCH_1})
  list(APPEND variants ${name})
  set(variant_${name}_runs_on ${CMAKE_MATCH_2})
  set(variant_${name}_arithmetic ${CMAKE_MATCH_3})
  set(variant_${name}_twin ${CMAKE_MATCH_4})
  separate_arguments(flags UNIX_COMMAND "${CMAKE_MATCH_5}")
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(FILTER flags EXCLUDE REGEX "^-m")
  endif()
  set(variant_${name}_flags ${flags})
endforeach()

# graze_objects(NAME NAMESPACE SOURCES file… [FLAGS flag…]) makes the object library NAME, compiled with these flags and
# in the namespace NAMESPACE, which the sources call GRAZE_FP.
function(graze_objects name namespace)
  cmake_parse_arguments(arg "" "" "SOURCES;FLAGS" ${ARGN})
  add_library(${name} OBJECT ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE graze_flags)
  target_compile_definitions(${name} PRIVATE GRAZE_FP=${namespace})
  target_compile_options(${name} PRIVATE ${arg_FLAGS})
endfunction()
