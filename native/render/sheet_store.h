// SPDX-License-Identifier: GPL-3.0-or-later
// The light sheets that one session leaves to the next: they do not depend on the camera.
#pragma once

#include "manifold/sheet_pool.h"

#include <memory>
#include <mutex>

namespace spc {

// Sheets of one scene. Any thread may call it.
class SheetStore {
public:
    // What sheets depend on beside the scene.
    struct Key {
        uint32_t seed, emission_cells, longest_chain;
        std::vector<uint32_t> casters;  // their instances
        bool operator==(const Key&) const = default;
    };
    // Null if there are none.
    std::shared_ptr<const SheetPool> find(const Key& key) const {
        const std::lock_guard lock(mutex_);
        for (const auto& [kept, sheets] : kept_)
            if (kept == key) return sheets;
        return nullptr;
    }
    // Only whole pools, which another session would build alike.
    void put(Key key, std::shared_ptr<const SheetPool> sheets) {
        const std::lock_guard lock(mutex_);
        if (kept_.size() == kMost) kept_.erase(kept_.begin());
        kept_.emplace_back(std::move(key), std::move(sheets));
    }

private:
    // A session that leaves out casters builds sheets twice.
    static constexpr size_t kMost = 2;
    mutable std::mutex mutex_;
    std::vector<std::pair<Key, std::shared_ptr<const SheetPool>>> kept_;
};

}  // namespace spc
