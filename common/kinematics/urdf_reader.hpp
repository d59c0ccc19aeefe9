// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

namespace rf {

/// Parses the XML of a URDF with urdfdom and checks what urdfdom lets pass, so that a chain can be
/// built from what is returned: one tree that reaches every link, axes that are not zero, numbers
/// that are finite, mimic joints that end at a movable joint. Prints nothing: what urdfdom has to
/// say becomes part of the error. Throws KinematicsError. Thread-safe.
urdf::ModelInterfaceSharedPtr readUrdf(const std::string& xml, const std::string& source);

}  // namespace rf
