// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi cells in one to four dimensions, over T = float or a dual. Their points, metrics and
// fractal sums are Blender's.
//   S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996.
//   I. Quilez, "Voronoi borders" and "Smooth Voronoi", iquilezles.org.
#pragma once

#include <cstring>
#include <limits>
#include <utility>

#include "shading/noise.h"

namespace spc {

enum class VoronoiFeature : uint8_t { f1, f2, smooth_f1, distance_to_edge, sphere_radius };
enum class VoronoiMetric : uint8_t { euclidean, manhattan, chebychev, minkowski };
// Which numbers cells get in two to four dimensions.
enum class VoronoiHash : uint8_t { lookup3, pcg };

template <class T>
struct Voronoi {
    VoronoiFeature feature = VoronoiFeature::f1;
    VoronoiMetric metric = VoronoiMetric::euclidean;
    VoronoiHash hash = VoronoiHash::lookup3;
    bool normalized = false;
    T detail{}, roughness{}, lacunarity{};
    T smoothness{}, exponent{}, randomness{};
};

// What is seen at a point.
template <class T, size_t N>
struct VoronoiPoint {
    T distance{};
    Vector3<T> color{};
    Point<T, N> position{};  // of the cell's point
};

namespace voronoi {

template <class T, size_t N>
T dot(const Point<T, N>& a, const Point<T, N>& b) {
    T sum = a[0] * b[0];
    for (size_t k = 1; k < N; ++k) sum += a[k] * b[k];
    return sum;
}
template <class T, size_t N>
Point<T, N> sum(Point<T, N> a, const Point<T, N>& b) {
    for (size_t k = 0; k < N; ++k) a[k] = a[k] + b[k];
    return a;
}
template <class T, size_t N>
Point<T, N> difference(Point<T, N> a, const Point<T, N>& b) {
    for (size_t k = 0; k < N; ++k) a[k] = a[k] - b[k];
    return a;
}
template <class T>
T mixed(const T& a, const T& b, const T& t) {
    return a + (b - a) * t;
}

template <class T, size_t N>
T length(const Point<T, N>& a) {
    if constexpr (N == 1) return absolute(a[0]);
    return safe_root(dot(a, a));
}

template <class T, size_t N>
T distance(const Voronoi<T>& v, const Point<T, N>& way) {
    if (N == 1 || v.metric == VoronoiMetric::euclidean) return length(way);
    T result = v.metric == VoronoiMetric::minkowski ? safe_power(absolute(way[0]), v.exponent)
                                                    : absolute(way[0]);
    for (size_t k = 1; k < N; ++k) {
        const T part = absolute(way[k]);
        if (v.metric == VoronoiMetric::manhattan) result += part;
        if (v.metric == VoronoiMetric::chebychev) result = larger(result, part);
        if (v.metric == VoronoiMetric::minkowski) result += safe_power(part, v.exponent);
    }
    return v.metric == VoronoiMetric::minkowski
               ? safe_power(result, safe_divide(T(1.0f), v.exponent))
               : result;
}

// Whole coordinates as words, zeros behind them.
template <size_t M, size_t N, class Float>
std::array<WordLike<Float>, M> whole_words(const Point<Float, N>& cells) {
    std::array<WordLike<Float>, M> result{};
    for (size_t k = 0; k < N; ++k) result[k] = LikeWord<WordLike<Float>>::from_whole(cells[k]);
    return result;
}
// The numbers of cells, or of cells side by side, at whole coordinates.
template <size_t N, class Float>
Point<Float, N> random_points(VoronoiHash hash, const Point<Float, N>& cells) {
    if constexpr (N > 1)
        if (hash == VoronoiHash::pcg) return pcg_unit(whole_words<N>(cells));
    return hash_point(cells);
}

// The cell around a point, which is the origin of all places.
template <class T, size_t N>
struct Cell {
    Cell(VoronoiHash hash_of_cells, const Point<float, N>& at, const Point<T, N>& in_it)
        : hash(hash_of_cells), corner(at), local(in_it) {}
    Cell(const Point<T, N>& p, VoronoiHash hash_of_cells) : hash(hash_of_cells) {
        for (size_t k = 0; k < N; ++k) {
            const T x = lattice_coordinate(p[k]);
            corner[k] = std::floor(value_of(x));
            local[k] = x - T(corner[k]);
        }
    }
    Point<float, N> neighbor(const Point<float, N>& step) const { return sum(corner, step); }
    // Of the point of the cell so many steps away.
    Point<T, N> point(const Point<float, N>& step, const T& randomness) const {
        return point(step, random_points(hash, neighbor(step)), randomness);
    }
    static Point<T, N> point(const Point<float, N>& step, const Point<float, N>& random,
                             const T& randomness) {
        Point<T, N> place;
        for (size_t k = 0; k < N; ++k) place[k] = T(step[k]) + T(random[k]) * randomness;
        return place;
    }
    Vector3<T> color(const Point<float, N>& step) const {
        const std::array<float, 3> c = random_color(neighbor(step));
        return {T(c[0]), T(c[1]), T(c[2])};
    }
    std::array<float, 3> random_color(const Point<float, N>& cell) const {
        if constexpr (N > 1)
            if (hash == VoronoiHash::pcg) {
                const auto found = pcg_unit(whole_words<std::max<size_t>(N, 3)>(cell));
                return {found[0], found[1], found[2]};
            }
        return hash_color(cell);
    }
    Point<T, N> in_space(Point<T, N> place) const { return moved(place, corner); }

    VoronoiHash hash;
    Point<float, N> corner;
    Point<T, N> local;
};

// All cells up to `Reach` steps around one, x fastest, and their random numbers, which are found
// side by side.
template <size_t N, int Reach>
class Neighbors {
public:
    template <class T>
    Neighbors(const Cell<T, N>& cell, const Point<float, N>& from = {}) {
        using Floats = typename LanesOf<kLanes>::Floats;
        for (size_t i = 0; i < kCount; i += kLanes) {
            Point<Floats, N> lanes;
            for (size_t k = 0; k < N; ++k) {
                std::memcpy(&lanes[k], &kSteps[k][i], sizeof(Floats));
                lanes[k] += cell.corner[k] + from[k];
            }
            lanes = random_points(cell.hash, lanes);
            for (size_t k = 0; k < N; ++k) std::memcpy(&random_[k][i], &lanes[k], sizeof(Floats));
        }
    }

    static constexpr size_t count() { return kCount; }
    static Point<float, N> step(size_t i) { return at(kSteps, i); }
    Point<float, N> random(size_t i) const { return at(random_, i); }

private:
    static constexpr size_t kLanes = 8, kWidth = 2 * Reach + 1;
    static constexpr size_t kCount = [] {
        size_t count = 1;
        for (size_t k = 0; k < N; ++k) count *= kWidth;
        return count;
    }();
    using Table = std::array<std::array<float, (kCount + kLanes - 1) / kLanes * kLanes>, N>;
    static constexpr Table kSteps = [] {
        Table steps{};
        for (size_t i = 0; i < kCount; ++i)
            for (size_t k = 0, rest = i; k < N; ++k, rest /= kWidth)
                steps[k][i] = static_cast<float>(rest % kWidth) - static_cast<float>(Reach);
        return steps;
    }();
    static Point<float, N> at(const Table& table, size_t i) {
        Point<float, N> point;
        for (size_t k = 0; k < N; ++k) point[k] = table[k][i];
        return point;
    }

    Table random_;
};

template <class T>
Voronoi<float> without_derivatives(const Voronoi<T>& v) {
    return {v.feature,
            v.metric,
            v.hash,
            v.normalized,
            value_of(v.detail),
            value_of(v.roughness),
            value_of(v.lacunarity),
            value_of(v.smoothness),
            value_of(v.exponent),
            value_of(v.randomness)};
}
template <class T, size_t N>
Cell<float, N> without_derivatives(const Cell<T, N>& cell) {
    Point<float, N> local;
    for (size_t k = 0; k < N; ++k) local[k] = value_of(cell.local[k]);
    return {cell.hash, cell.corner, local};
}

// Which of several values is the least, and the least but one.
struct TwoLeast {
    static constexpr size_t kNothing = ~size_t{0};
    size_t first = kNothing, second = kNothing;
    float first_value = std::numeric_limits<float>::max(), second_value = first_value;

    void add(size_t index, float value) {
        if (value < first_value) {
            second = std::exchange(first, index);
            second_value = std::exchange(first_value, value);
        } else if (value < second_value) {
            second = index;
            second_value = value;
        }
    }
};

// The nearest point, or the second nearest. It is looked for without derivatives.
template <class T, size_t N>
VoronoiPoint<T, N> nearest(const Voronoi<T>& v, const Cell<T, N>& cell, bool second) {
    const Neighbors<N, 1> near(cell);
    const Voronoi<float> plain = without_derivatives(v);
    const Cell<float, N> here = without_derivatives(cell);
    std::array<float, near.count()> distances;
    for (size_t i = 0; i < near.count(); ++i) {
        const Point<float, N> place = here.point(near.step(i), near.random(i), plain.randomness);
        distances[i] = distance(plain, difference(place, here.local));
    }
    TwoLeast least;
    for (size_t i = 0; i < near.count(); ++i) least.add(i, distances[i]);
    const size_t found = second ? least.second : least.first;
    if (found == TwoLeast::kNothing) return {};
    const Point<float, N> step = near.step(found);
    const Point<T, N> place = cell.point(step, near.random(found), v.randomness);
    return {distance(v, difference(place, cell.local)), cell.color(step), cell.in_space(place)};
}

template <class T, size_t N>
VoronoiPoint<T, N> smooth(const Voronoi<T>& v, const Cell<T, N>& cell) {
    const Neighbors<N, 2> near(cell);
    VoronoiPoint<T, N> result;
    for (size_t i = 0; i < near.count(); ++i) {
        const Point<T, N> place = cell.point(near.step(i), near.random(i), v.randomness);
        const T d = distance(v, difference(place, cell.local));
        const T ahead = times((result.distance - d) / v.smoothness, 0.5f) + T(0.5f);
        const T h = i > 0 ? smoothstep(ahead, T(0.0f), T(1.0f)) : T(1.0f);
        const T dip = v.smoothness * h * (T(1.0f) - h);
        const T small_dip = dip / (T(1.0f) + times(v.smoothness, 3.0f));
        const Vector3<T> color = cell.color(near.step(i));
        const auto blend = [&](const T& a, const T& b) { return mixed(a, b, h) - small_dip; };
        result.distance = mixed(result.distance, d, h) - dip;
        result.color = {blend(result.color.x, color.x), blend(result.color.y, color.y),
                        blend(result.color.z, color.z)};
        for (size_t k = 0; k < N; ++k) result.position[k] = blend(result.position[k], place[k]);
    }
    result.position = cell.in_space(result.position);
    return result;
}

template <class T, size_t N>
T distance_to_edge(const Voronoi<T>& v, const Cell<T, N>& cell) {
    const Neighbors<N, 1> near(cell);
    const auto way_to = [&](size_t i) {
        return difference(cell.point(near.step(i), near.random(i), v.randomness), cell.local);
    };
    if constexpr (N == 1) {  // the borders of its own cell, even where a neighbour's point is nearer
        const T middle = way_to(1)[0];
        return smaller(absolute(times(middle + way_to(0)[0], 0.5f)),
                       absolute(times(middle + way_to(2)[0], 0.5f)));
    }
    const Cell<float, N> here = without_derivatives(cell);
    const float randomness = value_of(v.randomness);
    std::array<Point<float, N>, near.count()> ways;
    TwoLeast square;
    for (size_t i = 0; i < near.count(); ++i) {
        ways[i] = difference(here.point(near.step(i), near.random(i), randomness), here.local);
        square.add(i, dot(ways[i], ways[i]));
    }
    if (square.first == TwoLeast::kNothing) return T(std::numeric_limits<float>::max());
    const auto to_edge = [](const auto& closest, const auto& way) {
        const auto across = difference(way, closest);
        return times(dot(sum(closest, way), across), 0.5f) / safe_root(dot(across, across));
    };
    TwoLeast edge;
    for (size_t i = 0; i < near.count(); ++i) {
        const Point<float, N> across = difference(ways[i], ways[square.first]);
        if (dot(across, across) > 1e-4f)  // not the closest one itself
            edge.add(i, to_edge(ways[square.first], ways[i]));
    }
    if (edge.first == TwoLeast::kNothing) return T(std::numeric_limits<float>::max());
    return to_edge(way_to(square.first), way_to(edge.first));
}

// Half the way from the nearest point to the one nearest to it.
template <class T, size_t N>
T sphere_radius(const Voronoi<T>& v, const Cell<T, N>& cell) {
    const Voronoi<float> plain = without_derivatives(v);
    const Cell<float, N> here = without_derivatives(cell);
    // Of the neighbours of `from`; its own point counts only where it is looked for.
    const auto least_from = [&](const Point<float, N>& from, const Point<float, N>& to, bool own) {
        const Neighbors<N, 1> near(here, from);
        TwoLeast least;
        for (size_t i = 0; i < near.count(); ++i)
            if (own || near.step(i) != Point<float, N>{}) {
                const Point<float, N> step = sum(near.step(i), from);
                const Point<float, N> place = here.point(step, near.random(i), plain.randomness);
                least.add(i, length(difference(place, to)));
            }
        return least.first == TwoLeast::kNothing ? from : sum(near.step(least.first), from);
    };
    const Point<float, N> closest = least_from({}, here.local, true);
    const Point<float, N> next = least_from(closest, here.point(closest, plain.randomness), false);
    return times(
        length(difference(cell.point(next, v.randomness), cell.point(closest, v.randomness))), 0.5f);
}

template <class T, size_t N>
VoronoiPoint<T, N> octave(const Voronoi<T>& v, const Point<T, N>& p) {
    const Cell<T, N> cell(p, v.hash);
    switch (v.feature) {
        case VoronoiFeature::f1: return nearest(v, cell, false);
        case VoronoiFeature::f2: return nearest(v, cell, true);
        case VoronoiFeature::smooth_f1:
            return value_of(v.smoothness) != 0.0f ? smooth(v, cell) : nearest(v, cell, false);
        case VoronoiFeature::distance_to_edge: return {.distance = distance_to_edge(v, cell)};
        case VoronoiFeature::sphere_radius: return {.distance = sphere_radius(v, cell)};
    }
    return {};
}

// The greatest distance that a normalised one is measured by.
template <class T, size_t N>
T most_distance(const Voronoi<T>& v) {
    const T half = times(v.randomness, 0.5f) + T(0.5f);
    if (v.feature == VoronoiFeature::distance_to_edge) return half;
    Point<T, N> diagonal;
    diagonal.fill(half);
    return times(distance(v, diagonal), v.feature == VoronoiFeature::f2 ? 2.0f : 1.0f);
}

// What octaves come to: distances and colours add up, or, of edges, the nearest one is kept, and
// the position is blended from octave to octave.
template <class T, size_t N>
struct Sum {
    VoronoiPoint<T, N> at;
    T most{};  // of the distance
    T amplitudes{};

    void blend(const Sum& other, const T& share) {
        at.distance = mixed(at.distance, other.at.distance, share);
        at.color = at.color + (other.at.color - at.color) * share;
        for (size_t k = 0; k < N; ++k)
            at.position[k] = mixed(at.position[k], other.at.position[k], share);
        most = mixed(most, other.most, share);
        amplitudes = mixed(amplitudes, other.amplitudes, share);
    }
};

template <class T, size_t N>
void add_octave(const Voronoi<T>& v, const Point<T, N>& p, const T& amplitude, const T& scale,
                Sum<T, N>& sum) {
    const VoronoiPoint<T, N> found = octave(v, scaled(p, scale));
    if (v.feature == VoronoiFeature::distance_to_edge) {
        const T d = safe_divide(found.distance, scale);
        sum.at.distance = mixed(sum.at.distance, smaller(sum.at.distance, d), amplitude);
        sum.most = mixed(sum.most, safe_divide(most_distance<T, N>(v), scale), amplitude);
        return;
    }
    sum.at.distance += found.distance * amplitude;
    sum.at.color = sum.at.color + found.color * amplitude;
    for (size_t k = 0; k < N; ++k)
        sum.at.position[k] =
            mixed(sum.at.position[k], safe_divide(found.position[k], scale), amplitude);
    sum.amplitudes += amplitude;
    sum.most = most_distance<T, N>(v) * sum.amplitudes;
}

}  // namespace voronoi

// As many octaves as `detail` says and one more; the last one fades in.
template <class T, size_t N>
VoronoiPoint<T, N> voronoi_at(const Voronoi<T>& v, const Point<T, N>& p) {
    const bool edges = v.feature == VoronoiFeature::distance_to_edge;
    if (v.feature == VoronoiFeature::sphere_radius) return voronoi::octave(v, p);
    const bool single = value_of(v.detail) == 0.0f || value_of(v.roughness) == 0.0f;
    voronoi::Sum<T, N> sum;
    if (edges) {
        sum.at.distance = T(8.0f);  // beyond all of them
        sum.most = voronoi::most_distance<T, N>(v);
    }
    const int whole = single ? 0 : static_cast<int>(value_of(v.detail));
    T amplitude(1.0f), scale(1.0f);
    for (int i = 0; i <= whole; ++i) {
        voronoi::add_octave(v, p, amplitude, scale, sum);
        amplitude = amplitude * v.roughness;
        scale = scale * v.lacunarity;
    }
    const T rest = single ? T(0.0f) : v.detail - T(static_cast<float>(whole));
    if (value_of(rest) != 0.0f) {
        voronoi::Sum<T, N> next = sum;
        voronoi::add_octave(v, p, amplitude, scale, next);
        sum.blend(next, rest);
    }
    if (v.normalized) {
        sum.at.distance = safe_divide(sum.at.distance, sum.most);
        if (!edges) sum.at.color = sum.at.color * safe_divide(T(1.0f), sum.amplitudes);
    }
    return sum.at;
}

}  // namespace spc
