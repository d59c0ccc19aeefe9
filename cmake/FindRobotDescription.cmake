# SPDX-License-Identifier: BSD-3-Clause
# Finds what reads a URDF and computes chains: urdfdom, kdl_parser and orocos-kdl, with the console_bridge through
# which urdfdom speaks. Gives the target RobotDescription::RobotDescription.
#
# kdl_parser's own package file asks for the development files of ROS, which it does not need to be linked.

find_path(RobotDescription_URDF_INCLUDE_DIR urdf_parser/urdf_parser.h)
find_path(RobotDescription_KDL_INCLUDE_DIR kdl/tree.hpp)
find_path(RobotDescription_PARSER_INCLUDE_DIR kdl_parser/kdl_parser.hpp)
find_library(RobotDescription_URDF_LIBRARY urdfdom_model)
find_library(RobotDescription_KDL_LIBRARY orocos-kdl)
find_library(RobotDescription_PARSER_LIBRARY kdl_parser)
find_library(RobotDescription_CONSOLE_LIBRARY console_bridge)

set(RobotDescription_PARTS URDF_LIBRARY URDF_INCLUDE_DIR KDL_LIBRARY KDL_INCLUDE_DIR PARSER_LIBRARY PARSER_INCLUDE_DIR
  CONSOLE_LIBRARY)
list(TRANSFORM RobotDescription_PARTS PREPEND RobotDescription_)
mark_as_advanced(${RobotDescription_PARTS})

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RobotDescription
  REQUIRED_VARS ${RobotDescription_PARTS}
  REASON_FAILURE_MESSAGE "on Debian: apt-get install liburdfdom-dev libkdl-parser-dev liborocos-kdl-dev")

if(RobotDescription_FOUND AND NOT TARGET RobotDescription::RobotDescription)
  add_library(RobotDescription::RobotDescription INTERFACE IMPORTED)
  set_target_properties(RobotDescription::RobotDescription PROPERTIES
    INTERFACE_LINK_LIBRARIES
      "${RobotDescription_PARSER_LIBRARY};${RobotDescription_KDL_LIBRARY};${RobotDescription_URDF_LIBRARY};${RobotDescription_CONSOLE_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES
      "${RobotDescription_URDF_INCLUDE_DIR};${RobotDescription_KDL_INCLUDE_DIR};${RobotDescription_PARSER_INCLUDE_DIR}")
endif()
