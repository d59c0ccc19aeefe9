# SPDX-License-Identifier: BSD-3-Clause
# Finds LCM with or without a package file: Debian 12's liblcm-dev has no CMake package, and its
# pkg-config file asks for glib headers that the package does not depend on.
#
# Gives the target lcm::lcm, LCM_GEN_EXECUTABLE (lcm-gen) and, where it exists, LCM_JAR (lcm.jar).

find_package(lcm CONFIG QUIET)
find_program(LCM_GEN_EXECUTABLE lcm-gen DOC "LCM's message compiler")
find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java DOC "LCM for Java (optional)")
if(NOT TARGET lcm::lcm AND TARGET lcm)
  add_library(lcm::lcm ALIAS lcm)
endif()
if(TARGET lcm::lcm)
  set(LCM_LIBRARY lcm::lcm)
else()
  find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp DOC "Folder that holds lcm/lcm-cpp.hpp")
  find_library(LCM_LIBRARY lcm DOC "liblcm")
  mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(lcm
  REQUIRED_VARS LCM_LIBRARY LCM_GEN_EXECUTABLE
  REASON_FAILURE_MESSAGE "on Debian: apt-get install liblcm-dev liblcm-bin")

if(lcm_FOUND AND NOT TARGET lcm::lcm)
  add_library(lcm::lcm UNKNOWN IMPORTED)
  set_target_properties(lcm::lcm PROPERTIES
    IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
