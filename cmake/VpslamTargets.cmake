# Helpers that give every target of the project the same flags. No -march=native: Eigen's alignment
# must agree with Debian's Ceres. No -ffast-math: results must not depend on it.

add_library(vpslam_flags INTERFACE)
target_compile_options(vpslam_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wno-psabi $<$<BOOL:${VPSLAM_WERROR}>:-Werror>)
target_include_directories(vpslam_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})

# vpslam_library(NAME SOURCES a.cpp ... DEPENDS target ...)
function(vpslam_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC vpslam_flags ${ARG_DEPENDS})
endfunction()

# All processes, without the tests: what scripts/vpslam builds.
add_custom_target(programs)

# vpslam_program(NAME SOURCES main.cpp DEPENDS target ...): a process, installed to bin/.
function(vpslam_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE vpslam_flags ${ARG_DEPENDS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME DESTINATION bin)
  add_dependencies(programs ${name})
endfunction()

# vpslam_test(NAME SOURCES a_test.cpp ... DEPENDS target ... [TIMEOUT seconds] [PRIVATE_NETWORK])
# PRIVATE_NETWORK: the test sends multicast, and does so in a network namespace of its own.
function(vpslam_test name)
  cmake_parse_arguments(ARG "PRIVATE_NETWORK" "TIMEOUT" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 180)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE vpslam_flags ${ARG_DEPENDS} GTest::gtest GTest::gmock
                        GTest::gtest_main)
  set(launcher)
  if(ARG_PRIVATE_NETWORK)
    set(launcher ${PROJECT_SOURCE_DIR}/tests/private_network)
  endif()
  add_test(NAME ${name} COMMAND ${launcher} $<TARGET_FILE:${name}>)
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()

# vpslam_python_test(NAME FILE [TIMEOUT seconds] [LABELS label ...]): a file of Python's unittest,
# run by Debian's Python. It finds the programs of this build in VPSLAM_BIN_DIR.
function(vpslam_python_test name file)
  cmake_parse_arguments(ARG "" "TIMEOUT" "LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 180)
  endif()
  add_test(NAME ${name} COMMAND /usr/bin/python3 -s ${CMAKE_CURRENT_SOURCE_DIR}/${file} -v)
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
                       ENVIRONMENT VPSLAM_BIN_DIR=${PROJECT_BINARY_DIR}/bin)
endfunction()
