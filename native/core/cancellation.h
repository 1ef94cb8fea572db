// SPDX-License-Identifier: GPL-3.0-or-later
// How a thread that builds a scene learns that nobody wants it any more.
#pragma once

#include <atomic>

namespace spc {

// Thrown where that is noticed.
struct Cancelled {};

// While it lives, what its thread builds may be cancelled by any other one. The steps of building
// ask for it themselves, so that those between need not pass it on.
class Cancellable {
public:
    explicit Cancellable(const std::atomic<bool>& cancelled) { current() = &cancelled; }
    ~Cancellable() { current() = nullptr; }
    Cancellable(const Cancellable&) = delete;
    Cancellable& operator=(const Cancellable&) = delete;

    // The calling thread's wish, for what runs on others; null: it cannot be cancelled.
    static const std::atomic<bool>* wish() { return current(); }
    // Throws Cancelled if the calling thread's work is no longer wanted.
    static void check() {
        if (wish() != nullptr && wish()->load(std::memory_order_relaxed)) throw Cancelled();
    }

private:
    static const std::atomic<bool>*& current() {
        thread_local const std::atomic<bool>* wish = nullptr;
        return wish;
    }
};

}  // namespace spc
