// SPDX-License-Identifier: GPL-3.0-or-later
// Runs mutated scenes in a child process, and tells which ones end it, hang or break a promise.
//   specula_fuzz [--seed N] [--count N | --cpu-seconds N | --minutes N]
#include "process.h"
#include "scene.h"
#include "task.h"

#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

// Memory that cannot be had is a refusal, and no bug.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
    return "allocator_may_return_null=1:max_allocation_size_mb=1024:handle_abort=1";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }

namespace spc::fuzz {
namespace {

using Clock = std::chrono::steady_clock;

// Processor time of one scene. A world of many octaves of noise is looked at in half a million
// directions, which takes some seconds with sanitizers.
constexpr double kHangCpuSeconds = 30.0;
constexpr double kHangSeconds = 120.0;  // waiting for nothing; the machine may be busy with more
constexpr uint64_t kScenesOfAChild = 500;
constexpr size_t kMostFailures = 50;

struct Shared {  // between the process that watches and its child
    std::atomic<uint64_t> seed;
    Tally tally;
};

// The child's part; its end looks for leaks.
constexpr const char* kChild = "--child";
int run_scenes(int file, uint64_t begin, uint64_t end) {
    Shared& shared = shared_in<Shared>(file);
    for (uint64_t seed = begin; seed < end; ++seed) {
        shared.seed = seed;
        run_scene(seed, shared.tally);
    }
    shared.seed = end;
    return 0;
}

class Watch {
public:
    explicit Watch(const Task& task) : task_(task) {}

    int run() {
        const uint64_t end = task_.seed + task_.count;
        uint64_t next = task_.seed;
        while (next < end && !time_is_up(0.0) && failures_.size() < kMostFailures)
            next = run_child(next, std::min(end, next + kScenesOfAChild));
        report();
        return failures_.empty() ? 0 : 1;
    }

private:
    bool time_is_up(double cpu_of_child) const {
        if (task_.cpu_seconds > 0.0) return cpu_ + cpu_of_child >= task_.cpu_seconds;
        const std::chrono::duration<double> passed = Clock::now() - start_;
        return task_.seconds > 0.0 && passed.count() >= task_.seconds;
    }

    // Returns the seed to go on with.
    uint64_t run_child(uint64_t begin, uint64_t end) {
        shared_->seed = begin;
        return watch(
            start_self({kChild, std::to_string(file_), std::to_string(begin), std::to_string(end)}),
            end);
    }

    uint64_t watch(pid_t child, uint64_t end) {
        uint64_t seed = ~uint64_t{0};
        double cpu_before = 0.0;
        Clock::time_point begun;
        const char* why = nullptr;
        for (;;) {
            int status = 0;
            const double cpu = cpu_seconds_of(child);
            if (waitpid(child, &status, WNOHANG) == child) {
                cpu_ += cpu_last_;
                return judge(status, end, why);
            }
            cpu_last_ = cpu;
            if (const uint64_t now = shared_->seed; now != seed) {
                seed = now;
                cpu_before = cpu;
                begun = Clock::now();
            }
            const std::chrono::duration<double> passed = Clock::now() - begun;
            if (why == nullptr &&
                (cpu - cpu_before > kHangCpuSeconds || passed.count() > kHangSeconds)) {
                why = "hangs";
                kill(child, SIGABRT);
            } else if (why == nullptr && time_is_up(cpu)) {
                why = "time is up";
                kill(child, SIGKILL);
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }

    uint64_t judge(int status, uint64_t end, const char* why) {
        const uint64_t seed = shared_->seed;
        if ((WIFEXITED(status) && WEXITSTATUS(status) == 0) ||
            (why != nullptr && std::strcmp(why, "time is up") == 0))
            return seed;
        if (seed == end) {
            std::fprintf(stderr, "FUZZ: leaks before seed %llu\n",
                         static_cast<unsigned long long>(end));
            failures_.push_back(end);
            return end;
        }
        std::fprintf(stderr, "FUZZ: seed %llu %s; alone: --seed %llu --count 1\n",
                     static_cast<unsigned long long>(seed),
                     why != nullptr ? why : "ends the program",
                     static_cast<unsigned long long>(seed));
        failures_.push_back(seed);
        return seed + 1;
    }

    void report() const {
        const Tally& t = shared_->tally;
        const auto number = [](uint64_t n) { return static_cast<unsigned long long>(n); };
        std::printf(
            "%llu scenes in %.0f s of CPU: %llu calls, %llu of them refused, %llu out of "
            "memory; %llu pictures, %llu renders cancelled; %llu pictures with dropped "
            "samples, %llu with rays that could not be cast\n",
            number(t.scenes), cpu_, number(t.calls), number(t.refusals), number(t.out_of_memory),
            number(t.pictures), number(t.cancelled), number(t.bad_samples), number(t.bad_rays));
        for (const uint64_t seed : failures_) std::printf("failed: --seed %llu\n", number(seed));
    }

    Task task_;
    const int file_ = shared_file(sizeof(Shared));
    Shared* const shared_ = &shared_in<Shared>(file_);
    Clock::time_point start_ = Clock::now();
    double cpu_ = 0.0, cpu_last_ = 0.0;  // of children
    std::vector<uint64_t> failures_;
};

}  // namespace
}  // namespace spc::fuzz

int main(int count, char** arguments) {
    const auto number = [&](int i) { return std::strtoull(arguments[i], nullptr, 10); };
    if (count == 5 && std::strcmp(arguments[1], spc::fuzz::kChild) == 0)
        return spc::fuzz::run_scenes(static_cast<int>(number(2)), number(3), number(4));
    const auto no_more = [](const std::string&, const char*) { return false; };
    return spc::fuzz::Watch(spc::fuzz::parse(count, arguments, no_more)).run();
}
