# SPDX-License-Identifier: Apache-2.0
# The Debian packages that `cpack` makes from a full build: graze, libgraze, libgraze-dev and python3-graze.
# scripts/debs builds and checks them.
if(GRAZE_CAMPAIGN OR GRAZE_PORTABLE)
  return()
endif()

# The program graze looks for its helper programs in its own folder.
foreach(program graze graze-subject-host graze-subject-device graze-subject-opencl)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION lib/graze COMPONENT program)
  endif()
endforeach()
install(CODE [[
  set(bin "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/bin")
  file(MAKE_DIRECTORY "${bin}")
  file(CREATE_LINK ../lib/graze/graze "${bin}/graze" SYMBOLIC)]] COMPONENT program)
install(CODE "
  execute_process(COMMAND ${PROJECT_SOURCE_DIR}/packaging/man_page $<TARGET_FILE:graze> OUTPUT_FILE ${CMAKE_BINARY_DIR}/graze.1 COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND gzip -9nkf ${CMAKE_BINARY_DIR}/graze.1 COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
install(FILES ${CMAKE_BINARY_DIR}/graze.1.gz DESTINATION share/man/man1 COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/subjects/include/graze/subject.h DESTINATION include/graze COMPONENT program)
install(TARGETS graze_query_shared graze_test LIBRARY DESTINATION lib COMPONENT libraries)

set(GRAZE_MAINTAINER "The Graze developers <graze@example.org>" CACHE STRING "Name and address in the Debian packages")
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/triggers CONTENT "activate-noawait ldconfig\n")
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/copyright CONTENT [[
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: graze

Files: *
Copyright: 2026 The Graze developers
License: Apache-2.0
 On Debian systems, the full text is in /usr/share/common-licenses/Apache-2.0.
Comment:
 The binaries contain code of header-only libraries. Their licenses are beside
 this file, as copyright.NAME. The program and the library of the Python package
 contain parts of CGAL that are under the GPL, version 3 or newer, so each of
 them as a whole is under that license.
]])
# Installs the licenses of header-only libraries. Each Debian package has its own list of libraries.
function(install_licenses component name)
  foreach(library IN LISTS ARGN)
    install(FILES /usr/share/doc/${library}/copyright DESTINATION share/doc/${name} RENAME copyright.${library} COMPONENT ${component} OPTIONAL)
  endforeach()
endfunction()
install_licenses(program graze libboost-dev libcgal-dev libcli11-dev librandom123-dev libstb-dev libtomlplusplus-dev nlohmann-json3-dev)
install_licenses(libraries libgraze librandom123-dev)
install_licenses(python python3-graze libcgal-dev librandom123-dev)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/changelog CONTENT [[
graze (@PROJECT_VERSION@) unstable; urgency=medium

  * Built from the repository.

 -- @GRAZE_MAINTAINER@  Thu, 26 Nov 2026 12:00:00 +0000
]] @ONLY)
execute_process(COMMAND gzip -9nkf ${CMAKE_BINARY_DIR}/changelog)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME graze)
set(CPACK_PACKAGE_CONTACT "${GRAZE_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/staged.cmake)
set(CPACK_COMPONENTS_ALL program libraries query test exact python)

# package(NAME COMPONENTS… SECTION section DEPENDS text WHAT line MORE text) describes one Debian package.
macro(package name)
  cmake_parse_arguments(package "" "SECTION;DEPENDS;WHAT;MORE" "COMPONENTS" ${ARGN})
  string(TOUPPER ${name} upper)
  foreach(component IN LISTS package_COMPONENTS)
    string(TOUPPER ${component} of)
    set(CPACK_COMPONENT_${of}_GROUP ${name})
  endforeach()
  list(GET package_COMPONENTS 0 first)
  install(FILES ${CMAKE_BINARY_DIR}/copyright ${CMAKE_BINARY_DIR}/changelog.gz DESTINATION share/doc/${name} COMPONENT ${first})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${package_SECTION})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${package_DEPENDS}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${package_WHAT}\n${package_MORE}")
endmacro()
package(graze COMPONENTS program SECTION science DEPENDS "procps"
  WHAT "find inputs on which triangle-triangle intersection tests are wrong"
  MORE "Draws pairs that nearly touch, are degenerate or are coplanar, decides\nthem with many tests on CPU and CUDA (without a device, with twins of the\nkernels), compares each verdict with exact arithmetic, and counts,\nshrinks and explains the wrong ones.")
package(libgraze COMPONENTS libraries SECTION libs
  WHAT "exact intersection of triangles, for programs and their tests"
  MORE "libgraze_query finds the triangles of an array that meet a given one;\nlibgraze_test tests a function of two triangles.")
set(CPACK_DEBIAN_LIBGRAZE_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/triggers)
package(libgraze-dev COMPONENTS query test exact SECTION libdevel DEPENDS "libgraze (= ${PROJECT_VERSION})"
  WHAT "exact intersection of triangles (development files)"
  MORE "Headers and CMake packages of graze::query, graze::test and graze::exact.")
package(python3-graze COMPONENTS python SECTION python DEPENDS "python3, python3-numpy"
  WHAT "hard pairs of triangles and their exact answers (Python 3)"
  MORE "NumPy arrays of pairs, exact intersection, and tests of a function of\ntwo triangles for pytest and unittest.")
include(CPack)
