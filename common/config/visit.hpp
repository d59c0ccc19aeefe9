// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A configuration struct describes itself by one member template:
///
///   struct FusionConfig {
///     double icp_distance_m = 0.10;
///     template <class V> void visit(V& v) {
///       v("icp_distance_m", icp_distance_m, 0.01, 1.0, "m", "largest distance of an ICP pair");
///     }
///   };
///
/// Fields may be bool, int, double, std::string (no range: v(name, field, unit, doc)) or another
/// such struct (v(name, struct, doc)). `config/yaml.hpp` reads, checks and writes any of them; the
/// default stands at the field and only there.
