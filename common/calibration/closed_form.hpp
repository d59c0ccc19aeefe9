// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/absolute_rows.hpp"
#include "calibration/relative_rows.hpp"

namespace rf::calibration {

/// T_AX that fits motions in the sense of least squares, without a start: the rotation from turning
/// axes and, where A hardly turns, directions of travel (Kabsch), then the translation from
///   (R_A - I) t = R t_X - t_A
/// with least norm. Directions that the motion does not show come out arbitrary; a start for the
/// estimate only. Motions of a second or so serve best.
SE3 closedFormTransform(const Path& path_A, const std::vector<MotionRow>& rows, double offset);

/// T_AX as the mean of T_CA^-1 T_CX.
SE3 meanTransform(const Path& path_A, const std::vector<PoseRow>& rows, double offset);

}  // namespace rf::calibration
