# SPDX-License-Identifier: Apache-2.0
# graze_embed(OUT FROM file…): writes OUT with a row {"file", "text"}, for each of these files in the folder FROM.
function(graze_embed out from)
  list(TRANSFORM ARGN PREPEND ${from}/ OUTPUT_VARIABLE files)
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake)
  add_custom_command(OUTPUT ${out} DEPENDS ${files} ${script} COMMENT ""
    COMMAND ${CMAKE_COMMAND} "-DFILES=$<JOIN:${ARGN},$<SEMICOLON>>" -DFROM=${from} -DOUT=${out} -P ${script} VERBATIM)
endfunction()
