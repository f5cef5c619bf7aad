# Build settings of this project: where things go, which flags our own code is compiled with, and the two functions that
# every room uses. Nothing here reaches those who use the installed package.
include(GNUInstallDirs)

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_CXX_EXTENSIONS OFF)
# The difference to -O3 is not measurable here, that in compile time is.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)

add_library(veridyn_build INTERFACE)
target_compile_features(veridyn_build INTERFACE cxx_std_20)
target_compile_options(
  veridyn_build
  INTERFACE -Wall
            -Wextra
            -Wpedantic
            -Wconversion
            -Wshadow
            $<$<BOOL:${VERIDYN_WERROR}>:-Werror>
            $<$<BOOL:${VERIDYN_SANITIZE}>:-fsanitize=address,undefined;-fno-sanitize-recover=all;-fno-omit-frame-pointer>
            $<$<BOOL:${VERIDYN_FUZZ}>:-fsanitize=fuzzer-no-link,address,undefined>)
target_link_options(veridyn_build INTERFACE $<$<BOOL:${VERIDYN_SANITIZE}>:-fsanitize=address,undefined>
                    $<$<BOOL:${VERIDYN_FUZZ}>:-fsanitize=address,undefined>)

# veridyn_room(NAME SOURCES a.cpp ... HEADERS a.hpp ... [DEPENDS Veridyn::core ...] [PRIVATE lib ...])
# A room: static library veridyn_NAME, alias Veridyn::NAME, headers installed with their folders.
function(veridyn_room name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;DEPENDS;PRIVATE" ${ARGN})
  set(target veridyn_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(Veridyn::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE $<BUILD_INTERFACE:veridyn_build> ${ARG_PRIVATE})
  if(NOT name STREQUAL "core")
    target_precompile_headers(${target} PRIVATE <fmt/format.h> <fmt/ranges.h> <Eigen/Dense> <algorithm> <map> <string> <vector>)
  endif()
  install(
    TARGETS ${target}
    EXPORT VeridynTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# veridyn_embed_texts(OUTPUT HEADER NAMESPACE FUNCTION FILES...)
# Writes OUTPUT, which defines `std::span<const EmbeddedText> NAMESPACE::FUNCTION()` as HEADER declares it: the texts of
# FILES by their names. An edited file is noticed.
function(veridyn_embed_texts output header namespace function)
  set(code "#include \"${header}\"\nnamespace ${namespace} {\nnamespace {\nconstexpr EmbeddedText kTexts[] = {\n")
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND code "{\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  string(APPEND code "};\n}  // namespace\nstd::span<const EmbeddedText> ${function}() { return kTexts; }\n}  // namespace ${namespace}\n")
  file(CONFIGURE OUTPUT ${output} CONTENT "${code}" @ONLY)
endfunction()

# veridyn_room_tests(NAME SOURCES a_test.cpp ... [DEPENDS ...])
# One test binary a room: veridyn_NAME_tests, its cases registered with CTest. VERIDYN_SHARED_DIR is where recordings by
# others may lie; tests that read them skip when it is missing.
function(veridyn_room_tests name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  set(target veridyn_${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE Veridyn::${name} ${ARG_DEPENDS} veridyn_build GTest::gtest GTest::gmock GTest::gtest_main)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${target} PRIVATE VERIDYN_SHARED_DIR="${PROJECT_SOURCE_DIR}/../shared"
                                               VERIDYN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Tests are compiled once and run once: optimising them takes longer than it saves. What they test is optimised.
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <gtest/gtest.h> <string> <vector> <fmt/format.h>)
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${name} TIMEOUT 600)
endfunction()
