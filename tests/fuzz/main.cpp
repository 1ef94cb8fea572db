// SPDX-License-Identifier: GPL-3.0-or-later
// Runs mutated scenes in a child process, and tells which ones end it, hang or break a promise.
//   specula_fuzz [--seed N] [--count N | --cpu-seconds N | --minutes N]
#include "scene.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
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

constexpr double kHangCpuSeconds = 5.0;  // of one scene
constexpr double kHangSeconds = 60.0;    // waiting for nothing; the machine may be busy with more
constexpr uint64_t kScenesOfAChild = 500;
constexpr size_t kMostFailures = 50;

struct Shared {  // between the process that watches and its child
    std::atomic<uint64_t> seed;
    Tally tally;
};

Shared* shared_in(int file) {
    void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) std::abort();
    return static_cast<Shared*>(memory);
}

// The child's part; its end looks for leaks.
constexpr const char* kChild = "--child";
int run_scenes(int file, uint64_t begin, uint64_t end) {
    Shared& shared = *shared_in(file);
    for (uint64_t seed = begin; seed < end; ++seed) {
        shared.seed = seed;
        run_scene(seed, shared.tally);
    }
    shared.seed = end;
    return 0;
}

double cpu_seconds_of(pid_t process) {
    clockid_t clock;
    timespec time{};
    if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Task {
    uint64_t seed = 1, count = 100;
    double cpu_seconds = 0.0, seconds = 0.0;  // if not 0, instead of a count
};

[[noreturn]] void usage() {
    std::fprintf(stderr,
                 "usage: specula_fuzz [--seed N] [--count N | --cpu-seconds N | --minutes N]\n");
    std::exit(2);
}

Task parse(int count, char** arguments) {
    Task task;
    for (int i = 1; i < count; i += 2) {
        const std::string name = arguments[i];
        if (i + 1 == count) usage();
        const char* value = arguments[i + 1];
        if (name == "--seed")
            task.seed = std::strtoull(value, nullptr, 10);
        else if (name == "--count")
            task.count = std::strtoull(value, nullptr, 10);
        else if (name == "--cpu-seconds")
            task.cpu_seconds = std::strtod(value, nullptr);
        else if (name == "--minutes")
            task.seconds = 60.0 * std::strtod(value, nullptr);
        else
            usage();
    }
    if (task.cpu_seconds > 0.0 || task.seconds > 0.0) task.count = ~uint64_t{0} - task.seed;
    return task;
}

class Watch {
public:
    explicit Watch(const Task& task) : task_(task) {
        file_ = memfd_create("specula_fuzz", 0);
        if (file_ < 0 || ftruncate(file_, sizeof(Shared)) != 0) std::abort();
        shared_ = shared_in(file_);
    }

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
        const pid_t child = fork();
        if (child < 0) std::abort();
        if (child == 0) {
            prctl(PR_SET_PDEATHSIG, SIGKILL);  // it must not outlive who watches it
            // Anew: what libraries have started in this process is not in a mere fork of it.
            execl("/proc/self/exe", "specula_fuzz", kChild, std::to_string(file_).c_str(),
                  std::to_string(begin).c_str(), std::to_string(end).c_str(), nullptr);
            std::abort();
        }
        return watch(child, end);
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
    int file_ = -1;
    Shared* shared_ = nullptr;
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
    return spc::fuzz::Watch(spc::fuzz::parse(count, arguments)).run();
}
