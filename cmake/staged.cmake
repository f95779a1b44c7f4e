# SPDX-License-Identifier: Apache-2.0
# Before cpack packs what it has staged: the libraries belong to libgraze alone. `cmake --install --component query`
# installs them with their headers.
file(GLOB libraries "${CPACK_TEMPORARY_DIRECTORY}/libgraze-dev/usr/lib/*.so")
if(libraries)
  file(REMOVE ${libraries})
endif()
