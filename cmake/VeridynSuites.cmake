# Read by CTest when it starts, for one test binary: a test for each suite of it, MODULE.Suite, of those cases that are not
# tests of their own (veridyn_suites). One process a suite: starting one for each of the 3500 cases took a third of
# the time of all.
# BINARY, MODULE, LABEL, LEFT_OUT: the binary, its module, the label of its tests, the filter of cases that are left out
cmake_policy(VERSION 3.25) # CTest sets none
if(NOT EXISTS "${BINARY}")
  add_test("${MODULE}.NotBuilt" "${BINARY}")
  set_tests_properties("${MODULE}.NotBuilt" PROPERTIES LABELS "${LABEL}")
  return()
endif()
execute_process(
  COMMAND "${BINARY}" --gtest_list_tests "--gtest_filter=-${LEFT_OUT}"
  OUTPUT_VARIABLE listed
  RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${BINARY} does not list its tests: ${failed}")
endif()
# "Suite." or "Suite/0.  # TypeParam = ..." at the beginning of a line, cases below it.
string(REGEX MATCHALL "[^\n]+" lines "${listed}")
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^([A-Za-z0-9_/]+)\\.( |$)")
    continue()
  endif()
  set(suite ${CMAKE_MATCH_1})
  add_test("${MODULE}.${suite}" "${BINARY}" "--gtest_filter=${suite}.*-${LEFT_OUT}" --gtest_brief=1)
  # 77: some of its cases were skipped, and none failed (tests/support/main.cpp).
  set_tests_properties("${MODULE}.${suite}" PROPERTIES LABELS "${LABEL}" TIMEOUT 1800 RESOURCE_GROUPS cores:1 SKIP_RETURN_CODE 77
                                                       ENVIRONMENT "VERIDYN_SKIPPED=77")
  # The longest first, so that nothing is left to wait for at the end (CTest knows how long they take from the second run on).
  if("${MODULE}.${suite}" MATCHES "^apps\.|EveryWashout$")
    set_tests_properties("${MODULE}.${suite}" PROPERTIES COST 500)
  endif()
endforeach()
