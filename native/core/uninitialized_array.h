// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays on the stack in places that are too hot to fill them with zeros first.
#pragma once

#include <cstddef>
#include <type_traits>

namespace spc {

// Place for values without their initialisation, which costs more than the few that are used: each
// is written before it is read.
template <class T, size_t kSize>
class UninitializedArray {
public:
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    T* data() { return reinterpret_cast<T*>(storage_); }
    T& operator[](size_t i) { return data()[i]; }

private:
    alignas(T) std::byte storage_[sizeof(T) * kSize];
};

}  // namespace spc
