// SPDX-License-Identifier: GPL-3.0-or-later
// The one place where exceptions become statuses, and the checks that all entry points share.
#pragma once

#include "core/cancellation.h"
#include "core/error.h"
#include "specula/specula.h"

#include <initializer_list>
#include <new>

namespace spc::api {

void set_last_error(const std::string& message);
void set_last_error_without_memory() noexcept;

// Runs `body`, turns whatever it throws into a status and a message. What is not an Error is not
// for the user to mend: the message then names the function.
template <class Body>
spc_status gate(const char* function, Body&& body) noexcept {
    const auto fail = [](spc_status status, std::initializer_list<const char*> parts) {
        try {
            std::string message;
            for (const char* part : parts) message += part;
            set_last_error(message);
        } catch (...) {  // no memory for the message: that of an earlier call must not stay
            set_last_error_without_memory();
        }
        return status;
    };
    try {
        body();
        return SPC_OK;
    } catch (const Error& error) {
        switch (error.kind()) {
            case ErrorKind::invalid_argument: return fail(SPC_INVALID_ARGUMENT, {error.what()});
            case ErrorKind::wrong_state: return fail(SPC_WRONG_STATE, {error.what()});
            case ErrorKind::io: return fail(SPC_IO_ERROR, {error.what()});
            case ErrorKind::out_of_memory: return fail(SPC_OUT_OF_MEMORY, {error.what()});
        }
        return fail(SPC_INTERNAL_ERROR, {error.what()});
    } catch (const Cancelled&) {
        return fail(SPC_CANCELLED, {"building the scene was cancelled"});
    } catch (const std::bad_alloc&) {
        return fail(SPC_OUT_OF_MEMORY, {function, ": ", "out of memory"});
    } catch (const std::length_error&) {
        return fail(SPC_OUT_OF_MEMORY, {function, ": ", "out of memory"});
    } catch (const std::exception& error) {
        return fail(SPC_INTERNAL_ERROR, {function, ": ", error.what()});
    } catch (...) {
        return fail(SPC_INTERNAL_ERROR, {function, ": ", "unknown failure"});
    }
}

[[noreturn]] inline void invalid(const std::string& message) {
    throw Error(ErrorKind::invalid_argument, message);
}

inline void require(bool holds, const std::string& message) {
    if (!holds) invalid(message);
}

inline constexpr uint32_t kMostThreads = 1024;

template <class T>
const T& checked(const T* desc, const char* what) {
    require(desc != nullptr, std::string(what) + " is null");
    require(desc->struct_size == sizeof(T),
            std::string(what) + " has a struct_size of another version");
    return *desc;
}
template <class T>
T& checked_output(T* out, const char* what) {
    require(out != nullptr, std::string(what) + " is null");
    return *out;
}

// Names may be null: then the kind of thing stands for it.
inline std::string name_or(const char* name, const char* fallback) {
    return name != nullptr && name[0] != '\0' ? name : fallback;
}

template <class E>
E checked_enum(uint32_t value, uint32_t last, const std::string& owner, const char* what) {
    require(value <= last, owner + ": unknown " + what + " " + std::to_string(value));
    return static_cast<E>(value);
}

}  // namespace spc::api
