// SPDX-License-Identifier: GPL-3.0-or-later
// The two kinds of failure that are not numerical: bad input throws Error, our own bugs trip
// SPC_ASSERT.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>

namespace spc {

enum class ErrorKind { invalid_argument, wrong_state, io, out_of_memory };

// How messages name an object: `mesh "Cube"`, or its kind alone where it has no name of its own.
inline std::string named(const std::string& kind, const std::string& name) {
    return name.empty() || name == kind ? kind : kind + " \"" + name + "\"";
}

// Bad input. The message is for the user: it names the object, and no function.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const { return kind_; }

private:
    ErrorKind kind_;
};

// Runs `act`; where memory runs out, the error says for what.
template <class Act>
decltype(auto) with_memory_for(const std::string& what, Act&& act) {
    const auto fail = [&]() { throw Error(ErrorKind::out_of_memory, what + ": out of memory"); };
    try {
        return act();
    } catch (const std::bad_alloc&) {
        fail();
        throw;
    } catch (const std::length_error&) {  // of a vector longer than any can be
        fail();
        throw;
    }
}

}  // namespace spc

// Checked in the dev and asan builds only; states what must hold if Specula itself is right.
#ifdef SPC_ENABLE_ASSERTS
#define SPC_ASSERT(condition)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                          \
        }                                                                                          \
    } while (false)
#else
#define SPC_ASSERT(condition) static_cast<void>(0)
#endif
