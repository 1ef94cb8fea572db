// SPDX-License-Identifier: GPL-3.0-or-later
#include "process.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <ctime>

namespace spc::fuzz {

pid_t start_self(const std::vector<std::string>& arguments) {
    std::vector<char*> words;
    std::string name = "fuzz";
    words.push_back(name.data());
    std::vector<std::string> copies = arguments;
    for (std::string& copy : copies) words.push_back(copy.data());
    words.push_back(nullptr);
    const pid_t child = fork();
    if (child < 0) std::abort();
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        // Anew: what libraries have started in this process is not in a mere fork of it.
        execv("/proc/self/exe", words.data());
        std::abort();
    }
    return child;
}

double cpu_seconds_of(pid_t process) {
    clockid_t clock;
    timespec time{};
    if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

int shared_file(size_t bytes) {
    const int file = memfd_create("fuzz", 0);
    if (file < 0 || ftruncate(file, static_cast<off_t>(bytes)) != 0) std::abort();
    return file;
}

void* shared_memory(int file, size_t bytes) {
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) std::abort();
    return memory;
}

}  // namespace spc::fuzz
