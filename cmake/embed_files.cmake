# SPDX-License-Identifier: Apache-2.0
# Writes to OUT a row {"NAME", "text"}, for each of the FILES in the folder FROM.
foreach(file IN LISTS FILES)
  file(READ ${FROM}/${file} text)
  string(APPEND rows "{\"${file}\", R\"header(${text})header\"},\n")
endforeach()
file(WRITE ${OUT} "${rows}")
