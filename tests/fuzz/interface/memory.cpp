// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>

// The program's own code, as the linker places it.
extern "C" const char __executable_start, etext;

namespace spc::fuzz {
namespace {

constexpr int64_t kNever = std::numeric_limits<int64_t>::max();
std::atomic<int64_t> left{kNever};
thread_local bool outside = false;

bool must_fail(const void* caller) {
    if (left.load(std::memory_order_relaxed) == kNever || outside) return false;
    const auto* at = static_cast<const char*>(caller);
    return at >= &__executable_start && at < &etext && left.fetch_sub(1) == 0;
}

void* allocate(size_t size, size_t alignment, const void* caller) {
    if (must_fail(caller)) return nullptr;
    if (alignment <= alignof(std::max_align_t)) return std::malloc(size > 0 ? size : 1);
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocate_or_throw(size_t size, size_t alignment, const void* caller) {
    void* const memory = allocate(size, alignment, caller);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void fail_allocation_after(int64_t count) { left = count; }
void stop_failing() { left = kNever; }

InsideLibrary::InsideLibrary() { outside = false; }
InsideLibrary::~InsideLibrary() { outside = true; }
void begin_outside_library() { outside = true; }

}  // namespace spc::fuzz

// The sanitizers' own end the program where memory runs out.
#define SPC_CALLER __builtin_return_address(0)
using spc::fuzz::allocate;
using spc::fuzz::allocate_or_throw;
constexpr size_t kUsual = alignof(std::max_align_t);

void* operator new(size_t size) { return allocate_or_throw(size, kUsual, SPC_CALLER); }
void* operator new[](size_t size) { return allocate_or_throw(size, kUsual, SPC_CALLER); }
void* operator new(size_t size, std::align_val_t alignment) {
    return allocate_or_throw(size, static_cast<size_t>(alignment), SPC_CALLER);
}
void* operator new[](size_t size, std::align_val_t alignment) {
    return allocate_or_throw(size, static_cast<size_t>(alignment), SPC_CALLER);
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, kUsual, SPC_CALLER);
}
void* operator new[](size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, kUsual, SPC_CALLER);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
