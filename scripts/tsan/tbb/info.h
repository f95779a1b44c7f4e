// SPDX-License-Identifier: Apache-2.0
// See scripts/tsan/README.md.
#pragma once

namespace tbb::info {

inline int default_concurrency() { return 4; }  // even on a machine with one core, because races need several threads

}  // namespace tbb::info
