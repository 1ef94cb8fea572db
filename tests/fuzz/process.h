// SPDX-License-Identifier: GPL-3.0-or-later
// Child processes that run scenes, and what they tell while they live.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>
#include <vector>

namespace spc::fuzz {

// This program in a process of its own, which dies with the one that starts it.
pid_t start_self(const std::vector<std::string>& arguments);

// That it has taken so far; 0 once it has ended.
double cpu_seconds_of(pid_t process);

// Memory under a file descriptor that children inherit.
int shared_file(size_t bytes);
void* shared_memory(int file, size_t bytes);
template <class T>
T& shared_in(int file) {
    return *static_cast<T*>(shared_memory(file, sizeof(T)));
}

}  // namespace spc::fuzz
