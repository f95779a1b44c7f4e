// SPDX-License-Identifier: Apache-2.0
// See scripts/tsan/README.md.
#pragma once

namespace tbb::info {

inline int default_concurrency() { return 4; }  // also on a machine of one core: races need several

}  // namespace tbb::info
