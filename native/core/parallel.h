// SPDX-License-Identifier: GPL-3.0-or-later
// A loop whose rounds run side by side, and what must be done in order nevertheless.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
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

// Calls functions one at a time in the order of their numbers, from 0 on. Nobody waits: who comes
// early leaves its own to whoever has the one before.
class InOrder {
public:
    void call(uint64_t number, std::function<void()> function) {
        const std::lock_guard lock(mutex_);
        early_.emplace(number, std::move(function));
        for (auto next = early_.begin(); next != early_.end() && next->first == called_;
             next = early_.erase(next), ++called_)
            next->second();
    }

private:
    std::mutex mutex_;
    std::map<uint64_t, std::function<void()>> early_;
    uint64_t called_ = 0;
};

}  // namespace spc
