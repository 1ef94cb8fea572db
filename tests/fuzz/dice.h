// SPDX-License-Identifier: GPL-3.0-or-later
// Random choices of one seed, and the numbers that break things.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

namespace spc::fuzz {

class Dice {
public:
    explicit Dice(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}

    // SplitMix64 [Steele14].
    uint64_t bits() {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    uint32_t below(uint64_t count) { return static_cast<uint32_t>(bits() % count); }
    uint32_t from(uint32_t least, uint32_t most) { return least + below(most - least + 1); }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    bool chance(double p) { return unit() < p; }
    float between(float a, float b) { return a + (b - a) * static_cast<float>(unit()); }
    template <class T>
    T one_of(std::initializer_list<T> of) {
        return of.begin()[below(of.size())];
    }
    template <class T>
    const T& one_of(const std::vector<T>& of) {
        return of[below(of.size())];
    }

private:
    uint64_t state_;
};

// Spoils the fields of descriptors, each with the same small chance.
class Spoiler {
public:
    Spoiler(Dice& dice, double chance, bool finite)
        : dice_(dice), chance_(chance), finite_(finite) {}

    bool strikes() { return dice_.chance(chance_); }
    float number(float good) { return strikes() ? odd_number(good) : good; }
    uint32_t count(uint32_t good) { return strikes() ? odd_count(good) : good; }
    void numbers(float* values, size_t size) {
        for (size_t i = 0; i < size; ++i) values[i] = number(values[i]);
    }
    void numbers(std::vector<float>& values) { numbers(values.data(), values.size()); }
    template <class T>
    const T* pointer(const T* good) {
        return !finite_ && strikes() ? nullptr : good;
    }
    size_t struct_size(size_t good) {
        return !finite_ && strikes() ? dice_.one_of({size_t{0}, good - 4, good + 8, ~good}) : good;
    }

private:
    float odd_number(float good) {
        using Limits = std::numeric_limits<float>;
        const float sign = dice_.chance(0.3) ? -1.0f : 1.0f;
        switch (dice_.below(finite_ ? 6 : 8)) {
            case 0: return 0.0f * sign;
            case 1:  // any magnitude
                return sign * std::ldexp(1.0f + static_cast<float>(dice_.unit()),
                                         static_cast<int>(dice_.below(276)) - 149);
            case 2: return good * std::ldexp(1.0f, static_cast<int>(dice_.below(80)) - 40);
            case 3: return std::nextafter(good, dice_.one_of({-1e30f, 1e30f}));
            case 4:
                return sign * dice_.one_of({Limits::denorm_min(), Limits::min(), 1e-20f, 1e-12f,
                                            1e-7f, 0.5f, 1.0f, 1e4f, 1e8f, 1e9f, 1e10f, 1e19f,
                                            1e20f, Limits::max()});
            case 5: return good * -1.0f;
            case 6:
                return dice_.one_of({Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()});
            default: return std::bit_cast<float>(static_cast<uint32_t>(dice_.bits()));
        }
    }
    uint32_t odd_count(uint32_t good) {
        switch (dice_.below(4)) {
            case 0: return dice_.one_of({0u, 1u, 2u, 31u, 1024u, 65536u, 0x7fffffffu, 0xffffffffu});
            case 1: return good + dice_.one_of({1u, ~0u});
            case 2: return dice_.below(8);
            default: return static_cast<uint32_t>(dice_.bits());
        }
    }

    Dice& dice_;
    double chance_;
    bool finite_;
};

}  // namespace spc::fuzz
