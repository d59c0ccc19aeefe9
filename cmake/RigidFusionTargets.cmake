# SPDX-License-Identifier: BSD-3-Clause
# One place for the standard, the warnings and the CPU baseline of our own targets.

option(RF_WERROR "Treat compiler warnings as errors (on in CI)" OFF)
set(RF_SANITIZE "" CACHE STRING "Comma-separated -fsanitize= list for all our targets; empty for none")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(RF_CPU_BASELINE "x86-64-v3" CACHE STRING "-march baseline; never 'native' for robots")
else()
  set(RF_CPU_BASELINE "" CACHE STRING "-march baseline; empty for the compiler's default")
endif()

add_library(rf_options INTERFACE)
target_compile_features(rf_options INTERFACE cxx_std_20)
target_compile_options(rf_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  $<$<BOOL:${RF_WERROR}>:-Werror>
  $<$<BOOL:${RF_CPU_BASELINE}>:-march=${RF_CPU_BASELINE}>
  # Nothing here reads errno or floating-point traps; without them square roots are inline and conditions vectorise.
  -fno-math-errno -fno-trapping-math
  $<$<CONFIG:Release>:-O3>)
target_include_directories(rf_options INTERFACE ${PROJECT_SOURCE_DIR}/common)
if(RF_SANITIZE)
  # gcc 12 reports the standard library's own members as uninitialised once it instruments them.
  # Null pointers, pointers that overflow and accesses beyond an object are what the address sanitizer finds at run time,
  # and what needs alignment faults without it: less code by half, and a third less time to compile what is left.
  target_compile_options(rf_options INTERFACE -fsanitize=${RF_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -fno-sanitize=null,object-size,pointer-overflow,alignment
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(rf_options INTERFACE -fsanitize=${RF_SANITIZE})
endif()

# Most of a compilation is the headers of Eigen, fmt and the standard library: parsed once for all targets, once more
# with GoogleTest for the tests. Only headers of packages belong here. Without it (RF_PRECOMPILE=OFF) every file must
# still include what it uses. Sources with code generation options of their own
# (COMPILE_OPTIONS) need SKIP_PRECOMPILE_HEADERS: the compiler refuses headers that were parsed with others.
option(RF_PRECOMPILE "Precompile the headers of packages" ON)
if(RF_PRECOMPILE)
  set(precompiled <algorithm> <array> <chrono> <cmath> <cstdint> <deque> <filesystem> <fstream> <functional> <map> <memory>
    <mutex> <numbers> <optional> <random> <span> <sstream> <stdexcept> <string> <thread> <utility> <vector>
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <fmt/format.h>)
  file(WRITE ${PROJECT_BINARY_DIR}/precompiled.cpp.new "// CMake needs a source file to precompile headers for.\n")
  file(COPY_FILE ${PROJECT_BINARY_DIR}/precompiled.cpp.new ${PROJECT_BINARY_DIR}/precompiled.cpp ONLY_IF_DIFFERENT)
  add_library(rf_precompiled_library OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(rf_precompiled_library PRIVATE rf_options fmt::fmt Eigen3::Eigen)
  target_precompile_headers(rf_precompiled_library PRIVATE ${precompiled})
  if(RF_BUILD_TESTS)
    add_library(rf_precompiled_test OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
    target_link_libraries(rf_precompiled_test PRIVATE rf_options fmt::fmt Eigen3::Eigen GTest::gtest)
    target_compile_definitions(rf_precompiled_test PRIVATE _GLIBCXX_ASSERTIONS)  # as in rf_test
    target_precompile_headers(rf_precompiled_test PRIVATE ${precompiled} <gtest/gtest.h>)
  endif()
endif()
# rf_precompiled(TARGET KIND): TARGET starts from the precompiled headers of KIND, library or test.
function(rf_precompiled target kind)
  if(RF_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM rf_precompiled_${kind})
    target_link_libraries(${target} PRIVATE fmt::fmt)  # its definitions must be those of the precompiled headers
  endif()
endfunction()

# rf_library(NAME SOURCES... LINK targets...): a room of common/, alias rf::NAME.
function(rf_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(ARG_SOURCES)
    add_library(rf_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(rf_${name} PUBLIC rf_options ${ARG_LINK})
    rf_precompiled(rf_${name} library)
  else()
    add_library(rf_${name} INTERFACE)
    target_link_libraries(rf_${name} INTERFACE rf_options ${ARG_LINK})
  endif()
  add_library(rf::${name} ALIAS rf_${name})
endfunction()

# rf_program(NAME SOURCES... LINK targets...): an executable in build/<preset>/bin.
if(NOT TARGET rf_programs)
  add_custom_target(rf_programs)  # builds every program, no tests
endif()
function(rf_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rf_options ${ARG_LINK})
  rf_precompiled(${name} library)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  add_dependencies(rf_programs ${name})
  install(TARGETS ${name} RUNTIME DESTINATION bin)
endfunction()

# rf_test(NAME SOURCES... LINK targets... [LABELS labels...]): a GoogleTest program, one CTest entry
# per program; LABELS default to "unit" (what the sanitizers run).
if(NOT TARGET rf_unit_tests)
  add_custom_target(rf_unit_tests)  # builds every test labelled "unit"
endif()
function(rf_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 900)  # only against tests that hang: a slow machine with sanitizers needs minutes
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rf_options ${ARG_LINK} GTest::gtest_main)
  rf_precompiled(${name} test)
  # gcc 12 sees Eigen's small vectors read out of bounds where they are not, with AVX inlined.
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
  # The sanitizers run unit tests only; this finds an index beyond its end in all others.
  target_compile_definitions(${name} PRIVATE _GLIBCXX_ASSERTIONS
    RF_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data" RF_BIN_DIR="${PROJECT_BINARY_DIR}/bin")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/test-bin)
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(rf_unit_tests ${name})
  endif()
endfunction()
