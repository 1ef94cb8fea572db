// SPDX-License-Identifier: GPL-3.0-or-later
// Every operation on values, one row each. Folding, code generation, evaluation, means and the
// search for casters read the row; only what an operation computes stands elsewhere: in
// run_arithmetic() or, if it varies with the point, in evaluate.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shading/reads.h"

namespace spc {

enum class Op : uint8_t {
    constant,  // an expression only, never an instruction
    add,
    subtract,
    multiply,
    divide,  // 0 where the divisor is 0
    scale,   // vector times scalar
    one_minus,
    clamp01,
    non_negative,
    maximum,
    square_root,
    luminance,
    mean,
    splat,
    normalize,        // 0 stays 0
    affine,           // a block of three rows of four
    rotate,           // by Euler angles XYZ
    rotate_back,      // by the inverse
    dielectric_ior,   // index from (IOR, Specular IOR Level)
    combine,          // three scalars to a vector
    equirectangular,  // direction to image coordinates
    mirror_ball,      // likewise
    curves,           // lane by lane: a block of least, most and rows of a number for each lane
    light_profile,    // direction to the brightness of a lamp: a block as profile_at() reads it
    ramp,             // factor to colour, and alpha in a fourth lane: a block of rows of four
    absolute,
    exponent,
    sign,
    round,  // half up
    floor,
    ceil,
    truncate,
    fraction,
    sine,
    cosine,
    tangent,
    arcsine,
    arccosine,
    arctangent,
    sinh,
    cosh,
    tanh,
    inverse_root,
    radians,
    degrees,
    power,
    logarithm,  // of a to the base b
    minimum,
    less,  // 1 or 0
    greater,
    modulo,
    floored_modulo,
    snap,
    ping_pong,
    arctan2,
    multiply_add,
    compare,  // 1 where a and b are within c
    smooth_min,
    smooth_max,
    wrap,        // a, max, min
    clamp,       // a, min, max
    mix,         // a, b, share of b
    smoothstep,  // a, from, to
    smootherstep,
    dot,
    length,
    distance,
    cross,
    project,
    reflect,
    refract,  // vector, normal, ratio of indices
    face_forward,
    rotate_axis,  // vector, axis, angle
    rgb_to_hsv,
    hsv_to_rgb,
    rgb_to_hsl,
    hsl_to_rgb,
    blend,         // two colours and a share, by a type of Blend
    fresnel,       // of a dielectric, by cosine and relative index
    sheen_albedo,  // share that a sheen reflects, from (cosine, roughness)
    gamma,         // colour, exponent; of positive channels
    checker,       // of scaled coordinates: 1 or 0
    gradient,      // by a GradientType
    wave,   // by a wave_mode(): (coordinates, distortion, detail, its scale and roughness, phase)
    magic,  // by its depth: (coordinates, scale, distortion)
    brick,  // (coordinates, mortar size, smoothing, bias, width, row height): (tint, mortar, 0)
    white_noise,  // by a noise_mode(): (coordinates, W) to a colour, whose red is the value
    noise,        // likewise: (..., detail, roughness, lacunarity, offset, gain, distortion)
    noise_color,  // likewise
    voronoi,  // by a voronoi_mode(): (coordinates, W, detail, roughness, lacunarity, smoothness,
              // exponent, randomness) to a distance
    voronoi_color,     // likewise
    voronoi_position,  // likewise; W in a fourth lane
    lane,              // lane number `mode` of its operand; the fourth is an image's alpha
    attribute,         // of the mesh or the object, and its fourth component
    position,          // world
    position_object,   // object space
    normal_object,  // of a normal or the interpolated one: unit, in object space, on the side of wo
    normal,         // the interpolated one, unit, world, on the side of wo
    tangent_object,  // of a layer, object space as interpolated; the bitangent's sign in a fourth lane
    direction_to_world,  // a direction of object space, with its length
    true_normal,         // that of the geometry, likewise
    incoming,            // wo
    facing,              // cosine between wo and a normal, or the interpolated one
    backfacing,          // 1 or 0
    barycentric,         // weights of the triangle's first two corners
    transform,           // from space to space, by a transform_mode()
    view_position,       // in the camera's space
    window,              // in the frame, 0 to 1
    mesh_tangent,        // along growing u of a UV layer, world, not normalised
    wireframe,           // 1 within half a width of the triangle's sides, else 0; mode 1: in pixels
    box_weights,         // (object normal, blend): shares of the three sides of a box
    tiled_image,         // as image, from the tile that the coordinates are in
    ray_kind,            // 1 where the ray is of the RayKind `mode`, else 0
    ray_length,          // m
    ray_depth,           // of a RayDepth
    image,               // coordinates to colour, and alpha in a fourth lane
    tangent_normal,      // (strength, colour) to a unit normal on the side of wo
    space_normal,        // likewise, of colours in a NormalSpace
    bump,                // (strength, distance, normal or none) to a unit normal on the side of wo
    shading_normal,      // any vector to a unit normal; the interpolated one where it is 0
    coat,                // what a coat lets through: (normal or none, (share, alpha, index), tint)
    count
};

// What Instruction::index means.
enum class IndexOf : uint8_t { nothing, image, attribute, block, height };

// What an operation comes to on average, when only the means of its operands are known.
enum class MeanOf : uint8_t { operands, image, zero, half, one };

struct OpTraits {
    Op op;
    uint8_t arity;        // number of operands
    uint8_t lanes;        // of the result: 1, 3, or 0 for as many as the first operand has
    bool varies = false;  // with the point, even if all operands are constant
    uint32_t reads = 0;   // of ProgramReads
    MeanOf mean = MeanOf::operands;
    IndexOf index = IndexOf::nothing;
    uint8_t derivatives = 2;    // how many it has: a height needs two, a caster's normal one
    bool gives_normal = false;  // a unit shading normal on the side of wo
    bool has_fourth = false;    // its result takes four registers
    bool interpolates = false;  // the low bits of its mode are an Interpolation
};

inline constexpr std::array<OpTraits, static_cast<size_t>(Op::count)> kOpTraits{{
    {Op::constant, 0, 0},
    {Op::add, 2, 0},
    {Op::subtract, 2, 0},
    {Op::multiply, 2, 0},
    {Op::divide, 2, 0},
    {Op::scale, 2, 3},
    {Op::one_minus, 1, 0},
    {Op::clamp01, 1, 0},
    {Op::non_negative, 1, 0},
    {Op::maximum, 2, 0},
    {Op::square_root, 1, 0},
    {Op::luminance, 1, 1},
    {Op::mean, 1, 1},
    {Op::splat, 1, 3},
    {Op::normalize, 1, 3},
    {.op = Op::affine, .arity = 1, .lanes = 3, .index = IndexOf::block},
    {Op::rotate, 2, 3},
    {Op::rotate_back, 2, 3},
    {Op::dielectric_ior, 2, 1},
    {Op::combine, 3, 3},
    {Op::equirectangular, 1, 3},
    {Op::mirror_ball, 1, 3},
    {.op = Op::curves, .arity = 1, .lanes = 0, .index = IndexOf::block, .interpolates = true},
    {.op = Op::light_profile,
     .arity = 1,
     .lanes = 1,
     .mean = MeanOf::one,
     .index = IndexOf::block,
     .derivatives = 0},
    {.op = Op::ramp,
     .arity = 1,
     .lanes = 3,
     .index = IndexOf::block,
     .has_fourth = true,
     .interpolates = true},
    {Op::absolute, 1, 0},
    {Op::exponent, 1, 0},
    {Op::sign, 1, 0},
    {Op::round, 1, 0},
    {Op::floor, 1, 0},
    {Op::ceil, 1, 0},
    {Op::truncate, 1, 0},
    {Op::fraction, 1, 0},
    {Op::sine, 1, 0},
    {Op::cosine, 1, 0},
    {Op::tangent, 1, 0},
    {Op::arcsine, 1, 0},
    {Op::arccosine, 1, 0},
    {Op::arctangent, 1, 0},
    {Op::sinh, 1, 0},
    {Op::cosh, 1, 0},
    {Op::tanh, 1, 0},
    {Op::inverse_root, 1, 0},
    {Op::radians, 1, 0},
    {Op::degrees, 1, 0},
    {Op::power, 2, 0},
    {Op::logarithm, 2, 0},
    {Op::minimum, 2, 0},
    {Op::less, 2, 0},
    {Op::greater, 2, 0},
    {Op::modulo, 2, 0},
    {Op::floored_modulo, 2, 0},
    {Op::snap, 2, 0},
    {Op::ping_pong, 2, 0},
    {Op::arctan2, 2, 0},
    {Op::multiply_add, 3, 0},
    {Op::compare, 3, 0},
    {Op::smooth_min, 3, 0},
    {Op::smooth_max, 3, 0},
    {Op::wrap, 3, 0},
    {Op::clamp, 3, 0},
    {Op::mix, 3, 0},
    {Op::smoothstep, 3, 0},
    {Op::smootherstep, 3, 0},
    {Op::dot, 2, 1},
    {Op::length, 1, 1},
    {Op::distance, 2, 1},
    {Op::cross, 2, 3},
    {Op::project, 2, 3},
    {Op::reflect, 2, 3},
    {Op::refract, 3, 3},
    {Op::face_forward, 3, 3},
    {Op::rotate_axis, 3, 3},
    {Op::rgb_to_hsv, 1, 3},
    {Op::hsv_to_rgb, 1, 3},
    {Op::rgb_to_hsl, 1, 3},
    {Op::hsl_to_rgb, 1, 3},
    {Op::blend, 3, 3},
    {.op = Op::fresnel, .arity = 2, .lanes = 1, .derivatives = 0},
    {.op = Op::sheen_albedo, .arity = 2, .lanes = 1, .derivatives = 0},
    {Op::gamma, 2, 3},
    {.op = Op::checker, .arity = 1, .lanes = 1, .mean = MeanOf::half},
    {.op = Op::gradient, .arity = 1, .lanes = 1, .mean = MeanOf::half},
    {.op = Op::wave, .arity = 6, .lanes = 1, .mean = MeanOf::half},
    {.op = Op::magic, .arity = 3, .lanes = 3, .mean = MeanOf::half},
    {.op = Op::brick, .arity = 6, .lanes = 3, .index = IndexOf::block},
    {.op = Op::white_noise, .arity = 2, .lanes = 3, .mean = MeanOf::half},
    {Op::noise, 8, 1},
    {Op::noise_color, 8, 3},
    {.op = Op::voronoi, .arity = 8, .lanes = 1, .mean = MeanOf::half},
    {.op = Op::voronoi_color, .arity = 8, .lanes = 3, .mean = MeanOf::half},
    {.op = Op::voronoi_position, .arity = 8, .lanes = 3, .has_fourth = true},
    {Op::lane, 1, 1},
    {.op = Op::attribute,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsAttributes,
     .mean = MeanOf::half,
     .index = IndexOf::attribute,
     .has_fourth = true},
    {.op = Op::position,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsPosition,
     .mean = MeanOf::zero},
    {.op = Op::position_object,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsObjectPosition,
     .mean = MeanOf::zero},
    {.op = Op::normal_object, .arity = 1, .lanes = 3, .varies = true, .mean = MeanOf::zero},
    {.op = Op::normal, .arity = 0, .lanes = 3, .varies = true, .mean = MeanOf::zero},
    {.op = Op::tangent_object,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsTangent,
     .mean = MeanOf::zero,
     .index = IndexOf::attribute,
     .has_fourth = true},
    {.op = Op::direction_to_world, .arity = 1, .lanes = 3, .varies = true, .mean = MeanOf::zero},
    {.op = Op::true_normal, .arity = 0, .lanes = 3, .varies = true, .mean = MeanOf::zero},
    {.op = Op::incoming, .arity = 0, .lanes = 3, .varies = true, .mean = MeanOf::zero, .derivatives = 0},
    {.op = Op::facing, .arity = 1, .lanes = 1, .varies = true, .mean = MeanOf::one, .derivatives = 0},
    {.op = Op::backfacing, .arity = 0, .lanes = 1, .varies = true, .mean = MeanOf::zero},
    {.op = Op::barycentric, .arity = 0, .lanes = 3, .varies = true, .mean = MeanOf::half},
    {.op = Op::transform,
     .arity = 1,
     .lanes = 3,
     .varies = true,
     .reads = kReadsView,
     .mean = MeanOf::zero},
    {.op = Op::view_position,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsView | kReadsPosition,
     .mean = MeanOf::zero},
    {.op = Op::window,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsView | kReadsPosition,
     .mean = MeanOf::zero},
    {.op = Op::mesh_tangent,
     .arity = 0,
     .lanes = 3,
     .varies = true,
     .reads = kReadsTangent,
     .mean = MeanOf::zero,
     .index = IndexOf::attribute},
    {.op = Op::wireframe,
     .arity = 1,
     .lanes = 1,
     .varies = true,
     .reads = kReadsSides | kReadsView | kReadsPosition,
     .mean = MeanOf::zero,
     .derivatives = 0},
    {Op::box_weights, 2, 3},
    {.op = Op::tiled_image,
     .arity = 1,
     .lanes = 3,
     .varies = true,
     .mean = MeanOf::half,
     .index = IndexOf::block,
     .has_fourth = true,
     .interpolates = true},
    {.op = Op::ray_kind,
     .arity = 0,
     .lanes = 1,
     .varies = true,
     .reads = kReadsRay,
     .mean = MeanOf::zero,
     .derivatives = 0},
    {.op = Op::ray_length,
     .arity = 0,
     .lanes = 1,
     .varies = true,
     .reads = kReadsRayLength,
     .mean = MeanOf::one,
     .derivatives = 0},
    {.op = Op::ray_depth,
     .arity = 0,
     .lanes = 1,
     .varies = true,
     .reads = kReadsRay,
     .mean = MeanOf::one,
     .derivatives = 0},
    {.op = Op::image,
     .arity = 1,
     .lanes = 3,
     .varies = true,
     .mean = MeanOf::image,
     .index = IndexOf::image,
     .has_fourth = true,
     .interpolates = true},
    {.op = Op::tangent_normal,
     .arity = 2,
     .lanes = 3,
     .varies = true,
     .reads = kReadsTangent | kReadsObjectNormal,
     .mean = MeanOf::zero,
     .index = IndexOf::attribute,
     .gives_normal = true},
    {.op = Op::space_normal,
     .arity = 2,
     .lanes = 3,
     .varies = true,
     .mean = MeanOf::zero,
     .gives_normal = true},
    {.op = Op::bump,
     .arity = 3,
     .lanes = 3,
     .varies = true,
     .reads = kReadsHeights,
     .mean = MeanOf::zero,
     .index = IndexOf::height,
     .derivatives = 1,
     .gives_normal = true},
    {.op = Op::shading_normal,
     .arity = 1,
     .lanes = 3,
     .varies = true,
     .mean = MeanOf::zero,
     .gives_normal = true},
    {.op = Op::coat, .arity = 3, .lanes = 3, .varies = true, .mean = MeanOf::one, .derivatives = 0},
}};

inline constexpr const OpTraits& traits(Op op) { return kOpTraits[static_cast<size_t>(op)]; }

static_assert(
    [] {
        for (size_t i = 0; i < kOpTraits.size(); ++i)
            if (kOpTraits[i].op != static_cast<Op>(i)) return false;
        return true;
    }(),
    "rows stand in the order of Op");

}  // namespace spc
