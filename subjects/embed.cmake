# SPDX-License-Identifier: Apache-2.0
# Writes OUT: the bytes of FILE as numbers, each followed by a comma.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "${bytes}")
