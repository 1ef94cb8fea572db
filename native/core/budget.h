// SPDX-License-Identifier: GPL-3.0-or-later
// How much a stage of a render's preparation may take: work, which is counted, so that a render
// does not depend on the machine, and time, if that is limited.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>

namespace spc {

class Budget {
public:
    using Clock = std::chrono::steady_clock;

    // A budget without an end.
    Budget() = default;
    // `work`: rays and Newton iterations; `seconds`: from now on; `cancelled`: outlives the budget.
    Budget(double work, double seconds, const std::atomic<bool>& cancelled)
        : work_(work), seconds_(seconds), cancelled_(&cancelled) {}

    // Whether the stage must end where it is. Any thread may ask at any moment; if so, it leaves
    // out the rest of what it does.
    bool must_end() const { return is_cancelled() || !(elapsed() < seconds_); }
    // Whether the render was cancelled. Then what the stage has made so far is not used; a stage
    // whose time is over keeps it.
    bool is_cancelled() const {
        return cancelled_ != nullptr && cancelled_->load(std::memory_order_relaxed);
    }
    // Whether a stage that has done so much `work` may do no more. Stages ask between rounds, which
    // do not depend on the number of threads, so that all machines stop at the same round.
    bool is_spent(uint64_t work) const {
        // A stage may begin anew and count from 0; the share that is shown must not fall.
        done_.store(std::max(done_.load(std::memory_order_relaxed), static_cast<double>(work)),
                    std::memory_order_relaxed);
        return must_end() || !(static_cast<double>(work) < work_);
    }
    double work() const { return work_; }
    // Share of the budget that is used, [0, 1], by the last work that is_spent() was told.
    double fraction() const {
        return std::clamp(
            std::max(done_.load(std::memory_order_relaxed) / work_, elapsed() / seconds_), 0.0, 1.0);
    }

private:
    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    const Clock::time_point start_ = Clock::now();
    const double work_ = std::numeric_limits<double>::infinity(),
                 seconds_ = std::numeric_limits<double>::infinity();
    const std::atomic<bool>* cancelled_ = nullptr;
    mutable std::atomic<double> done_{0.0};
};

}  // namespace spc
