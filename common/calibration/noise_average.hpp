// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/noise_components.hpp"

namespace rf::calibration {

/// One form that the noise of the same data may have, with the rows as that form combines them.
/// Forms are compared by likelihood: the combinations must have determinant one.
struct NoiseForm {
  Eigen::VectorXd r;                       ///< residuals (6 * rows)
  Eigen::MatrixXd J;                       ///< derivatives by p parameters, of full column rank
  std::vector<NoiseComponent> components;  ///< variances at the likelihood's maximum
};

/// Posterior of p parameters whose noise is not known but estimated from the same rows.
struct NoiseAverage {
  Eigen::VectorXd change;       ///< mean of the parameters less those that r and J are of
  Eigen::MatrixXd covariance;   ///< all of it
  Eigen::MatrixXd by_noise;     ///< the part by which the mean changes with the noise
  std::vector<double> weights;  ///< of the forms, sum 1
};

/// Integrates the linearised parameters over all forms, equally likely beforehand, and over the
/// standard deviations of their causes, each with a flat prior (Gelman: Prior distributions for
/// variance parameters in hierarchical models, 2006): importance sampling of the restricted
/// likelihood from a Student t about each form's maximum, its spread by the average information
/// (Gilmour, Thompson, Cullis: Average information REML, 1995). Where the noise is well known this
/// is the usual inverse information; where it is not, wider, as Student's t is wider than a normal.
/// The sequence of samples is fixed: deterministic. No form may be empty.
NoiseAverage averageOverNoise(const std::vector<NoiseForm>& forms);

}  // namespace rf::calibration
