# SPDX-License-Identifier: Apache-2.0
# Removes the libraries from what cpack has staged for libgraze-dev, because they belong to libgraze alone.
# `cmake --install --component query` installs them with their headers.
file(GLOB libraries "${CPACK_TEMPORARY_DIRECTORY}/libgraze-dev/usr/lib/*.so")
if(libraries)
  file(REMOVE ${libraries})
endif()
