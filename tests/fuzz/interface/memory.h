// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that runs out when it is asked to.
#pragma once

#include <cstdint>

namespace spc::fuzz {

// From now on one of the library's own allocations by `new` fails: the one after so many. What
// Embree and the standard library's binary allocate never does.
void fail_allocation_after(int64_t count);
void stop_failing();

// While it lives, the calling thread is inside the library. Threads that the library starts always
// are; the fuzzer's own call begin_outside_library() first.
class InsideLibrary {
public:
    InsideLibrary();
    ~InsideLibrary();
    InsideLibrary(const InsideLibrary&) = delete;
    InsideLibrary& operator=(const InsideLibrary&) = delete;
};
void begin_outside_library();

}  // namespace spc::fuzz
