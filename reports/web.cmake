# SPDX-License-Identifier: Apache-2.0
# Builds the page of SOURCE (reports/web) in BUILD, and writes it to OUT as a C++ string. If npm cannot fetch its
# packages, for example offline, the string is empty, and reports are plain pages. Also writes the viewer, which
# includes the module WASM, to VIEWER. Without a module that string is empty.
file(MAKE_DIRECTORY ${BUILD})
file(REMOVE_RECURSE ${BUILD}/src)
foreach(part index.html view.html package.json package-lock.json tsconfig.json vite.config.js src)
  file(COPY ${SOURCE}/${part} DESTINATION ${BUILD})
endforeach()

file(COPY ${SOURCE}/../../wasm/graze.js DESTINATION ${BUILD}/src/viewer)
file(WRITE ${VIEWER} "\"\"\n")

file(SHA256 ${BUILD}/package-lock.json lock)
set(installed "")
if(EXISTS ${BUILD}/node_modules/installed)
  file(READ ${BUILD}/node_modules/installed installed)
endif()
if(NOT installed STREQUAL lock)
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1
    WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE why)
  if(why MATCHES EUSAGE)
    message(FATAL_ERROR "expected package-lock.json to fit package.json, found:\n${why}")
  elseif(failed)
    message(WARNING "npm ci failed, so reports will be plain pages; to try again, remove ${OUT} and build.\n${why}")
    file(WRITE ${OUT} "\"\"\n")
    return()
  endif()
  file(WRITE ${BUILD}/node_modules/installed ${lock})
endif()

function(build script html out)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GRAZE_WASM=${WASM} GRAZE_SOURCE=${SOURCE}/../.. ${NPM} run --silent ${script} WORKING_DIRECTORY ${BUILD}
    RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "expected reports/web to build, found:\n${said}")
  endif()
  file(READ ${BUILD}/dist/${html} page)
  file(WRITE ${out} "R\"graze_page(${page})graze_page\"\n")
endfunction()
build(build index.html ${OUT})
if(WASM)
  build(build-viewer view.html ${VIEWER})
endif()
