// SPDX-License-Identifier: GPL-3.0-or-later
// A render under watch: its progress runs one way, and its pictures hold numbers.
#pragma once

#include "scenes/checks.h"
#include "support/api_scene.h"

#include <optional>

namespace spc::fuzz {

struct Method {
    const char* name;
    uint32_t method, light_tracing;
    bool by_rays;  // finds all light of those lamps alone that rays run into
};
inline constexpr Method kMethods[] = {
    {"PT", SPC_METHOD_PT, SPC_LIGHT_TRACING_OFF, true},
    {"SHEETS", SPC_METHOD_SHEETS, SPC_LIGHT_TRACING_ON, false},
    {"AUTO", SPC_METHOD_AUTO, SPC_LIGHT_TRACING_ON, false},
    {"SMS_UNBIASED", SPC_METHOD_SMS_UNBIASED, SPC_LIGHT_TRACING_ON, false},
    {"LT", SPC_METHOD_LT, SPC_LIGHT_TRACING_ON, true},
    {"SHEETS without light paths", SPC_METHOD_SHEETS, SPC_LIGHT_TRACING_OFF, true},
    {"SMS_UNBIASED without light paths", SPC_METHOD_SMS_UNBIASED, SPC_LIGHT_TRACING_OFF, true},
    {"MNEE", SPC_METHOD_MNEE, SPC_LIGHT_TRACING_ON, true},
};

spc_render_settings settings_of(const Plan& plan, const Method& method, uint32_t seed);

// Time that has passed, or that this process has worked if that is less: another program's work is
// not the renderer's.
class Stopwatch {
public:
    double seconds() const {
        return std::min(now().passed - start_.passed, now().worked - start_.worked);
    }

private:
    struct Times {
        double passed, worked;  // s
    };
    static Times now();
    Times start_ = now();
};

class WatchedRender {
public:
    WatchedRender(const spc_scene* scene, const spc_render_settings& settings, std::string name);

    // What it has come to after so long at most.
    spc_render_progress wait(uint32_t milliseconds);
    void cancel();
    spc_render_stats stats() const;
    // Of `side` x `side` pixels, finite.
    std::vector<float> read(uint32_t pass, uint32_t side) const;
    // After its end.
    void check_stages() const;
    const std::string& name() const { return name_; }
    [[noreturn]] void broken(Check check, const std::string& what) const;

private:
    std::string name_;
    test::SessionPtr session_;
    spc_render_progress last_{};
    // Of the stage that it is in.
    Stopwatch stage_;
};

}  // namespace spc::fuzz
