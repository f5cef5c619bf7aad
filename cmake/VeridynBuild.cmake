# Build settings of this project: where things go, which flags our own code is compiled with, and the two functions that
# every module uses. Nothing here reaches those who use the installed package.
include(GNUInstallDirs)

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
# Libraries that the program loads while it runs, and where it looks for them.
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
set(CMAKE_BUILD_RPATH ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(VERIDYN_INSTALL_PLUGINS ${CMAKE_INSTALL_LIBDIR}/veridyn)
file(RELATIVE_PATH from_bin_to_plugins /${CMAKE_INSTALL_BINDIR} /${VERIDYN_INSTALL_PLUGINS})
set(CMAKE_INSTALL_RPATH $ORIGIN/${from_bin_to_plugins})
set(CMAKE_CXX_EXTENSIONS OFF)
# The difference to -O3 is not measurable here, that in compile time is.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(VERIDYN_ASSERTIONS)
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -D_GLIBCXX_ASSERTIONS")
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE_PROGRAM})
endif()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)

# Without what the address sanitizer sees as well: a null pointer that is used, an object that is too small. Where the whole
# library is sanitized (VERIDYN_SANITIZE) addresses that are no multiple of what is read there are left out too. Together a
# quarter of the time to compile.
set(sanitizers -fsanitize=address,undefined -fno-sanitize=null,object-size -fno-sanitize-recover=all -fno-omit-frame-pointer)

add_library(veridyn_build INTERFACE)
target_compile_features(veridyn_build INTERFACE cxx_std_20)
target_compile_options(
  veridyn_build
  INTERFACE -Wall
            -Wextra
            -Wpedantic
            -Wconversion
            -Wshadow
            # Sizes of the standard library are unsigned, Eigen's indices are not; casting one to the other hid what a line computes.
            $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
            $<$<BOOL:${VERIDYN_WERROR}>:-Werror>
            $<$<BOOL:${VERIDYN_SANITIZE}>:${sanitizers};-fno-sanitize=alignment>
            $<$<BOOL:${VERIDYN_SANITIZE_THREAD}>:-fsanitize=thread;-fno-omit-frame-pointer>)
target_link_options(veridyn_build INTERFACE $<$<BOOL:${VERIDYN_SANITIZE}>:-fsanitize=address,undefined>
                    $<$<BOOL:${VERIDYN_SANITIZE_THREAD}>:-fsanitize=thread>)

# Headers that nearly every source needs, precompiled once for the library and once for the tests. GCC takes the level of
# optimisation from the precompiled header, whatever the command line says: there, sources with a level of their own do without
# it (veridyn_optimise).
set(own_level_without_headers OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(own_level_without_headers ON)
endif()
# veridyn_precompiled(TARGET [POSITION_INDEPENDENT] LIBRARIES lib ... HEADERS <a.hpp> ...)
function(veridyn_precompiled target)
  cmake_parse_arguments(ARG "POSITION_INDEPENDENT" "" "LIBRARIES;HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp CONTENT "")
  add_library(${target} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF POSITION_INDEPENDENT_CODE ${ARG_POSITION_INDEPENDENT})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} Eigen3::Eigen fmt::fmt)
  target_precompile_headers(${target} PRIVATE ${ARG_HEADERS})
endfunction()
set(library_headers <fmt/format.h> <fmt/ranges.h> <Eigen/Dense> <algorithm> <chrono> <complex> <filesystem> <functional> <map> <memory> <optional>
                    <random> <ranges> <span> <sstream> <string> <variant> <vector>)
veridyn_precompiled(veridyn_library_headers POSITION_INDEPENDENT LIBRARIES veridyn_build HEADERS ${library_headers})

# What reads bytes of strangers, compiled once more with the sanitizers and with the counters that lead libFuzzer
# (veridyn_sanitized_objects). What these sources use of the rest is the library as it is: sanitizing all of it for the sake of its readers
# took four times as long. Objects of both kinds share the globals of headers, hence none of them has guarded ends; `asan` has them.
add_library(veridyn_sanitizers INTERFACE)
target_compile_options(veridyn_sanitizers INTERFACE -O1 -g1 ${sanitizers} -fsanitize=fuzzer-no-link "SHELL:-mllvm -asan-globals=0")
target_link_options(veridyn_sanitizers INTERFACE -fsanitize=address,undefined)
if(VERIDYN_SANITIZED_READERS)
  veridyn_precompiled(veridyn_sanitized_headers POSITION_INDEPENDENT LIBRARIES veridyn_build veridyn_sanitizers HEADERS ${library_headers})
  set_target_properties(veridyn_sanitized_headers PROPERTIES EXCLUDE_FROM_ALL ON EXPORT_COMPILE_COMMANDS OFF)
endif()

# veridyn_optimise(a.cpp ...)
# Sources whose loops over small matrices have to be unrolled: -O3. The check
# `build.OptimisedSources` of the tests reads the flags that the compiler really used.
function(veridyn_optimise)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>" SKIP_PRECOMPILE_HEADERS ${own_level_without_headers})
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set_property(GLOBAL APPEND PROPERTY VERIDYN_OPTIMISED_SOURCES ${ARGN})
endfunction()

# veridyn_inline(a.cpp ...)
# Sources whose time is automatic differentiation of a model: -O2 leaves most of its sums and products as calls of functions, -O3
# splits them into vectors that the next one has to wait for (twice as slow, GCC 12). Inlined they take two thirds of the time.
function(veridyn_inline)
  set_source_files_properties(
    ${ARGN} PROPERTIES SKIP_PRECOMPILE_HEADERS ${own_level_without_headers} COMPILE_OPTIONS
    "$<$<CXX_COMPILER_ID:GNU>:-finline-limit=2000;--param=inline-unit-growth=1000;--param=max-inline-insns-auto=400;--param=large-function-growth=1000>")
endfunction()

# veridyn_compile_together(TARGET)
# In presets with CMAKE_UNITY_BUILD the sources of a folder are compiled together, as unity_FOLDER: what they include and the
# templates that they share are paid once. A folder of fewer than three sources goes with the folder above it. Names in unnamed
# namespaces must therefore differ within a folder, which `make tidy` checks (tools/unnamed_names.mjs). The `dev` preset compiles
# each source by itself.
function(veridyn_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH folder)
    if(NOT folder STREQUAL "" AND NOT IS_ABSOLUTE "${folder}")
      set(same ${sources})
      list(FILTER same INCLUDE REGEX "^${folder}/[^/]+$")
      list(LENGTH same count)
      if(count LESS 3)
        cmake_path(GET folder PARENT_PATH folder)
      endif()
    endif()
    cmake_path(IS_ABSOLUTE folder generated)
    if(generated OR folder STREQUAL "")
      cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
    endif()
    string(REPLACE "/" "_" group "${folder}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()

# veridyn_public_headers(OUT FACE.hpp ...)
# What is installed: the FACEs (veridyn/aircraft.hpp ...) and, in turn, all that they include of ours, as paths below the root. Read
# from the #include lines while CMake configures, which it does again when one of these headers has changed.
function(veridyn_public_headers out)
  set(public "")
  set(to_read ${ARGN})
  while(to_read)
    list(POP_FRONT to_read header)
    if(NOT header IN_LIST public)
      list(APPEND public ${header})
      file(STRINGS ${PROJECT_SOURCE_DIR}/${header} included REGEX "^#include \"veridyn/")
      list(TRANSFORM included REPLACE "^#include \"([^\"]+)\".*" "\\1")
      list(APPEND to_read ${included})
    endif()
  endwhile()
  set(files ${public})
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  set(${out} ${public} PARENT_SCOPE)
endfunction()

# veridyn_sanitized_objects(TARGET LIBRARIES lib ... SOURCES a.cpp ...)
# The objects of these sources of a library as the sanitizers want them: TARGET_sanitized. Linked before the library they take the place of
# its own, which hold the same sources (veridyn_compile_together), so that the linker finds nothing there that is still missing.
function(veridyn_sanitized_objects target)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;SOURCES" ${ARGN})
  set(objects ${target}_sanitized)
  add_library(${objects} OBJECT EXCLUDE_FROM_ALL ${ARG_SOURCES})
  # clang-tidy looks at each source once, as the library compiles it.
  set_target_properties(${objects} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_COMPILE_COMMANDS OFF)
  target_link_libraries(${objects} PRIVATE ${ARG_LIBRARIES} veridyn_build veridyn_sanitizers)
  target_compile_definitions(${objects} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
  target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR})
  target_precompile_headers(${objects} REUSE_FROM veridyn_sanitized_headers)
  veridyn_compile_together(${objects})
endfunction()

# veridyn_module(NAME [DEPENDS Veridyn::core ...] [PRIVATE lib ...] [SOURCES generated.cpp ...] [WITHOUT a.cpp ...] [READERS folder ...])
# A module: static library veridyn_NAME, alias Veridyn::NAME, of all sources in its folder and the folders below. Its face
# veridyn/NAME.hpp and those of its headers that are public are installed with their folders (veridyn_public_headers).
# READERS: which of its folders read bytes of strangers, `.` for all.
function(veridyn_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;PRIVATE;SOURCES;WITHOUT;READERS" ${ARGN})
  set(target veridyn_${name})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  set(headers ${VERIDYN_PUBLIC_HEADERS})
  list(FILTER headers INCLUDE REGEX "^veridyn/${name}(/|\\.hpp$)")
  list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/)
  list(REMOVE_ITEM sources ${ARG_WITHOUT})
  add_library(${target} ${sources} ${ARG_SOURCES})
  add_library(Veridyn::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE $<BUILD_INTERFACE:veridyn_build> ${ARG_PRIVATE})
  if(NOT name STREQUAL "core")
    target_precompile_headers(${target} REUSE_FROM veridyn_library_headers)
  endif()
  veridyn_compile_together(${target})
  if(VERIDYN_SANITIZED_READERS AND ARG_READERS)
    set(readers ${sources} ${ARG_SOURCES})
    if(NOT ARG_READERS STREQUAL ".")
      list(JOIN ARG_READERS "|" folders)
      list(FILTER readers INCLUDE REGEX "^(${folders})/")
    endif()
    veridyn_sanitized_objects(${target} LIBRARIES ${ARG_DEPENDS} ${ARG_PRIVATE} SOURCES ${readers})
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
  set(code "#include \"${header}\"\nnamespace ${namespace} {\nstd::span<const EmbeddedText> ${function}() {\nstatic constexpr EmbeddedText texts[] = {\n")
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND code "{\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  string(APPEND code "};\nreturn texts;\n}\n}  // namespace ${namespace}\n")
  file(CONFIGURE OUTPUT ${output} CONTENT "${code}" @ONLY)
endfunction()

# veridyn_module_tests(NAME [DEPENDS ...] [WITHOUT a_test.cpp ...] [SEPARATELY folder ...])
# One test binary a module, veridyn_NAME_tests, of all sources below the folder, and one for each folder named SEPARATELY,
# veridyn_FOLDER_tests: those of readers, which the sanitizers run without the rest of their module (READERS in the Makefile).
function(veridyn_module_tests name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;WITHOUT;SEPARATELY" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  list(REMOVE_ITEM sources ${ARG_WITHOUT})
  foreach(folder IN LISTS ARG_SEPARATELY)
    set(in_folder ${sources})
    list(FILTER in_folder INCLUDE REGEX "^${folder}/")
    list(FILTER sources EXCLUDE REGEX "^${folder}/")
    veridyn_test_binary(${folder} DEPENDS Veridyn::${name} ${ARG_DEPENDS} SOURCES ${in_folder})
  endforeach()
  veridyn_test_binary(${name} DEPENDS $<TARGET_NAME_IF_EXISTS:Veridyn::${name}> ${ARG_DEPENDS} SOURCES ${sources})
endfunction()

# veridyn_read_test_lists()
# Sets `long`, `campaign`, `waiting` and `lone` to the filters of tests/LIST_tests.txt as GoogleTest has them, and LIST_names as CMake.
macro(veridyn_read_test_lists)
  foreach(list long campaign waiting lone)
    set(file ${PROJECT_SOURCE_DIR}/tests/${list}_tests.txt)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(STRINGS ${file} ${list} REGEX "^[^#]")
    list(JOIN ${list} "|" ${list}_names)
    list(TRANSFORM ${list} REPLACE "(.+)" "*\\1*")
    list(JOIN ${list} ":" ${list})
  endforeach()
endmacro()

# veridyn_suites(TARGET MODULE LABEL LEFT_OUT)
# A test of CTest for each suite of this binary, MODULE.Suite (VeridynSuites.cmake), without the cases of the filter LEFT_OUT.
function(veridyn_suites target module label left_out)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
set(BINARY "@CMAKE_RUNTIME_OUTPUT_DIRECTORY@/@target@")
set(MODULE "@module@")
set(LABEL "@label@")
set(LEFT_OUT "@left_out@")
include("@PROJECT_SOURCE_DIR@/cmake/VeridynSuites.cmake")
]])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
endfunction()

# veridyn_test_binary(NAME SOURCES ... [DEPENDS ...])
# veridyn_NAME_tests; each suite of it is a test of CTest, NAME.Suite, under the label NAME (VeridynSuites.cmake). Tests of their
# own are cases of suites named *Soak*, long-running campaigns under the label `soak`, which `make soak` runs; those that
# tests/long_tests.txt and tests/campaign_tests.txt name, labels `NAME.long` and `NAME.campaign`, which `make long` and `make
# campaigns` run and the sanitizers do not; those that wait
# (tests/waiting_tests.txt), beside what takes one of the cores that `make test` distributes; and those that nothing runs beside
# (tests/lone_tests.txt).
function(veridyn_test_binary name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;SOURCES" ${ARGN})
  set(target veridyn_${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_DEPENDS} veridyn_test_build veridyn_test_main)
  target_precompile_headers(${target} REUSE_FROM veridyn_test_headers)
  veridyn_compile_together(${target})
  veridyn_read_test_lists()
  set(alone ${waiting}:${lone})
  set(later *Soak*:${long}:${campaign})
  gtest_discover_tests(${target} TEST_FILTER ${alone}-${later} TEST_LIST ${target}_alone DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${name} TIMEOUT 600)
  gtest_discover_tests(${target} TEST_FILTER ${long}-*Soak*:${campaign} TEST_LIST ${target}_long DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${name}.long TIMEOUT 600)
  gtest_discover_tests(${target} TEST_FILTER ${campaign}-*Soak* TEST_LIST ${target}_campaign DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${name}.campaign TIMEOUT 600)
  gtest_discover_tests(${target} TEST_FILTER *Soak* DISCOVERY_TIMEOUT 60 PROPERTIES LABELS soak ENVIRONMENT VERIDYN_SOAK=1 TIMEOUT 7200)

  # What CTest reads after the tests of this folder.
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_resources.cmake)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
foreach(test IN LISTS @target@_alone @target@_long @target@_campaign)
  if(test MATCHES "@lone_names@")
    set_tests_properties(${test} PROPERTIES RUN_SERIAL TRUE)
  elseif(test MATCHES "@waiting_names@")
    set_tests_properties(${test} PROPERTIES RESOURCE_GROUPS waiting:1 COST 1000)
  else()
    set_tests_properties(${test} PROPERTIES RESOURCE_GROUPS cores:1)
  endif()
endforeach()
]])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
  veridyn_suites(${target} ${name} ${name} ${later}:${alone})
endfunction()

# veridyn_sanitized_tests(NAME MODULE...)
# veridyn_NAME_tests with the readers of these modules sanitized, as the target veridyn_NAME_sanitized_tests and under the label
# `sanitized` (`make asan-readers`).
function(veridyn_sanitized_tests name)
  if(NOT VERIDYN_SANITIZED_READERS)
    return()
  endif()
  set(target veridyn_${name}_sanitized_tests)
  set(tests veridyn_${name}_tests)
  list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_OBJECTS:veridyn_\\1_sanitized>" OUTPUT_VARIABLE readers)
  add_executable(${target} EXCLUDE_FROM_ALL $<TARGET_OBJECTS:${tests}> ${readers})
  get_target_property(libraries ${tests} LINK_LIBRARIES)
  target_link_libraries(${target} PRIVATE ${libraries})
  target_link_options(${target} PRIVATE $<TARGET_PROPERTY:veridyn_sanitizers,INTERFACE_LINK_OPTIONS>)
  set_property(GLOBAL APPEND PROPERTY VERIDYN_SANITIZED_TESTS ${target})
  veridyn_read_test_lists()
  veridyn_suites(${target} sanitized.${name} sanitized *Soak*:${long}:${campaign})
endfunction()

# veridyn_waiting_tests(TEST...): tests that mostly wait; they take no core of those that `make test` distributes, and start
# first.
function(veridyn_waiting_tests)
  set_tests_properties(${ARGN} PROPERTIES RESOURCE_GROUPS waiting:1 COST 1000)
endfunction()
