// SPDX-License-Identifier: GPL-3.0-or-later
// What the snapshots of a scene have in common.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace spc {

// An immutable value with several owners, which reads like a reference to it. Never null.
template <class T>
class Shared {
public:
    Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}

    operator const T&() const { return *value_; }
    const T& operator*() const { return *value_; }
    const T* operator->() const { return value_.get(); }
    const T* get() const { return value_.get(); }  // tells one value from another

private:
    std::shared_ptr<const T> value_;
};

// An array whose copies share its values. It is written before there are copies.
template <class T>
class SharedArray {
public:
    SharedArray() = default;
    explicit SharedArray(std::vector<T> values)
        : values_(std::make_shared<std::vector<T>>(std::move(values))) {}

    std::vector<T>& writable() {
        if (!values_) values_ = std::make_shared<std::vector<T>>();
        return *values_;
    }
    const T* data() const { return values_ ? values_->data() : nullptr; }
    size_t size() const { return values_ ? values_->size() : 0; }
    bool empty() const { return size() == 0; }
    const T& operator[](size_t i) const { return (*values_)[i]; }
    const T* begin() const { return data(); }
    const T* end() const { return data() + size(); }

private:
    std::shared_ptr<std::vector<T>> values_;
};

}  // namespace spc
