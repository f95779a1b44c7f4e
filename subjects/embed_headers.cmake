# SPDX-License-Identifier: Apache-2.0
# Writes a row {"NAME", "text"}, of each of FILES in the folder FROM to OUT.
foreach(file IN LISTS FILES)
  file(READ ${FROM}/${file} text)
  string(APPEND rows "{\"${file}\", R\"header(${text})header\"},\n")
endforeach()
file(WRITE ${OUT} "${rows}")
