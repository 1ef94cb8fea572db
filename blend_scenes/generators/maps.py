# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural image data in NumPy, without Blender.

Arrays are indexed [row, column] with row 0 at v = 0 (the bottom row, as in Blender), so that u
grows with the column and v with the row. Height fields are periodic; heights and wavelengths share
one length unit.
"""

import numpy as np


def gaussian_height(size, wavelength, rms_slope, seed):
    """Periodic height field on the unit square: white noise under a Gaussian filter.

    `wavelength` (fraction of the square) is where the slope spectrum peaks, `rms_slope` the root
    mean square of dh/du and of dh/dv. Returns the spectrum (size, size) for `spectral_slopes`.
    """
    rng = np.random.default_rng(seed)
    noise = np.fft.fft2(rng.standard_normal((size, size)))
    ku, kv = wave_numbers(size)
    # The filter exp(-k^2 s^2 / 2) gives a slope spectrum k^3 exp(-k^2 s^2), with its peak at
    # k = sqrt(3/2) / s.
    s = np.sqrt(1.5) * wavelength / (2.0 * np.pi)
    spectrum = noise * np.exp(-0.5 * (ku**2 + kv**2) * s**2)
    return scale_to_slope(spectrum, rms_slope)


def brushed_height(size, length, width, rms_slope, seed):
    """Periodic height field on the unit square: scratches along u, Gaussian across and along.

    `length` and `width` are fractions of the square, `rms_slope` that of dh/dv: what is across.
    Returns the spectrum (size, size) for `spectral_slopes`.
    """
    rng = np.random.default_rng(seed)
    noise = np.fft.fft2(rng.standard_normal((size, size)))
    ku, kv = wave_numbers(size)
    spectrum = noise * np.exp(-0.5 * ((ku * length) ** 2 + (kv * width) ** 2) / (2.0 * np.pi) ** 2)
    return spectrum * (rms_slope / np.sqrt(np.mean(spectral_slopes(spectrum)[1] ** 2)))


def ocean_height(size, wavelengths, wind_angle, spread, rms_slope, seed):
    """Periodic height field on the unit square: small directional waves around a wind direction.

    The spectrum is Phillips' k^-4 between the `wavelengths` (longest, shortest; fractions of the
    square), cut smoothly at both ends. `wind_angle` is in radians from +u; `spread` in [0, 1] mixes
    cos^2 (0) with isotropic (1). Returns the spectrum (size, size) for `spectral_slopes`.
    """
    rng = np.random.default_rng(seed)
    noise = np.fft.fft2(rng.standard_normal((size, size)))
    ku, kv = wave_numbers(size)
    k = np.hypot(ku, kv)
    k[0, 0] = 1.0
    longest, shortest = (2.0 * np.pi / w for w in wavelengths)
    band = np.exp(-((longest / k) ** 2)) * np.exp(-((k / shortest) ** 2))
    along = (ku * np.cos(wind_angle) + kv * np.sin(wind_angle)) / k
    directional = (1.0 - spread) * along**2 + spread
    amplitude = np.sqrt(band * directional) / k**2
    amplitude[0, 0] = 0.0
    return scale_to_slope(noise * amplitude, rms_slope)


def wave_numbers(size):
    """Angular wave numbers (ku, kv), each (size, size), of a unit square."""
    k = 2.0 * np.pi * np.fft.fftfreq(size, d=1.0 / size)
    return np.meshgrid(k, k)


def spectral_slopes(spectrum):
    """Exact slopes (dh/du, dh/dv) at the texel centres of a periodic height spectrum."""
    ku, kv = wave_numbers(spectrum.shape[0])
    return np.fft.ifft2(1j * ku * spectrum).real, np.fft.ifft2(1j * kv * spectrum).real


def spline_slopes(heights, side, texels):
    """Exact slopes (along +u, along +v) of the periodic cubic B-spline over a square of `side`.

    Its control points are `heights` (n, n), at the middles of n x n cells; the slopes are those at
    the centres of `texels` x `texels` texels in each cell.
    """
    count = len(heights)
    position = (np.arange(count * texels) + 0.5) / texels - 0.5  # in control points
    first = np.floor(position).astype(int)
    t = (position - first)[:, None]
    value = np.hstack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, 3 * (t + t**2 - t**3) + 1, t**3]) / 6
    slope = np.hstack([-((1 - t) ** 2), 3 * t**2 - 4 * t, 1 + 2 * t - 3 * t**2, t**2]) / 2
    rows = np.arange(len(position))[:, None]
    near = (first[:, None] + np.arange(-1, 3)) % count
    values, slopes = np.zeros((2, len(position), count))
    values[rows, near] = value
    slopes[rows, near] = slope * count / side
    return values @ heights @ slopes.T, slopes @ heights @ values.T


def scale_to_slope(spectrum, rms_slope):
    """The spectrum scaled so that the slopes' root mean square, over both axes, is `rms_slope`."""
    slope_u, slope_v = spectral_slopes(spectrum)
    return spectrum * (rms_slope / np.sqrt(np.mean(0.5 * (slope_u**2 + slope_v**2))))


def normal_map(slope_u, slope_v):
    """Tangent-space normals (h, w, 3) in [0, 1]: 0.5 + 0.5 n, +Y up (OpenGL)."""
    n = np.stack([-slope_u, -slope_v, np.ones_like(slope_u)], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return 0.5 + 0.5 * n


def sphere_slopes(height, wavelength, rms_slope, seed, waves=256):
    """Slopes (along +u, along +v) of isotropic bumps on the unit sphere.

    They are sampled at the texels of a latitude-longitude map (height, 2 height); u is the
    longitude over 2 pi, v = 0 the pole -Z. The field is a sum of plane waves in space, restricted
    to the sphere: it has neither seam nor pinched poles. `wavelength` is measured on the unit
    sphere; slopes are per unit length of the surface, as a tangent-space normal map wants them.
    """
    rng = np.random.default_rng(seed)
    directions = rng.standard_normal((waves, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    k = directions * (2.0 * np.pi / wavelength * rng.uniform(0.6, 1.2, (waves, 1)))
    phase = rng.uniform(0.0, 2.0 * np.pi, waves)

    phi = 2.0 * np.pi * (np.arange(2 * height) + 0.5) / (2 * height)
    theta = np.pi * (np.arange(height) + 0.5) / height
    phi, theta = np.meshgrid(phi, theta)
    sin_t, cos_t, sin_p, cos_p = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
    zero = np.zeros_like(phi)
    point = np.stack([sin_t * cos_p, sin_t * sin_p, -cos_t], axis=-1)
    east = np.stack([-sin_p, cos_p, zero], axis=-1)
    north = np.stack([cos_t * cos_p, cos_t * sin_p, sin_t], axis=-1)

    gradient = np.zeros_like(point)
    for wave_k, wave_phase in zip(k, phase, strict=True):
        gradient -= np.sin(point @ wave_k + wave_phase)[..., None] * wave_k
    slope_u = np.sum(gradient * east, axis=-1)
    slope_v = np.sum(gradient * north, axis=-1)
    scale = rms_slope / np.sqrt(np.mean(0.5 * (slope_u**2 + slope_v**2) * sin_t) / np.mean(sin_t))
    return slope_u * scale, slope_v * scale


def tiles(size, count, colors, grout, joint, variation, seed, weights=None):
    """A periodic field of count x count square tiles with grout: sRGB (size, size, 3) in [0, 1].

    Each tile takes one of `colors` (chance `weights`) and a brightness within +- `variation`;
    `joint` is the joint's width as a fraction of a tile. Edges are antialiased over one texel.
    """
    rng = np.random.default_rng(seed)
    colors = np.asarray(colors, dtype=float)
    pick = rng.choice(len(colors), size=(count, count), p=weights)
    tile = colors[pick] * (1.0 + variation * rng.uniform(-1.0, 1.0, (count, count, 1)))

    position = (np.arange(size) + 0.5) / size * count
    index = position.astype(int)
    inside = np.minimum(position - index, index + 1 - position) - 0.5 * joint
    coverage = np.clip(0.5 + inside * size / count, 0.0, 1.0)
    mask = (coverage[:, None] * coverage[None, :])[..., None]
    image = tile[index][:, index] * mask + np.asarray(grout, dtype=float) * (1.0 - mask)
    return np.clip(image, 0.0, 1.0)


def planks(size, count, color, gap, seed):
    """Wooden planks along u: sRGB (size, size, 3) in [0, 1], periodic, `count` planks along v."""
    rng = np.random.default_rng(seed)
    position = (np.arange(size) + 0.5) / size
    plank = (position * count).astype(int)
    inside = np.minimum(position * count - plank, plank + 1 - position * count) - 0.5 * gap
    mask = np.clip(0.5 + inside * size / count, 0.0, 1.0)[:, None, None]

    # Grain: noise stretched along the plank, shifted from plank to plank.
    noise = np.fft.fft2(rng.standard_normal((size, size)))
    ku, kv = wave_numbers(size)
    grain = np.zeros((size, size))
    for across, weight in ((0.05, 0.6), (0.012, 0.4)):
        s_v = across / (2.0 * np.pi)
        layer = np.fft.ifft2(noise * np.exp(-0.5 * ((ku * 16.0 * s_v) ** 2 + (kv * s_v) ** 2))).real
        grain += weight * layer / layer.std()
    shift = rng.integers(0, size, count)[plank]
    grain = np.take_along_axis(grain, (np.arange(size)[None, :] + shift[:, None]) % size, axis=1)
    tone = 1.0 + 0.10 * rng.uniform(-1.0, 1.0, count)[plank][:, None] + 0.055 * grain
    wood = np.asarray(color, dtype=float) * tone[..., None]
    return np.clip(wood * mask + 0.25 * np.asarray(color) * (1.0 - mask), 0.0, 1.0)


def stripes(size, colors):
    """Vertical stripes of equal width, one per colour: sRGB (size, size, 3)."""
    index = np.arange(size) * len(colors) // size
    return np.broadcast_to(np.asarray(colors, dtype=float)[index], (size, size, 3)).copy()


def sky_directions(height):
    """Azimuth and elevation (height, 2 height) and direction (height, 2 height, 3) of texels.

    Blender's equirectangular mapping.
    """
    azimuth = 2.0 * np.pi * (0.5 - (np.arange(2 * height) + 0.5) / (2 * height))
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    azimuth, elevation = np.meshgrid(azimuth, elevation)
    direction = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=-1,
    )
    return azimuth, elevation, direction


def dark_room(height, ambient, lamps):
    """Equirectangular room with round lamps: linear radiance (height, 2 height, 3).

    `ambient` is (floor, ceiling) radiance; `lamps` holds (direction, diameter in radians, colour
    (3,) of radiance). Blender's mapping, discs without antialiasing.
    """
    _, _, direction = sky_directions(height)
    low, high = (np.asarray(color, dtype=float) for color in ambient)
    radiance = low + (high - low) * (0.5 + 0.5 * direction[..., 2:])
    for towards, diameter, color in lamps:
        axis = np.asarray(towards, dtype=float) / np.linalg.norm(towards)
        radiance[direction @ axis > np.cos(0.5 * diameter)] = color
    return radiance


def night_street(height, seed, windows=26):
    """Equirectangular street at night: linear radiance (height, 2 height, 3).

    A dim blue sky over a darker ground, and soft lit windows in a band above the horizon, on the
    side of -y. No window is so bright that it would have to be sampled as a lamp.
    """
    rng = np.random.default_rng(seed)
    azimuth, elevation, direction = sky_directions(height)
    radiance = np.array([0.020, 0.030, 0.065]) * (1.0 + 0.6 * direction[..., 2:])
    for _ in range(windows):
        a, e = rng.uniform(-np.pi, 0.0), rng.uniform(-0.05, 0.75)
        width, tall = rng.uniform(0.05, 0.14), rng.uniform(0.06, 0.22)
        color = np.array([1.0, 0.72, 0.42]) if rng.uniform() < 0.7 else np.array([0.6, 0.8, 1.0])
        glow = np.exp(-(((azimuth - a) / width) ** 4) - ((elevation - e) / tall) ** 4)
        radiance = np.maximum(radiance, rng.uniform(0.15, 0.5) * glow[..., None] * color)
    return radiance


def clear_sky(height, sun_direction, sun_diameter, sun_irradiance, zenith, horizon, ground):
    """Equirectangular sky with a sun disc: linear radiance (height, 2 height, 3).

    The mapping is Blender's. `sun_direction` points at the sun, `sun_diameter` is in radians,
    `sun_irradiance` (3,) is what the disc gives on a plane facing it. The disc is antialiased and
    then scaled to that irradiance exactly.
    """
    width = 2 * height
    sub = 8
    azimuth, elevation, direction = sky_directions(height)
    sun = np.asarray(sun_direction, dtype=float)
    sun /= np.linalg.norm(sun)
    cos_sun = direction @ sun

    up = np.clip(direction[..., 2:], 0.0, 1.0)
    sky = np.asarray(horizon) + (np.asarray(zenith) - np.asarray(horizon)) * up**0.45
    glow = 0.5 * np.exp((cos_sun - 1.0) / 0.02) + 0.25 * np.exp((cos_sun - 1.0) / 0.15)
    sky = sky + glow[..., None] * np.asarray([1.0, 0.88, 0.70])
    # Fade from ground to sky over two degrees: no hard line for the texture filter to carry.
    fade = np.clip(0.5 + elevation / np.radians(2.0), 0.0, 1.0)[..., None]
    radiance = np.asarray(ground) * (1.0 - fade) + sky * fade

    disc = np.zeros((height, width))
    offset = (np.arange(sub) + 0.5) / sub - 0.5
    for du in offset:
        for dv in offset:
            a, e = azimuth - 2.0 * np.pi * du / width, elevation + np.pi * dv / height
            c = np.cos(e) * np.cos(a) * sun[0] + np.cos(e) * np.sin(a) * sun[1] + np.sin(e) * sun[2]
            disc += c > np.cos(0.5 * sun_diameter)
    texel_solid_angle = (2.0 * np.pi / width) * (np.pi / height) * np.cos(elevation)
    disc /= np.sum(disc * texel_solid_angle * np.maximum(cos_sun, 0.0))
    return radiance + disc[..., None] * np.asarray(sun_irradiance)
