# SPDX-License-Identifier: BSD-3-Clause
"""rf-experiments: tables and figures over simulated scenes, seeds, priors and modes."""
