# SPDX-License-Identifier: Apache-2.0
# Removes the libraries from the files that cpack has staged for libgraze-dev, because only libgraze contains them.
# `cmake --install --component query` installs the libraries with their headers.
file(GLOB libraries "${CPACK_TEMPORARY_DIRECTORY}/libgraze-dev/usr/lib/*.so")
if(libraries)
  file(REMOVE ${libraries})
endif()
