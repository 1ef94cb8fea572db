// SPDX-License-Identifier: GPL-3.0-or-later
// A loop whose rounds run side by side.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace spc {

// Calls act(i) for each i below `count`, in no order, on so many threads, the caller's among them;
// 0: one for each processor. Throws what the first round that fails throws, after all threads have
// ended.
template <class Act>
void parallel_for(uint32_t threads, uint32_t count, const Act& act) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    std::atomic<uint32_t> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (uint32_t i = 0; (i = next.fetch_add(1)) < count;) act(i);
        } catch (...) {
            next = count;
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;
        for (uint32_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(work);
        work();
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace spc
