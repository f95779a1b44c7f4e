# SPDX-License-Identifier: Apache-2.0
# Runs the page's tests from SOURCE in BUILD, which contains their packages, on a report made by GRAZE.
find_program(CHROMIUM NAMES chromium chromium-browser google-chrome)
if(NOT NODE)
  message("reports.Page skipped: no Node found (Debian's packages nodejs and npm)")
  return()
elseif(NOT CHROMIUM)
  message("reports.Page skipped: no Chromium found (Debian's package chromium)")
  return()
elseif(NOT EXISTS ${BUILD}/node_modules/installed)
  message("reports.Page skipped: npm could not fetch the page's packages when this was built")
  return()
endif()

file(REMOVE_RECURSE ${BUILD}/tests)
foreach(part playwright.config.js tests src)
  file(COPY ${SOURCE}/${part} DESTINATION ${BUILD})
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -E env GRAZE=${GRAZE} GRAZE_CHROMIUM=${CHROMIUM} GRAZE_TEST_OUTPUT=${BUILD}/test-results
  ${NODE} node_modules/@playwright/test/cli.js test WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "the page's tests failed")
endif()
