// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi cells in one to four dimensions, over T = float or a dual. Their points, metrics and
// fractal sums are Blender's.
//   S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996.
//   I. Quilez, "Voronoi borders" and "Smooth Voronoi", iquilezles.org.
#pragma once

#include <limits>

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

// The cell around a point, which is the origin of all places.
template <class T, size_t N>
struct Cell {
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
        const Point<float, N> random = random_point(neighbor(step));
        Point<T, N> place;
        for (size_t k = 0; k < N; ++k) place[k] = T(step[k]) + T(random[k]) * randomness;
        return place;
    }
    Vector3<T> color(const Point<float, N>& step) const {
        const std::array<float, 3> c = random_color(neighbor(step));
        return {T(c[0]), T(c[1]), T(c[2])};
    }
    Point<float, N> random_point(const Point<float, N>& cell) const {
        if constexpr (N > 1)
            if (hash == VoronoiHash::pcg) return pcg_unit(words<N>(cell));
        return hash_point(cell);
    }
    std::array<float, 3> random_color(const Point<float, N>& cell) const {
        if constexpr (N > 1)
            if (hash == VoronoiHash::pcg) {
                const auto found = pcg_unit(words<std::max<size_t>(N, 3)>(cell));
                return {found[0], found[1], found[2]};
            }
        return hash_color(cell);
    }
    // Whole coordinates, zeros behind them.
    template <size_t M>
    static std::array<int32_t, M> words(const Point<float, N>& cell) {
        std::array<int32_t, M> result{};
        for (size_t k = 0; k < N; ++k) result[k] = static_cast<int32_t>(cell[k]);
        return result;
    }
    Point<T, N> in_space(Point<T, N> place) const { return moved(place, corner); }

    VoronoiHash hash;
    Point<float, N> corner;
    Point<T, N> local;
};

// Calls visit(step) for all cells up to `reach` steps around one, x fastest.
template <size_t N, class Visit>
void around(int reach, const Visit& visit) {
    const int width = 2 * reach + 1;
    int count = 1;
    for (size_t k = 0; k < N; ++k) count *= width;
    for (int i = 0; i < count; ++i) {
        Point<float, N> step;
        int rest = i;
        for (size_t k = 0; k < N; ++k, rest /= width)
            step[k] = static_cast<float>(rest % width - reach);
        visit(step);
    }
}

// The nearest point, or the second nearest.
template <class T, size_t N>
VoronoiPoint<T, N> nearest(const Voronoi<T>& v, const Cell<T, N>& cell, bool second) {
    struct Found {
        T distance{std::numeric_limits<float>::max()};
        Point<float, N> step{};
        Point<T, N> place{};
    };
    Found first, next;
    around<N>(1, [&](const Point<float, N>& step) {
        const Point<T, N> place = cell.point(step, v.randomness);
        const T d = distance(v, difference(place, cell.local));
        if (value_of(d) < value_of(first.distance)) {
            next = first;
            first = {d, step, place};
        } else if (value_of(d) < value_of(next.distance)) {
            next = {d, step, place};
        }
    });
    const Found& found = second ? next : first;
    return {found.distance, cell.color(found.step), cell.in_space(found.place)};
}

template <class T, size_t N>
VoronoiPoint<T, N> smooth(const Voronoi<T>& v, const Cell<T, N>& cell) {
    VoronoiPoint<T, N> result;
    bool started = false;
    around<N>(2, [&](const Point<float, N>& step) {
        const Point<T, N> place = cell.point(step, v.randomness);
        const T d = distance(v, difference(place, cell.local));
        const T ahead = times((result.distance - d) / v.smoothness, 0.5f) + T(0.5f);
        const T h = started ? smoothstep(ahead, T(0.0f), T(1.0f)) : T(1.0f);
        started = true;
        const T dip = v.smoothness * h * (T(1.0f) - h);
        const T small_dip = dip / (T(1.0f) + times(v.smoothness, 3.0f));
        const Vector3<T> color = cell.color(step);
        const auto blend = [&](const T& a, const T& b) { return mixed(a, b, h) - small_dip; };
        result.distance = mixed(result.distance, d, h) - dip;
        result.color = {blend(result.color.x, color.x), blend(result.color.y, color.y),
                        blend(result.color.z, color.z)};
        for (size_t k = 0; k < N; ++k) result.position[k] = blend(result.position[k], place[k]);
    });
    result.position = cell.in_space(result.position);
    return result;
}

template <class T, size_t N>
T distance_to_edge(const Voronoi<T>& v, const Cell<T, N>& cell) {
    const auto way_to = [&](const Point<float, N>& step) {
        return difference(cell.point(step, v.randomness), cell.local);
    };
    T least(std::numeric_limits<float>::max());
    if constexpr (N == 1) {  // the borders of its own cell, even where a neighbour's point is nearer
        const T middle = way_to({0.0f})[0];
        return smaller(absolute(times(middle + way_to({-1.0f})[0], 0.5f)),
                       absolute(times(middle + way_to({1.0f})[0], 0.5f)));
    }
    Point<T, N> closest{};
    around<N>(1, [&](const Point<float, N>& step) {
        const Point<T, N> way = way_to(step);
        const T square = dot(way, way);
        if (value_of(square) >= value_of(least)) return;
        least = square;
        closest = way;
    });
    least = T(std::numeric_limits<float>::max());
    around<N>(1, [&](const Point<float, N>& step) {
        const Point<T, N> way = way_to(step), across = difference(way, closest);
        const T square = dot(across, across);
        if (value_of(square) <= 1e-4f) return;  // the closest one itself
        least = smaller(least, times(dot(sum(closest, way), across), 0.5f) / safe_root(square));
    });
    return least;
}

// Half the way from the nearest point to the one nearest to it.
template <class T, size_t N>
T sphere_radius(const Voronoi<T>& v, const Cell<T, N>& cell) {
    T least(std::numeric_limits<float>::max());
    Point<float, N> closest_step{};
    Point<T, N> closest{};
    around<N>(1, [&](const Point<float, N>& step) {
        const Point<T, N> place = cell.point(step, v.randomness);
        const T d = length(difference(place, cell.local));
        if (value_of(d) >= value_of(least)) return;
        least = d;
        closest_step = step;
        closest = place;
    });
    least = T(std::numeric_limits<float>::max());
    around<N>(1, [&](const Point<float, N>& step) {
        if (step == Point<float, N>{}) return;
        const Point<T, N> place = cell.point(sum(step, closest_step), v.randomness);
        least = smaller(least, length(difference(place, closest)));
    });
    return times(least, 0.5f);
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

// What octaves come to: distances and colours add up, or, of edges, the nearest one is kept, and the
// position is blended from octave to octave.
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
