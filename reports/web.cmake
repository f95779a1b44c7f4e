# SPDX-License-Identifier: Apache-2.0
# Builds the page of SOURCE (reports/web) in BUILD, and writes it to OUT as a C++ string. If npm cannot download its
# packages, for example offline, the string is empty, and reports are plain pages. Also writes the viewer to VIEWER, and
# the modules WASM_F32 and WASM_F64 to MODULES, as base64 of gzip. Without modules, these strings are empty.
file(MAKE_DIRECTORY ${BUILD})
file(REMOVE_RECURSE ${BUILD}/src)
foreach(part index.html view.html package.json package-lock.json tsconfig.json vite.config.js src)
  file(COPY ${SOURCE}/${part} DESTINATION ${BUILD})
endforeach()

file(COPY ${SOURCE}/../../wasm/graze.js DESTINATION ${BUILD}/src/viewer)
file(WRITE ${VIEWER} "\"\"\n")
file(WRITE ${MODULES} "constexpr char kModuleF32[] = \"\", kModuleF64[] = \"\";\n")

file(SHA256 ${BUILD}/package-lock.json lock)
set(installed "")
if(EXISTS ${BUILD}/node_modules/installed)
  file(READ ${BUILD}/node_modules/installed installed)
endif()
if(NOT installed STREQUAL lock)
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1
    WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE why)
  if(why MATCHES EUSAGE)
    message(FATAL_ERROR "package-lock.json does not fit package.json:\n${why}")
  elseif(failed)
    message(WARNING "npm ci failed, so reports will be plain pages; to try again, remove ${OUT} and build.\n${why}")
    file(WRITE ${OUT} "\"\"\n")
    return()
  endif()
  file(WRITE ${BUILD}/node_modules/installed ${lock})
endif()

function(build script html out)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GRAZE_VIEWER=${WASM_F32} GRAZE_SOURCE=${SOURCE}/../.. ${NPM} run --silent ${script} WORKING_DIRECTORY ${BUILD}
    RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "cannot build reports/web:\n${said}")
  endif()
  file(READ ${BUILD}/dist/${html} page)
  file(WRITE ${out} "R\"graze_page(${page})graze_page\"\n")
endfunction()
build(build index.html ${OUT})
if(WASM_F32)
  build(build-viewer view.html ${VIEWER})
  file(WRITE ${MODULES} "")
  foreach(type F32 F64)
    execute_process(COMMAND ${NODE} -e "process.stdout.write(require('zlib').gzipSync(require('fs').readFileSync(process.argv[1]), { level: 9 }).toString('base64'))"
      ${WASM_${type}} OUTPUT_VARIABLE module COMMAND_ERROR_IS_FATAL ANY)
    file(APPEND ${MODULES} "constexpr char kModule${type}[] = \"${module}\";\n")
  endforeach()
endif()
