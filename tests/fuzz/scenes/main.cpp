// SPDX-License-Identifier: GPL-3.0-or-later
// Runs random scenes, each in a child process, and tells which ones end it, hang or break what the
// renderer promises, with the smallest part of the scene that still does.
//   specula_scenes [--seed N] [--count N | --cpu-seconds N | --minutes N] [--quiet 1] [--shrink 0]
//   specula_scenes --seed N --count 1 --without PART,PART --check NAME   (as it prints)
//   specula_scenes --suite 1                                              (of the tests)
//   specula_scenes --with-bias 1 ...    (which finds that MNEE_BIASED is not PT, as often as
//   samples tell)
#include "process.h"
#include "scenes/checks.h"
#include "support/power.h"
#include "task.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

namespace spc::fuzz {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kHangCpuSeconds = 1200.0, kHangSeconds = 3600.0;  // of one scene
constexpr size_t kMostFailures = 20;
constexpr uint64_t kScenesTimed = 3;  // one in so many
constexpr const char* kChild = "--child";

// What of a scene is run.
struct Extent {
    std::vector<std::string> without;  // parts
    std::string check;                 // alone; empty: all
    double patience = kBusy;
    bool shrinks = true;
    bool with_bias = false;  // compares a method that has some
};

Plan plan_of(uint64_t seed, const Extent& extent) {
    Plan plan = random_plan(seed);
    for (const std::string& part : extent.without) leave_out(plan, part);
    return plan;
}

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}
std::string join(const std::vector<std::string>& parts) {
    std::string list;
    for (const std::string& part : parts) list += (list.empty() ? "" : ",") + part;
    return list;
}

// The child's part.
int run_scene(int file, uint64_t seed, const Extent& extent) {
    auto& tally = shared_in<Tally>(file);
    const Plan plan = plan_of(seed, extent);
    const auto asked_for = [&](std::initializer_list<Check> checks) {
        return extent.check.empty() || std::any_of(checks.begin(), checks.end(), [&](Check check) {
                   return extent.check == name_of(check);
               });
    };
    try {
        if (asked_for({Check::weights})) check_weights(plan, seed, tally);
        if (asked_for({Check::times, Check::cancelling, Check::progress, Check::numbers}) &&
            (seed % kScenesTimed == 0 || !extent.check.empty()))
            check_times(plan, seed, extent.patience, tally);
        if (asked_for({Check::means, Check::progress, Check::numbers}))
            check_means(plan, seed, extent.with_bias, tally);
    } catch (const Broken& broken) {
        std::fprintf(stderr, "FUZZ: seed %llu, %s: %s\n", static_cast<unsigned long long>(seed),
                     name_of(broken.check), broken.what.c_str());
        return static_cast<int>(broken.check);
    }
    ++tally.scenes;
    return 0;
}

class Watch {
public:
    Watch(const Task& task, const Extent& extent) : task_(task), extent_(extent) {}

    int run() {
        for (uint64_t seed = task_.seed;
             seed < task_.seed + task_.count && !time_is_up() && failures_.size() < kMostFailures;
             ++seed)
            if (const std::string failure = fails(seed, extent_); !failure.empty())
                failures_.push_back(smallest(seed, failure));
        report();
        return failures_.empty() ? 0 : 1;
    }

private:
    bool time_is_up() const {
        if (task_.cpu_seconds > 0.0) return cpu_ >= task_.cpu_seconds;
        const std::chrono::duration<double> passed = Clock::now() - start_;
        return task_.seconds > 0.0 && passed.count() >= task_.seconds;
    }

    // In which way; empty if it does not.
    std::string fails(uint64_t seed, const Extent& extent) {
        const pid_t child = start_self(
            {kChild, std::to_string(file_), std::to_string(seed), join(extent.without),
             extent.check, std::to_string(extent.patience), extent.with_bias ? "1" : "0"});
        const Clock::time_point begun = Clock::now();
        int status = 0;
        rusage usage{};
        bool hangs = false;
        while (wait4(child, &status, WNOHANG, &usage) != child) {
            const std::chrono::duration<double> passed = Clock::now() - begun;
            if (!hangs &&
                (cpu_seconds_of(child) > kHangCpuSeconds || passed.count() > kHangSeconds)) {
                hangs = true;
                kill(child, SIGABRT);
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        for (const timeval& time : {usage.ru_utime, usage.ru_stime})
            cpu_ += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
        if (hangs) return "hangs";
        if (WIFSIGNALED(status)) return strsignal(WTERMSIG(status));
        for (const Check check : kChecks)
            if (WEXITSTATUS(status) == static_cast<int>(check)) return name_of(check);
        return WEXITSTATUS(status) == 0 ? "" : "ends the program";
    }

    // Leaves out one part after the other while it fails in the same way.
    std::string smallest(uint64_t seed, const std::string& failure) {
        Extent extent = extent_;
        for (const Check check : kChecks)
            if (failure == name_of(check)) extent.check = failure;
        for (bool smaller = extent.shrinks; smaller;) {
            smaller = false;
            for (const Part& part : parts_of(plan_of(seed, extent))) {
                Extent less = extent;
                less.without.push_back(part.name);
                if (fails(seed, less) != failure) continue;
                extent = less;
                smaller = true;
                break;
            }
        }
        std::string command = "--seed " + std::to_string(seed) + " --count 1";
        if (!extent.without.empty()) command += " --without " + join(extent.without);
        if (!extent.check.empty()) command += " --check " + extent.check;
        std::fprintf(stderr, "FUZZ: seed %llu: %s; alone: %s\n%s\n",
                     static_cast<unsigned long long>(seed), failure.c_str(), command.c_str(),
                     plan_of(seed, extent).text().c_str());
        return command + "   # " + failure;
    }

    void report() const {
        const auto& t = shared_in<Tally>(file_);
        const auto number = [](uint64_t n) { return static_cast<unsigned long long>(n); };
        std::printf(
            "%llu scenes in %.0f s of CPU: weights of %llu paths, off by %.1e at most; %llu "
            "pairs of methods, which %.2f %% of the light would tell apart, %llu of them differed "
            "by "
            "chance, %llu undecided; %llu renders "
            "timed: first sample after %.2f s, end %.2f s after the limit, %.3f s after a "
            "cancel, at most\n",
            number(t.scenes), cpu_, number(t.paths), t.worst_sum, number(t.pairs),
            100.0 * std::exp(t.log_noticed / double(std::max<uint64_t>(t.pairs, 1))),
            number(t.doubted), number(t.undecided), number(t.renders), t.slowest_first_sample,
            t.longest_after_limit, t.longest_after_cancel);
        for (const std::string& failure : failures_) std::printf("failed: %s\n", failure.c_str());
    }

    const Task task_;
    const Extent extent_;
    const int file_ = shared_file(sizeof(Tally));
    const Clock::time_point start_ = Clock::now();
    double cpu_ = 0.0;  // of children
    std::vector<std::string> failures_;
};

}  // namespace
}  // namespace spc::fuzz

int main(int count, char** arguments) {
    using namespace spc::fuzz;
    if (count == 8 && std::strcmp(arguments[1], kChild) == 0)
        return run_scene(std::atoi(arguments[2]), std::strtoull(arguments[3], nullptr, 10),
                         {.without = split(arguments[4]),
                          .check = arguments[5],
                          .patience = std::atof(arguments[6]),
                          .with_bias = arguments[7][0] == '1'});
    Extent extent;
    bool suite = false;
    Task task = parse(count, arguments, [&](const std::string& name, const char* value) {
        if (name == "--without")
            extent.without = split(value);
        else if (name == "--check")
            extent.check = value;
        else if (name == "--quiet")
            extent.patience = kQuiet;
        else if (name == "--shrink")
            extent.shrinks = value[0] != '0';
        else if (name == "--with-bias")
            extent.with_bias = true;
        else if (name == "--suite")
            suite = true;
        else
            return false;
        return true;
    });
    if (suite) {
        task.count = ~uint64_t{0} - task.seed;
        task.cpu_seconds = spc::test::power(60.0, 3600.0);
        extent.patience = spc::test::power(kBusy, kQuiet);
    }
    return Watch(task, extent).run();
}
