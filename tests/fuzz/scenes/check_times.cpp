// SPDX-License-Identifier: GPL-3.0-or-later
// Renders reach their first sample, end, and stop when they are cancelled, all in time.
#include "scenes/build.h"
#include "scenes/watched_render.h"

#include <fmt/format.h>

namespace spc::fuzz {
namespace {

constexpr uint32_t kSide = 96;      // pixels
constexpr uint32_t kPoll = 2;       // ms
constexpr float kTimeLimit = 1.0f;  // s
// The first sample is promised after kFirstSample, s, and so many times as long as path tracing's
// takes.
constexpr double kFirstSample = 3.0, kFirstSampleOverPathTracing = 2.0;
// The end of the render is promised so long after the limit or the call, s.
constexpr double kAfterLimit = 1.0 + 0.05 * double(kTimeLimit);
constexpr double kAfterCancel = 0.3;

class Timing {
public:
    Timing(const Plan& plan, uint64_t seed, double patience, Tally& tally)
        : plan_(plan), dice_(seed), patience_(patience), tally_(tally), scene_(build(plan, kSide)) {}

    void run() {
        const double path_tracing = first_sample(kMethods[0]);
        const Method& method = any_method();
        hold(tally_.slowest_first_sample, first_sample(method),
             kFirstSample + kFirstSampleOverPathTracing * path_tracing,
             fmt::format("the first sample of {}", method.name));
        end_with_the_time(any_method());
        for (int i = 0; i < 2; ++i) cancel_somewhere(any_method());
    }

private:
    const Method& any_method() { return kMethods[1 + dice_.below(std::size(kMethods) - 1)]; }

    WatchedRender start(const Method& method, uint32_t samples, float time_limit) {
        spc_render_settings settings = settings_of(plan_, method, dice_.below(1000));
        settings.samples = samples;
        settings.time_limit = time_limit;
        ++tally_.renders;
        return {scene_.get(), settings, method.name};
    }

    void hold(double& longest, double seconds, double promised, const std::string& what,
              Check check = Check::times) {
        longest = std::max(longest, seconds);
        if (seconds > patience_ * promised)
            throw Broken{check, fmt::format("{} took {:.3f} s, promised are {:.3f} s", what,
                                            seconds, promised)};
    }

    double first_sample(const Method& method) {
        WatchedRender render = start(method, 1u << 20, 0.0f);
        const Stopwatch watch;
        spc_render_progress now;
        while (now = render.wait(kPoll), now.samples_done == 0 && watch.seconds() < 60.0) {}
        return watch.seconds();
    }

    void end_with_the_time(const Method& method) {
        WatchedRender render = start(method, 1u << 20, kTimeLimit);
        while (render.wait(kPoll).seconds < double(kTimeLimit)) {}
        const Stopwatch watch;
        while (render.wait(kPoll).state == SPC_RENDER_RUNNING && watch.seconds() < 60.0) {}
        hold(tally_.longest_after_limit, watch.seconds(), kAfterLimit,
             fmt::format("{} from the time limit to the end", method.name));
        render.check_stages();
    }

    void cancel_somewhere(const Method& method) {
        const uint32_t stage = dice_.below(SPC_STAGE_COUNT), later = dice_.below(100);
        WatchedRender render = start(method, 1u << 20, dice_.chance(0.3) ? 20.0f : 0.0f);
        spc_render_progress now;
        const Stopwatch before;
        while (now = render.wait(1), now.stage < stage && before.seconds() < 10.0) {}
        now = render.wait(later);
        render.cancel();
        const Stopwatch watch;
        while (render.wait(kPoll).state == SPC_RENDER_RUNNING && watch.seconds() < 60.0) {}
        hold(tally_.longest_after_cancel, watch.seconds(), kAfterCancel,
             fmt::format("the stop of {} in stage {}", method.name, now.stage), Check::cancelling);
        for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) render.read(pass, kSide);
    }

    const Plan& plan_;
    Dice dice_;
    double patience_;
    Tally& tally_;
    test::ScenePtr scene_;
};

}  // namespace

void check_times(const Plan& plan, uint64_t seed, double patience, Tally& tally) {
    Timing(plan, seed, patience, tally).run();
}

}  // namespace spc::fuzz
