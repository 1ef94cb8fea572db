// SPDX-License-Identifier: GPL-3.0-or-later
// Renders of a committed scene, and what every call is held against.
#pragma once

#include "dice.h"
#include "memory.h"
#include "scene.h"
#include "specula/specula.h"

#include <mutex>
#include <string>

namespace spc::fuzz {

class Promises {
public:
    explicit Promises(Tally& tally) : tally_(tally) {}

    bool starved = false;  // memory may run out

    [[noreturn]] void broken(const std::string& what);

    // Whether the call did what it was asked to. A refusal names `name`, or what is missing.
    template <class Call>
    bool took(const Call& call, const char* name) {
        const spc_status status = [&] {
            InsideLibrary inside;
            return call();
        }();
        return judge(status, name);
    }

    template <class Count>
    void count(const Count& change) {
        const std::lock_guard lock(mutex_);
        change(tally_);
    }

private:
    bool judge(spc_status status, const char* name);

    Tally& tally_;
    std::mutex mutex_;
};

struct Film {
    uint32_t width, height;
};
void render(const spc_scene* scene, const Film& film, Dice dice, Promises& promises);

}  // namespace spc::fuzz
