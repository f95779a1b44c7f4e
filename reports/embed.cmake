# SPDX-License-Identifier: Apache-2.0
# Writes OUT: a row {"path", R"graze(text)graze"} for each file in SOURCE from which snippets are made.
file(GLOB files RELATIVE ${SOURCE} ${SOURCE}/core/*.h ${SOURCE}/core/lanes/*.h ${SOURCE}/core/exact/relation.h ${SOURCE}/core/exact/host_device.h ${SOURCE}/core/algorithms/*.h ${SOURCE}/reports/snippets/*.in)
set(rows "")
foreach(file ${files})
  file(READ ${SOURCE}/${file} text)
  string(APPEND rows "{\"${file}\", R\"graze(${text})graze\"},\n")
endforeach()
file(WRITE ${OUT} "${rows}")
