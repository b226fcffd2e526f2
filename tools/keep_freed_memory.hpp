// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>  // defines __GLIBC__
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace thalweg::tools {

/// The arrays of a DEM come and go by the dozen. By default each is handed back to the system and asked for anew, page
/// by page, which took a fifth of the time of `analyze`; kept, the memory is used again. One arena, so that each thread
/// uses what any other gave back: no loop that matters allocates. For the start of a program.
inline void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

}  // namespace thalweg::tools
