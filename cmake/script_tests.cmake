# SPDX-License-Identifier: Apache-2.0
# The tests that run scripts, and the scripts' own tests.
add_test(NAME scripts.IncludeDirection COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/check_includes.py ${PROJECT_SOURCE_DIR})
foreach(script check_includes findings league measurements mutate near_models same_results speed_table torture update_generated verdicts_apart)
  add_test(NAME scripts.test.${script} COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/${script}.test.py)
endforeach()
# The next two tests need clang-format, black and prettier. They are skipped if a formatter is missing; the message
# names it.
add_test(NAME scripts.Format COMMAND ${PROJECT_SOURCE_DIR}/scripts/format --check --build ${CMAKE_BINARY_DIR})
set_tests_properties(scripts.Format PROPERTIES SKIP_RETURN_CODE 77)
add_test(NAME scripts.test.format COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/format.test.py ${CMAKE_BINARY_DIR})
set_tests_properties(scripts.test.format PROPERTIES SKIP_REGULAR_EXPRESSION "OK .skipped")
add_test(NAME scripts.AuditExplanations COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/audit_explanations.test.py $<TARGET_FILE:graze>)
# To test on a fresh system, run scripts/debs --try and scripts/container by hand.
add_test(NAME packaging.Containerfile COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/container --print)
if(CMAKE_BINARY_DIR STREQUAL ${PROJECT_SOURCE_DIR}/build)
  add_test(NAME scripts.Debs COMMAND ${PROJECT_SOURCE_DIR}/scripts/debs --out ${CMAKE_BINARY_DIR}/debs-test)
  set_tests_properties(scripts.Debs PROPERTIES SKIP_RETURN_CODE 77)
endif()
# The next two tests are skipped if a program they need is missing; the message names it.
add_test(NAME scripts.test.npm_package COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/npm_package.test.py ${CMAKE_BINARY_DIR})
add_test(NAME packaging.Action COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/packaging/action.test.py $<TARGET_FILE:graze>)
set_tests_properties(scripts.test.npm_package packaging.Action PROPERTIES SKIP_REGULAR_EXPRESSION "OK .skipped")
# If this build has no viewer, the test of the web site is skipped.
add_test(NAME scripts.test.results COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/results.test.py $<TARGET_FILE:graze>)
set_tests_properties(scripts.test.results PROPERTIES SKIP_REGULAR_EXPRESSION "OK .skipped")
# This test takes a minute on an idle machine. To run it by hand for an hour: scripts/torture --minutes 60. The seed
# changes with each commit, so in ten commits, the test kills campaigns and minimisations at a hundred moments.
add_test(NAME scripts.Torture COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/torture --rounds 2 --kills 10 --seed commits --graze $<TARGET_FILE:graze>)
set_tests_properties(scripts.Torture PROPERTIES TIMEOUT 1500)
# Checks that the tests catch defects planted in our own sources. This build's Ninja commands compile each defect.
if(CMAKE_GENERATOR STREQUAL Ninja)
  add_test(NAME scripts.PlantedDefects COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/mutate --planted --build ${CMAKE_BINARY_DIR} --out ${CMAKE_BINARY_DIR}/planted)
endif()
# To simulate a thousand shards, run scripts/simulate_shards by hand.
add_test(NAME scripts.SimulateShards COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/simulate_shards --graze $<TARGET_FILE:graze>
  --shards 12 --pairs 12000 --strata near_*,degenerate --lanes */f32/cpu --kill 0.5)
add_test(NAME scripts.Slurm COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/slurm/campaign.test.py $<TARGET_FILE:graze>)
set_tests_properties(scripts.Slurm PROPERTIES SKIP_RETURN_CODE 77)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_test(NAME scripts.test.odr COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/odr.test.py ${CMAKE_CXX_COMPILER})
endif()
add_test(NAME scripts.test.campaign COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/campaign.test.py ${CMAKE_BINARY_DIR} ${CMAKE_CXX_COMPILER})
# This test takes the build time plus three seconds per fuzz target. Each run uses a different seed. To run it by hand
# for an hour: scripts/fuzz --seconds 400.
add_test(NAME scripts.Fuzz COMMAND ${PROJECT_SOURCE_DIR}/scripts/fuzz --seconds 3 --build ${CMAKE_BINARY_DIR}/fuzz-targets)
set_tests_properties(scripts.Fuzz PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77)
# Tests that take a minute or more start first.
set_tests_properties(scripts.Fuzz scripts.Torture scripts.test.torture PROPERTIES COST 100)
if(GRAZE_LIBFUZZER)
  add_test(NAME scripts.FuzzEngine COMMAND ${PROJECT_SOURCE_DIR}/scripts/fuzz --seconds 3 --build ${CMAKE_BINARY_DIR}/fuzz-engine --program $<TARGET_FILE:graze_engine_targets>)
endif()
