# SPDX-License-Identifier: Apache-2.0
# Writes the bytes of FILE to OUT as numbers, each followed by a comma.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "${bytes}")
