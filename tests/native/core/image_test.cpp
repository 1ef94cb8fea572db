// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <random>

#include "core/error.h"

namespace spc {
namespace {

using testing::HasSubstr;

constexpr Extension kExtensions[] = {Extension::repeat, Extension::extend, Extension::clip,
                                     Extension::mirror};

Image grey(std::vector<float> texels, uint32_t width, uint32_t height) {
    return image_from_floats("grey", texels, width, height, 1, ColorSpace::linear,
                             AlphaMode::straight);
}
float red(const Image& image, float u, float v, Interpolation interpolation, Extension extension) {
    return lookup(image, u, v, interpolation, extension).r;
}

template <class Function>
std::string error_of(ErrorKind kind, const Function& function) {
    try {
        function();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind);
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

// A file in memory, rows given from the bottom.
template <class Texel>
std::vector<uint8_t> encode(const std::string& extension, int width, int height, int channels,
                            std::vector<Texel> texels, const OIIO::TypeDesc& type) {
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("specula_image_test_" + std::to_string(getpid()) + extension))
                                 .string();
    OIIO::ImageSpec spec(width, height, channels, type);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("compression", "zip");
    const auto output = OIIO::ImageOutput::create(path);
    EXPECT_TRUE(output && output->open(path, spec)) << OIIO::geterror();
    const auto row = static_cast<OIIO::stride_t>(sizeof(Texel)) * width * channels;
    const auto* top = reinterpret_cast<const char*>(texels.data()) + row * (height - 1);
    EXPECT_TRUE(output->write_image(type, top, OIIO::AutoStride, -row, OIIO::AutoStride))
        << output->geterror();
    output->close();
    std::vector<uint8_t> bytes(std::filesystem::file_size(path));
    FILE* file = std::fopen(path.c_str(), "rb");
    EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
    std::fclose(file);
    std::filesystem::remove(path);
    return bytes;
}

TEST(Image, LinearMixesTexelCentres) {
    const Image image = grey({0, 1, 2, 3}, 2, 2);  // bottom row 0 1
    EXPECT_FLOAT_EQ(red(image, 0.25f, 0.25f, Interpolation::linear, Extension::extend), 0.0f);
    EXPECT_FLOAT_EQ(red(image, 0.75f, 0.25f, Interpolation::linear, Extension::extend), 1.0f);
    EXPECT_FLOAT_EQ(red(image, 0.25f, 0.75f, Interpolation::linear, Extension::extend), 2.0f);
    EXPECT_FLOAT_EQ(red(image, 0.5f, 0.5f, Interpolation::linear, Extension::extend), 1.5f);
    EXPECT_FLOAT_EQ(red(image, 0.375f, 0.25f, Interpolation::linear, Extension::extend), 0.25f);
    EXPECT_FLOAT_EQ(lookup(image, 0.5f, 0.5f, Interpolation::linear, Extension::extend).a, 1.0f);
}

TEST(Image, ExtensionModes) {
    const Image image = grey({1, 2, 4}, 3, 1);
    struct Case {
        float texel;  // coordinate in texels, centres at .5
        float repeat, extend, clip, mirror;
    };
    constexpr Case kCases[] = {
        {1.5f, 2, 2, 2, 2},       {3.5f, 1, 4, 0, 4},    {4.5f, 2, 4, 0, 2},  {5.5f, 4, 4, 0, 1},
        {6.5f, 1, 4, 0, 1},       {-0.5f, 4, 1, 0, 1},   {-1.5f, 2, 1, 0, 2}, {-3.5f, 4, 1, 0, 4},
        {0.0f, 2.5f, 1, 0.5f, 1}, {3.0f, 2.5f, 4, 2, 4},
    };
    for (const Case& c : kCases) {
        const float expected[] = {c.repeat, c.extend, c.clip, c.mirror};
        for (int i = 0; i < 4; ++i) {
            EXPECT_NEAR(red(image, c.texel / 3, 0.5f, Interpolation::linear, kExtensions[i]),
                        expected[i], 2e-6f)
                << c.texel << " extension " << i;
            if (c.texel == std::floor(c.texel))
                continue;  // half-integers are centres: closest agrees there
            EXPECT_EQ(red(image, c.texel / 3, 0.5f, Interpolation::closest, kExtensions[i]),
                      expected[i]);
        }
    }
    EXPECT_EQ(lookup(image, 2.0f, 0.5f, Interpolation::linear, Extension::clip).a, 0.0f);
}

TEST(Image, CubicIsTheUniformBSpline) {
    const Image spike = grey({0, 0, 6, 0, 0}, 5, 1);
    EXPECT_NEAR(red(spike, 0.5f, 0.5f, Interpolation::cubic, Extension::extend), 4.0f, 1e-5f);
    EXPECT_NEAR(red(spike, 0.3f, 0.5f, Interpolation::cubic, Extension::extend), 1.0f, 1e-5f);
    const Image ramp = grey({0, 1, 2, 3, 4, 5, 6}, 7, 1);  // straight lines stay straight inside
    for (float x : {2.0f, 2.7f, 3.1f, 4.6f})
        EXPECT_NEAR(red(ramp, (x + 0.5f) / 7, 0.5f, Interpolation::cubic, Extension::repeat), x,
                    1e-5f);
}

// Of the second order, against differences of those of the first.
TEST(Image, SecondDerivatives) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    float largest = 0.0f;
    std::vector<float> texels(size_t{7} * 5 * 3);
    for (float& texel : texels) texel = 0.2f + 0.8f * uniform(random);
    for (const ColorSpace space : {ColorSpace::data, ColorSpace::srgb}) {
        const Image image = image_from_floats("f", texels, 7, 5, 3, space, AlphaMode::none);
        const auto at = [&](const auto& u, const auto& v) {
            return lookup(image, u, v, Interpolation::cubic, Extension::repeat);
        };
        for (int n = 0; n < 200; ++n) {
            const float u = 2.0f * uniform(random), v = 2.0f * uniform(random);
            const auto by_u = Dual<Dual2>(Dual2(u, 1.0f, 0.0f), 1.0f, 0.0f),
                       by_v = Dual<Dual2>(Dual2(v, 0.0f, 1.0f), 0.0f, 1.0f);
            const Dual<Dual2> c = at(by_u, by_v).r;
            const auto first = [&](float du, float dv) {
                return at(Dual2(u + du, 1.0f, 0.0f), Dual2(v + dv, 0.0f, 1.0f)).r;
            };
            const Dual2 here = first(0, 0);
            EXPECT_NEAR(c.v.v, here.v, 1e-6f);
            EXPECT_NEAR(c.v.du, here.du, 1e-5f);
            EXPECT_NEAR(c.dv.v, here.dv, 1e-5f);
            constexpr float kStep = 1e-3f;
            const auto expect_difference = [&](const Dual2& got, float Dual2::*which) {
                const auto along = [&](float du, float dv) {
                    return (first(du, dv).*which - first(-du, -dv).*which) / (2 * kStep);
                };
                // The third derivatives jump where texels meet.
                EXPECT_NEAR(got.du, along(kStep, 0), 1.0f);
                EXPECT_NEAR(got.dv, along(0, kStep), 1.0f);
            };
            expect_difference(c.du, &Dual2::du);
            expect_difference(c.dv, &Dual2::dv);
            largest = std::max(largest, std::abs(c.du.du));
        }
    }
    EXPECT_GT(largest, 20.0f);
}

TEST(Image, BytesAreLinearisedAfterFiltering) {
    const std::vector<uint8_t> texels{0, 255};
    const Image srgb = image_from_bytes("s", texels, 2, 1, 1, ColorSpace::srgb, AlphaMode::straight);
    const Image data = image_from_bytes("d", texels, 2, 1, 1, ColorSpace::data, AlphaMode::straight);
    EXPECT_NEAR(red(srgb, 0.5f, 0.5f, Interpolation::linear, Extension::extend),
                srgb_to_linear(0.5f), 1e-6f);
    EXPECT_NEAR(red(data, 0.5f, 0.5f, Interpolation::linear, Extension::extend), 0.5f, 1e-6f);
    // 0.5 encoded is 0.21404 linear (IEC 61966-2-1).
    EXPECT_NEAR(srgb_to_linear(0.5f), 0.21404f, 1e-5f);
    EXPECT_NEAR(srgb_to_linear(0.02f), 0.02f / 12.92f, 1e-8f);
    for (int i = 0; i <= 255; ++i) {
        const std::vector<uint8_t> one{static_cast<uint8_t>(i)};
        const Image image =
            image_from_bytes("s", one, 1, 1, 1, ColorSpace::srgb, AlphaMode::straight);
        EXPECT_NEAR(red(image, 0.5f, 0.5f, Interpolation::linear, Extension::repeat),
                    srgb_to_linear(static_cast<float>(i) / 255), 4e-7f);
    }
}

TEST(Image, FloatSrgbIsLinearisedAtLoadButAlphaIsNot) {
    const std::vector<float> texel{0.5f, 0.25f, 1.0f, 0.5f};
    const Image image =
        image_from_floats("f", texel, 1, 1, 4, ColorSpace::srgb, AlphaMode::premultiplied);
    const Rgba<float> c = lookup(image, 0.5f, 0.5f, Interpolation::closest, Extension::repeat);
    EXPECT_FLOAT_EQ(c.r, srgb_to_linear(0.5f));
    EXPECT_FLOAT_EQ(c.b, 1.0f);
    EXPECT_FLOAT_EQ(c.a, 0.5f);
}

TEST(Image, AlphaModes) {
    const std::vector<float> texel{0.8f, 0.4f, 0.2f, 0.5f};
    const auto read = [&](ColorSpace space, AlphaMode alpha, bool straight) {
        const Image image = image_from_floats("a", texel, 1, 1, 4, space, alpha);
        return lookup(image, 0.5f, 0.5f, Interpolation::linear, Extension::repeat, straight);
    };
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::straight, false).r, 0.4f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::straight, true).r, 0.8f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::premultiplied, false).r, 0.8f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::premultiplied, true).r, 1.6f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::packed, true).r, 0.8f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::packed, true).a, 0.5f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::none, true).r, 0.8f);
    EXPECT_FLOAT_EQ(read(ColorSpace::linear, AlphaMode::none, true).a, 1.0f);
    EXPECT_FLOAT_EQ(read(ColorSpace::data, AlphaMode::straight, true).r, 0.8f);
    EXPECT_FLOAT_EQ(read(ColorSpace::data, AlphaMode::straight, true).a, 0.5f);
}

TEST(Image, EncodedBytesAreAssociatedBeforeAndStraightenedBeforeLinearisation) {
    const std::vector<uint8_t> texel{200, 100, 50, 51};  // alpha 0.2
    const Image image = image_from_bytes("a", texel, 1, 1, 4, ColorSpace::srgb, AlphaMode::straight);
    EXPECT_NEAR(lookup(image, 0.5f, 0.5f, Interpolation::linear, Extension::repeat).r,
                srgb_to_linear(40.0f / 255), 1e-6f);
    EXPECT_NEAR(lookup(image, 0.5f, 0.5f, Interpolation::linear, Extension::repeat, true).r,
                srgb_to_linear(200.0f / 255), 1e-5f);
}

TEST(Image, DerivativesMatchCentralDifferences) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    int compared = 0;
    for (const uint32_t channels : {1u, 3u, 4u}) {
        for (const bool bytes : {false, true}) {
            std::vector<float> floats(size_t{20} * channels);
            std::vector<uint8_t> eight(floats.size());
            for (size_t i = 0; i < floats.size(); ++i) {
                floats[i] = 0.2f + 0.8f * uniform(random);
                eight[i] = static_cast<uint8_t>(255 * floats[i]);
            }
            const Image image = bytes ? image_from_bytes("b", eight, 5, 4, channels,
                                                         ColorSpace::srgb, AlphaMode::straight)
                                      : image_from_floats("f", floats, 5, 4, channels,
                                                          ColorSpace::linear, AlphaMode::straight);
            for (Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
                for (Extension extension : kExtensions) {
                    for (int n = 0; n < 40; ++n) {
                        const float u = 4.0f * uniform(random) - 2.0f,
                                    v = 4.0f * uniform(random) - 2.0f;
                        constexpr float kStep = 1e-3f;
                        // Inside one cell only: the interpolant has kinks between them.
                        const auto cell = [](float x, float size) {
                            return std::floor(x * size - 0.5f);
                        };
                        if (cell(u - kStep, 5) != cell(u + kStep, 5) ||
                            cell(v - kStep, 4) != cell(v + kStep, 4))
                            continue;
                        const bool straight = n % 2 == 1;
                        const auto at = [&](float du, float dv) {
                            return lookup(image, u + du, v + dv, interpolation, extension, straight);
                        };
                        // d/d(first) moves u by 1 and v by 0.5, d/d(second) v by -2.
                        const Rgba<Dual2> c =
                            lookup(image, Dual2(u, 1.0f, 0.0f), Dual2(v, 0.5f, -2.0f),
                                   interpolation, extension, straight);
                        const Rgba<float> p = at(kStep, 0.5f * kStep),
                                          m = at(-kStep, -0.5f * kStep), here = at(0, 0);
                        const Rgba<float> up = at(0, -kStep), down = at(0, kStep);
                        EXPECT_NEAR(c.r.v, here.r, 2e-6f);
                        EXPECT_NEAR(c.a.v, here.a, 1e-6f);
                        // Truncation of a curved cell and rounding of single precision.
                        EXPECT_NEAR(c.r.du, (p.r - m.r) / (2 * kStep),
                                    2e-3f + 1e-3f * std::abs(c.r.du));
                        EXPECT_NEAR(c.g.dv, (up.g - down.g) / kStep,
                                    4e-3f + 1e-3f * std::abs(c.g.dv));
                        EXPECT_NEAR(c.a.du, (p.a - m.a) / (2 * kStep),
                                    2e-3f + 1e-3f * std::abs(c.a.du));
                        ++compared;
                    }
                }
            }
        }
    }
    EXPECT_GT(compared, 1500);
    const Image image = grey({0, 1}, 2, 1);
    const Rgba<Dual2> closest = lookup(image, Dual2(0.3f, 1, 0), Dual2(0.5f, 0, 1),
                                       Interpolation::closest, Extension::repeat);
    EXPECT_EQ(closest.r.du, 0.0f);
    EXPECT_EQ(closest.r.dv, 0.0f);
}

TEST(Image, AnyCoordinateIsDefined) {
    const Image image = grey({1, 1, 1, 1, 1, 1}, 3, 2);
    constexpr float kHard[] = {std::numeric_limits<float>::quiet_NaN(),
                               kInfinity,
                               -kInfinity,
                               3e38f,
                               -3e38f,
                               1e10f,
                               -1e-30f,
                               -0.0f,
                               1.0f,
                               2147483648.0f};
    for (float u : kHard)
        for (float v : kHard)
            for (Extension extension : kExtensions)
                for (Interpolation interpolation :
                     {Interpolation::linear, Interpolation::closest, Interpolation::cubic}) {
                    const float value = red(image, u, v, interpolation, extension);
                    if (extension == Extension::clip) {
                        EXPECT_TRUE(value >= 0.0f && value <= 1.0f) << u << " " << v;
                    } else {
                        EXPECT_NEAR(value, 1.0f, 1e-6f) << u << " " << v;
                    }
                }
    EXPECT_EQ(red(Image{}, 0.5f, 0.5f, Interpolation::linear, Extension::repeat), 0.0f);
}

TEST(Image, MeanIsOfLinearColour) {
    const std::vector<uint8_t> texels{0, 255, 255, 255};
    const Image image =
        image_from_bytes("m", texels, 4, 1, 1, ColorSpace::srgb, AlphaMode::straight);
    EXPECT_NEAR(mean(image).g, 0.75f, 1e-6f);
    EXPECT_NEAR(mean(image).a, 1.0f, 1e-6f);
}

TEST(Image, PngInMemoryIsBottomRowFirstAndStraight) {
    const std::vector<uint8_t> texels{10, 20, 30, 255, 40, 50, 60, 128};  // 1 x 2, bottom first
    const std::vector<uint8_t> png = encode(".png", 1, 2, 4, texels, OIIO::TypeDesc::UINT8);
    const Image data = image_from_memory("p", png, ColorSpace::data, AlphaMode::straight);
    EXPECT_TRUE(std::ranges::equal(data.bytes, texels));
    EXPECT_FALSE(data.srgb_encoded);
    const Image color = image_from_memory("p", png, ColorSpace::srgb, AlphaMode::straight);
    EXPECT_TRUE(color.srgb_encoded);
    EXPECT_EQ(color.bytes[4], (40 * 128 + 127) / 255);
    EXPECT_EQ(color.bytes[7], 128);
}

TEST(Image, SixteenBitsHalfAndFloatBecomeFloats) {
    const std::vector<uint16_t> shorts{0, 65535, 13107};
    const Image sixteen =
        image_from_memory("s", encode(".png", 1, 1, 3, shorts, OIIO::TypeDesc::UINT16),
                          ColorSpace::data, AlphaMode::straight);
    ASSERT_EQ(sixteen.floats.size(), 3u);
    EXPECT_NEAR(sixteen.floats[2], 0.2f, 1e-6f);
    const std::vector<float> hdr{0.5f, 100.0f, 0.0f, 0.25f};
    const Image exr = image_from_memory("e", encode(".exr", 1, 1, 4, hdr, OIIO::TypeDesc::FLOAT),
                                        ColorSpace::linear, AlphaMode::straight);
    EXPECT_TRUE(std::ranges::equal(exr.floats, hdr));  // OpenEXR is premultiplied by its own word
    EXPECT_TRUE(exr.premultiplied);
}

TEST(Image, FilesThatAreNotFiniteAreRepairedAndCounted) {
    const std::vector<float> texels{1.0f, kInfinity, 3.0f};
    const Image image =
        image_from_memory("r", encode(".exr", 3, 1, 1, texels, OIIO::TypeDesc::FLOAT),
                          ColorSpace::linear, AlphaMode::straight);
    EXPECT_TRUE(std::ranges::equal(image.floats, std::vector<float>{1.0f, 0.0f, 3.0f}));
    EXPECT_EQ(image.repaired_texels, 1u);
}

TEST(Image, BadInputNamesTheImage) {
    const std::vector<float> texels{1.0f, std::numeric_limits<float>::quiet_NaN()};
    const auto bad = ErrorKind::invalid_argument;
    EXPECT_THAT(error_of(bad,
                         [&] {
                             image_from_floats("Wood", texels, 2, 1, 1, ColorSpace::linear,
                                               AlphaMode::none);
                         }),
                HasSubstr("\"Wood\": texel 1 is not finite"));
    EXPECT_THAT(error_of(bad,
                         [&] {
                             image_from_floats("Wood", texels, 2, 2, 1, ColorSpace::linear,
                                               AlphaMode::none);
                         }),
                HasSubstr("\"Wood\""));
    EXPECT_THAT(error_of(bad,
                         [&] {
                             image_from_floats("Wood", texels, 1, 1, 2, ColorSpace::linear,
                                               AlphaMode::none);
                         }),
                HasSubstr("2 channels"));
    EXPECT_THAT(error_of(bad,
                         [&] {
                             image_from_floats("Wood", texels, 0, 1, 1, ColorSpace::linear,
                                               AlphaMode::none);
                         }),
                HasSubstr("no pixels"));
    EXPECT_THAT(error_of(bad,
                         [&] {
                             image_from_bytes("Wood", {}, 70000, 70000, 1, ColorSpace::linear,
                                              AlphaMode::none);
                         }),
                HasSubstr("2^29"));
    EXPECT_THAT(error_of(ErrorKind::io,
                         [&] {
                             image_from_file("Wood", "/nowhere/wood.png", ColorSpace::srgb,
                                             AlphaMode::none);
                         }),
                HasSubstr("/nowhere/wood.png"));
    const std::vector<uint8_t> junk(100, 7);
    EXPECT_THAT(
        error_of(ErrorKind::io,
                 [&] { image_from_memory("Wood", junk, ColorSpace::srgb, AlphaMode::none); }),
        HasSubstr("\"Wood\""));
    EXPECT_THAT(error_of(ErrorKind::io,
                         [&] { image_from_memory("Wood", {}, ColorSpace::srgb, AlphaMode::none); }),
                HasSubstr("\"Wood\""));
    std::vector<float> noise(size_t{64} * 64);
    for (size_t i = 0; i < noise.size(); ++i) noise[i] = std::sin(static_cast<float>(i * i));
    std::vector<uint8_t> cut = encode(".exr", 64, 64, 1, noise, OIIO::TypeDesc::FLOAT);
    cut.resize(cut.size() / 2);
    EXPECT_THAT(
        error_of(ErrorKind::io,
                 [&] { image_from_memory("Wood", cut, ColorSpace::linear, AlphaMode::none); }),
        HasSubstr("\"Wood\""));
}

}  // namespace
}  // namespace spc
