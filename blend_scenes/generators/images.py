# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays -> packed Blender images. Arrays are (height, width, 3), row 0 at the bottom."""

import os
import struct
import tempfile
import zlib

import bpy
import numpy as np


def encode_png(pixels, bits):
    """PNG bytes of RGB values in [0, 1], 8 or 16 bits a channel, Paeth-filtered."""
    height, width, _ = pixels.shape
    levels = np.rint(pixels[::-1] * (2**bits - 1)).astype(">u2" if bits == 16 else "u1")
    stride = 3 * bits // 8
    raw = np.frombuffer(levels.tobytes(), np.uint8).reshape(height, width * stride).astype(np.int16)
    up = np.vstack([np.zeros_like(raw[:1]), raw[:-1]])
    left, up_left = (
        np.hstack([np.zeros((height, stride), np.int16), a[:, :-stride]]) for a in (raw, up)
    )
    estimate = left + up - up_left
    d_left, d_up, d_up_left = (abs(estimate - a) for a in (left, up, up_left))
    paeth = np.where(
        (d_left <= d_up) & (d_left <= d_up_left), left, np.where(d_up <= d_up_left, up, up_left)
    )
    filtered = ((raw - paeth) & 0xFF).astype(np.uint8)
    rows = np.hstack([np.full((height, 1), 4, np.uint8), filtered])

    def chunk(tag, data):
        body = tag + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, bits, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
        + chunk(b"IEND", b"")
    )


def normal_image(name, pixels, bits=16):
    """A packed image of tangent-space normals, 16-bit unless it is so rough that 8 bits will do.

    Blender loads it as floats and 'Non-Color' leaves them as they are. 16 bits resolve a normal to
    3e-5; 8 bits (8e-3) would show as facets in a caustic.
    """
    return _pack(name + ".png", encode_png(pixels, bits), "Non-Color")


def color_image(name, pixels):
    """A packed 8-bit sRGB image."""
    return _pack(name + ".png", encode_png(pixels, 8), "sRGB")


def radiance_image(name, pixels):
    """A packed half-float OpenEXR of linear radiance, written by Blender itself."""
    height, width, _ = pixels.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = pixels
    source = bpy.data.images.new(name, width, height, float_buffer=True)
    source.colorspace_settings.name = "Linear"
    source.pixels.foreach_set(rgba.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "16", "ZIP"
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, name + ".exr")
        source.save_render(path)
        with open(path, "rb") as file:
            data = file.read()
    settings.file_format = "PNG"
    bpy.data.images.remove(source)
    return _pack(name + ".exr", data, "Linear")


def _pack(file_name, data, colorspace):
    image = bpy.data.images.new(file_name, 1, 1)
    image.pack(data=data, data_len=len(data))
    image.source = "FILE"
    image.filepath_raw = "//" + file_name
    image.colorspace_settings.name = colorspace
    return image
