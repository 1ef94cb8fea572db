// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_field.h"

namespace spc {

namespace {

// Finest level with sums. Below it a region is described by the node around it.
constexpr int kFirstSums = 3;
// Of normals that are not normalised; steeper ones than 1 / kLeastHeight are artefacts of a file.
constexpr float kLeastHeight = 0.02f;

int halved(int n) { return (n + 1) / 2; }
int wrapped(int i, int n) {
    const int m = i % n;
    return m < 0 ? m + n : m;
}

}  // namespace

SlopeJet SlopePatch::jet(float s, float t) const {
    const Vec3 lower = corner[0] + (corner[1] - corner[0]) * s,
               upper = corner[2] + (corner[3] - corner[2]) * s,
               left = corner[0] + (corner[2] - corner[0]) * t,
               right = corner[1] + (corner[3] - corner[1]) * t;
    const Vec3 n = lower + (upper - lower) * t;
    const Vec2 slope = slope_of(n);
    const auto by = [&](const Vec3& d) {  // of a quotient
        return (Vec2(d.x, d.y) - slope * d.z) * (1.0f / n.z);
    };
    return {slope, by(right - left), by(upper - lower)};
}

SlopeBounds SlopePatch::bounds() const {
    const Vec2 first = slope_of(corner[0]);
    SlopeBounds bounds{first, first};
    for (size_t i = 1; i < 4; ++i) bounds.extend(slope_of(corner[i]));
    return bounds;
}

SlopePatch SlopePatch::quarter(int i) const {
    const Vec3 left = (corner[0] + corner[2]) * 0.5f, right = (corner[1] + corner[3]) * 0.5f,
               lower = (corner[0] + corner[1]) * 0.5f, upper = (corner[2] + corner[3]) * 0.5f,
               middle = (left + right) * 0.5f;
    switch (i) {
        case 0: return {{corner[0], lower, left, middle}};
        case 1: return {{lower, corner[1], middle, right}};
        case 2: return {{left, middle, corner[2], upper}};
        default: return {{middle, right, upper, corner[3]}};
    }
}

std::optional<SlopeField> SlopeField::build(const Image& image, float strength) {
    SlopeField field;
    field.image_ = &image;
    field.strength_ = strength;
    field.width_ = static_cast<int>(image.width);
    field.height_ = static_cast<int>(image.height);
    const Vec2 first = slope_of(field.texel(0, 0));
    SlopeBounds all{first, first};
    for (int y = 0; y < field.height_; ++y)
        for (int x = 0; x < field.width_; ++x) {
            const Vec3 n = field.texel(x, y);
            if (!(n.z >= kLeastHeight)) return std::nullopt;
            all.extend(slope_of(n));
        }
    field.pyramid_ = SlopePyramid(field.width_, field.height_, all,
                                  [&](int x, int y) { return field.cell(x, y).bounds(); });
    field.build_sums();
    return field;
}

Vec3 SlopeField::texel(int x, int y) const {
    const int column = x == width_ ? 0 : x, row = y == height_ ? 0 : y;
    const size_t at =
        (static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column)) *
        image_->channels;
    Vec3 c;
    for (int i = 0; i < 3; ++i) {
        const size_t k = at + (image_->channels == 1 ? 0 : static_cast<size_t>(i));
        c[i] = image_->bytes.empty() ? image_->floats[k]
                                     : static_cast<float>(image_->bytes[k]) * (1.0f / 255.0f);
    }
    c = c * 2.0f - Vec3(1.0f);
    return {c.x * strength_, c.y * strength_, 1.0f + (c.z - 1.0f) * clamp01(strength_)};
}

SlopePatch SlopeField::cell(int x, int y) const {
    return {{texel(x, y), texel(x + 1, y), texel(x, y + 1), texel(x + 1, y + 1)}};
}

SlopePatch SlopeField::cell_in_any_tile(int x, int y) const {
    return cell(wrapped(x, width_), wrapped(y, height_));
}

void SlopeField::build_sums() {
    int w = width_, h = height_;
    for (int l = 0; l < kFirstSums; ++l) {
        w = halved(w);
        h = halved(h);
    }
    SumLevel finest{w, h,
                    std::vector<Sums>(static_cast<size_t>(w) * static_cast<size_t>(h), Sums{})};
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const Vec2 s = slope_of(texel(x, y));
            Sums& sums = finest.nodes[static_cast<size_t>(y >> kFirstSums) * static_cast<size_t>(w) +
                                      static_cast<size_t>(x >> kFirstSums)];
            sums.add({s.x, s.y, s.x * s.x, s.x * s.y, s.y * s.y, 1.0f});
        }
    sums_.push_back(std::move(finest));
    while (w > 1 || h > 1) {
        const SumLevel& below = sums_.back();
        w = halved(w);
        h = halved(h);
        SumLevel level{w, h,
                       std::vector<Sums>(static_cast<size_t>(w) * static_cast<size_t>(h), Sums{})};
        for (int y = 0; y < below.height; ++y)
            for (int x = 0; x < below.width; ++x) {
                const Sums& from =
                    below.nodes[static_cast<size_t>(y) * static_cast<size_t>(below.width) +
                                static_cast<size_t>(x)];
                level
                    .nodes[static_cast<size_t>(y / 2) * static_cast<size_t>(w) +
                           static_cast<size_t>(x / 2)]
                    .add(from);
            }
        sums_.push_back(std::move(level));
    }
}

SlopeMoments SlopeField::moments(const Vec2& lower, const Vec2& upper) const {
    // The first level at which two nodes span the rectangle along both axes.
    const float extent = std::max(upper.x - lower.x, upper.y - lower.y);
    size_t l = 0;
    while (l + 1 < sums_.size() && extent > 2.0f * static_cast<float>(1 << (kFirstSums + l))) ++l;
    const SumLevel& level = sums_[l];
    Sums all{};
    const auto add = [&](int x, int y) {
        all.add(level.nodes[static_cast<size_t>(y) * static_cast<size_t>(level.width) +
                            static_cast<size_t>(x)]);
    };
    const auto cell_size = static_cast<float>(1 << (kFirstSums + l));
    const auto first = [&](float at) { return static_cast<int>(std::floor(at / cell_size)); };
    if (level.nodes.size() == 1) {
        add(0, 0);
    } else {
        // Where width or height are not multiples of a node's size, tiles are counted as if they
        // were: this serves estimates alone.
        for (int y = first(lower.y); y <= first(upper.y); ++y)
            for (int x = first(lower.x); x <= first(upper.x); ++x)
                add(wrapped(x, level.width), wrapped(y, level.height));
    }
    const float inv = 1.0f / all.count;
    SlopeMoments m;
    m.mean = Vec2(all.a, all.b) * inv;
    m.aa = std::max(all.aa * inv - m.mean.x * m.mean.x, 0.0f);
    m.bb = std::max(all.bb * inv - m.mean.y * m.mean.y, 0.0f);
    const float most = std::sqrt(m.aa * m.bb);
    m.ab = std::clamp(all.ab * inv - m.mean.x * m.mean.y, -most, most);
    return m;
}

size_t SlopeField::memory_bytes() const {
    size_t bytes = pyramid_.memory_bytes();
    for (const SumLevel& level : sums_) bytes += level.nodes.size() * sizeof(Sums);
    return bytes;
}

}  // namespace spc
