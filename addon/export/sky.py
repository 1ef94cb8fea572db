# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky of a Sky Texture as an image, and its sun as a light.

Models and their data are Blender's: Preetham's; Nishita's single scattering by molecules, aerosols
and ozone of 21 wavelengths; and Garcia Linan's multiple scattering of four wavelengths. A sky is
computed on a grid of angles to the sun and of elevations, and resampled to an equirectangular
image. All angles are in radians, all colours linear Rec.709.

    A. Preetham et al., "A Practical Analytic Model for Daylight", SIGGRAPH 1999.
    T. Nishita et al., "Display of the Earth Taking into Account Atmospheric Scattering", 1993.
    F. Garcia Linan, "Spectral rendering of skies", https://fgarlin.com, 2024.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT = 1024, 512  # of the image
# Of the tables, over half of the sky, which is symmetric; those of single scattering as Blender's.
COLUMNS, ROWS = 97, 128
SINGLE_COLUMNS, SINGLE_ROWS = 256, 128
SINGLE = ("NISHITA", "SINGLE_SCATTERING")
LIMB_DARKENING = 0.8  # mean of 1 - 0.6 (1 - cos) over a disc

XYZ_TO_RGB = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


@dataclass(frozen=True)
class Sky:
    """What a Sky Texture is set to."""

    model: str  # PREETHAM, NISHITA, its successor SINGLE_SCATTERING or MULTIPLE_SCATTERING
    sun: tuple[float, float, float]  # unit vector towards it
    turbidity: float = 2.0  # of Preetham alone
    altitude: float = 0.0  # m
    air: float = 1.0  # densities, 1: Earth's
    aerosols: float = 1.0
    ozone: float = 1.0
    sun_size: float = 0.0  # full angle; 0: without a disc
    sun_intensity: float = 1.0

    @property
    def elevation(self) -> float:
        return math.asin(max(-1.0, min(1.0, self.sun[2])))


def sky_image(sky: Sky) -> np.ndarray:
    """The sky without its sun, (HEIGHT, WIDTH, 3) float32, bottom row first."""
    directions = _directions()
    if sky.model == "PREETHAM":
        return _to_rgb(_preetham(sky, directions))
    cos_elevation = np.hypot(directions[..., 0], directions[..., 1])
    sun_azimuth = math.atan2(sky.sun[1], sky.sun[0])
    azimuth = np.arctan2(directions[..., 1], directions[..., 0]) - sun_azimuth
    azimuth = np.abs((azimuth + math.pi) % (2 * math.pi) - math.pi)
    elevation = np.arctan2(directions[..., 2], cos_elevation)
    if sky.model in SINGLE:
        return _single_sky(sky, azimuth, elevation)
    return _multiple_sky(sky, azimuth, elevation)


def sun_irradiance(sky: Sky) -> np.ndarray | None:
    """Of the disc on a plane that faces it, (3,) W/m^2; None where none has risen."""
    if sky.model == "PREETHAM" or sky.sun_size <= 0.0 or sky.sun_intensity <= 0.0:
        return None
    half = 0.5 * sky.sun_size
    single = sky.model in SINGLE
    horizon = 0.0 if single else -math.acos(EARTH / (EARTH + sky.altitude * 1e-3))
    height = (sky.elevation - horizon) / half
    if height <= -1.0:
        return None
    height = min(height, 1.0)
    share = 0.5 + (height * math.sqrt(1.0 - height**2) + math.asin(height)) / math.pi
    ends = np.array([sky.elevation - half, sky.elevation + half])
    xyz = _sun_xyz_single(sky, np.maximum(ends, 0.0)) if single else _sun_xyz_multiple(sky, ends)
    return _to_rgb(xyz).mean(axis=0) * (share * LIMB_DARKENING * sky.sun_intensity)


def add_sun(image: np.ndarray, sky: Sky) -> None:
    """Draws the sun into a sky's image, for where it cannot be a light; its irradiance is kept."""
    irradiance = sun_irradiance(sky)
    if irradiance is None:
        return
    directions = _directions()
    cosine = directions @ np.array(sky.sun)
    pixel = math.pi / HEIGHT
    limit = math.cos(max(0.5 * sky.sun_size, pixel))
    disc = np.where(cosine > limit, 1.0, 0.0)
    areas = np.hypot(directions[..., 0], directions[..., 1]) * (2 * math.pi / WIDTH) * pixel
    image += (disc[..., None] * irradiance / (disc * areas).sum()).astype(np.float32)


def _directions() -> np.ndarray:
    """Of the image's pixels, (HEIGHT, WIDTH, 3): its middle is at +X, and +Y left of it."""
    azimuth = (0.5 - (np.arange(WIDTH) + 0.5) / WIDTH) * 2 * math.pi
    elevation = ((np.arange(HEIGHT) + 0.5) / HEIGHT - 0.5) * math.pi
    return _on_sphere(azimuth[None, :], elevation[:, None])


def _on_sphere(azimuth, elevation) -> np.ndarray:
    azimuth, elevation = np.broadcast_arrays(azimuth, elevation)
    flat = np.cos(elevation)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)


def _to_rgb(xyz: np.ndarray) -> np.ndarray:
    return np.maximum(xyz @ XYZ_TO_RGB.T, 0.0).astype(np.float32)


# Elevations are squares of what is uniform: rows lie close to each other at the horizon.
def _elevation_of(row):
    return np.sign(row) * row**2 * (0.5 * math.pi)


def _row_of(elevation):
    return np.sign(elevation) * np.sqrt(np.abs(elevation) / (0.5 * math.pi))


def _multiple_sky(sky: Sky, azimuth: np.ndarray, elevation: np.ndarray) -> np.ndarray:
    """RGB; the azimuth counts from the sun."""
    rows, columns = np.linspace(-1.0, 1.0, ROWS), np.linspace(0.0, math.pi, COLUMNS)
    directions = _on_sphere(columns[None, :], _elevation_of(rows)[:, None])
    grid = _to_rgb(_multiple_scattering(sky, directions))
    return _resampled(
        grid, 0.5 * (_row_of(elevation) + 1.0) * (ROWS - 1), azimuth / math.pi * (COLUMNS - 1)
    )


def _single_sky(sky: Sky, azimuth: np.ndarray, elevation: np.ndarray) -> np.ndarray:
    """As _multiple_sky(). A texel of Blender's table shows its lower corner, the one farther from
    the sun: the table's brightest spot is a little fainter than the sky's. Below the horizon is
    what is seen there, faded."""
    rows = np.arange(SINGLE_ROWS) / SINGLE_ROWS
    columns = np.arange(1, SINGLE_COLUMNS + 1) * math.pi / SINGLE_COLUMNS
    elevations = _elevation_of(rows)
    if sky.model == "NISHITA":
        elevations *= 1.0 + 0.5 / SINGLE_ROWS
    above = _to_rgb(_single_scattering(sky, _on_sphere(columns[None, :], elevations[:, None])))
    x = azimuth / math.pi * SINGLE_COLUMNS - 0.5
    if sky.model == "NISHITA":
        fade = np.maximum(1.0 + 2.5 * np.minimum(np.sin(elevation), 0.0), 0.0) ** 3
        y = _row_of(np.maximum(elevation, 0.0)) * SINGLE_ROWS - 0.5
        return _resampled(above, y, x) * fade[..., None].astype(np.float32)
    depth = np.sin(_elevation_of(np.arange(SINGLE_ROWS, 0, -1) / SINGLE_ROWS))
    below = above[0] * np.maximum(1.0 - 2.5 * depth, 0.0)[:, None, None] ** 3
    y = (_row_of(elevation) + 1.0) * SINGLE_ROWS - 0.5
    return _resampled(np.concatenate([below, above]), y, x)


def _resampled(grid: np.ndarray, y, x) -> np.ndarray:
    """Linear between the entries of a grid (rows, columns, 3), where the first is at y = x = 0."""
    y = np.clip(y, 0.0, grid.shape[0] - 1.0)
    x = np.clip(x, 0.0, grid.shape[1] - 1.0)
    y0 = np.minimum(y.astype(int), grid.shape[0] - 2)
    x0 = np.minimum(x.astype(int), grid.shape[1] - 2)
    fy, fx = (y - y0)[..., None], (x - x0)[..., None]
    low = grid[y0, x0] * (1.0 - fx) + grid[y0, x0 + 1] * fx
    high = grid[y0 + 1, x0] * (1.0 - fx) + grid[y0 + 1, x0 + 1] * fx
    return (low * (1.0 - fy) + high * fy).astype(np.float32)


# -------------------------------------------------------------------------------------- Preetham

# Of Y, x and y: the distribution's five numbers as a + b turbidity.
PEREZ = np.array(
    [
        [
            [-1.4630, 0.1787],
            [0.4275, -0.3554],
            [5.3251, -0.0227],
            [-2.5771, 0.1206],
            [0.3703, -0.0670],
        ],
        [
            [-0.2592, -0.0193],
            [0.0008, -0.0665],
            [0.2125, -0.0004],
            [-0.8989, -0.0641],
            [0.0452, -0.0033],
        ],
        [
            [-0.2608, -0.0167],
            [0.0092, -0.0950],
            [0.2102, -0.0079],
            [-1.6537, -0.0441],
            [0.0529, -0.0109],
        ],
    ]
)
# Of x and y at the zenith: rows by powers of turbidity, columns by powers of the sun's angle.
ZENITH = np.array(
    [
        [
            [0.25886, 0.06052, -0.21196, 0.11693],
            [0.00394, -0.03202, 0.06377, -0.02903],
            [0.0, 0.00209, -0.00375, 0.00166],
        ],
        [
            [0.26688, 0.06670, -0.26756, 0.15346],
            [0.00516, -0.04153, 0.08970, -0.04214],
            [0.0, 0.00317, -0.00610, 0.00275],
        ],
    ]
)
LUMINANCE_SCALE = 0.06


def _preetham(sky: Sky, directions: np.ndarray) -> np.ndarray:
    turbidity, from_zenith = sky.turbidity, math.acos(max(-1.0, min(1.0, sky.sun[2])))
    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * from_zenith)
    zenith = [
        ((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192)
        * LUMINANCE_SCALE
    ]
    turbidities, angles = turbidity ** np.arange(3), from_zenith ** np.arange(4)
    zenith += [float(turbidities @ rows @ angles) for rows in ZENITH]
    cos_gamma = np.clip(directions @ np.array(sky.sun), -1.0, 1.0)
    gamma = np.arccos(cos_gamma)
    lowest = math.cos(0.5 * math.pi - 0.001)  # below the horizon it shows the horizon
    cosine = np.maximum(directions[..., 2], lowest)

    def perez(numbers, cosine, gamma, cos_gamma):
        a, b, c, d, e = numbers
        return (1.0 + a * np.exp(b / cosine)) * (1.0 + c * np.exp(d * gamma) + e * cos_gamma**2)

    luminance, x, y = (
        start
        * perez(numbers, cosine, gamma, cos_gamma)
        / perez(numbers, 1.0, from_zenith, math.cos(from_zenith))
        for start, numbers in zip(zenith, PEREZ @ np.array([1.0, turbidity]), strict=True)
    )
    return np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1) * luminance[..., None]


# ----------------------------------------------------------------------- Nishita, single scattering

EARTH_M, ATMOSPHERE_M = 6360e3, 6420e3  # radii, m
AEROSOL_SCATTERING, AEROSOL_EXTINCTION = 2e-5, 1.11 * 2e-5  # 1/m
SINGLE_G = 0.76
SINGLE_STEPS = 32
STEP_NM = 20.0  # between wavelengths, from 380 nm
# At the top of the atmosphere, W/(m^2 nm).
SUN_SPECTRUM = np.array(
    [
        1.45756829855592995315, 1.56596305559738380175, 1.65148449067670455293,
        1.71496242737209314555,
        1.75797983805020541226, 1.78256407885924539336, 1.79095108475838560302,
        1.78541550133410664714,
        1.76815554864306845317, 1.74122069647250410362, 1.70647127164943679389,
        1.66556087452739887134,
        1.61993437242451854274, 1.57083597368892080581, 1.51932335059305478886,
        1.46628494965214395407,
        1.41245852740172450623, 1.35844961970384092709, 1.30474913844739281998,
        1.25174963272610817455,
        1.19975998755420620867,
    ]
)  # fmt: skip
# 1/m at sea level.
RAYLEIGH = np.array(
    [
        54.24820087636473e-6, 44.18549866505454e-6, 36.35151910165377e-6, 30.17929012024763e-6,
        25.26320226989157e-6, 21.30859310621843e-6, 18.09838025320633e-6, 15.47057129129042e-6,
        13.30284977336850e-6, 11.50184784075764e-6, 9.99557429990163e-6, 8.72799973630707e-6,
        7.65513700977967e-6, 6.74217203751443e-6, 5.96134125832052e-6, 5.29034598065810e-6,
        4.71115687557433e-6, 4.20910481110487e-6, 3.77218381260133e-6, 3.39051255477280e-6,
        3.05591531679811e-6,
    ]
)  # fmt: skip
OZONE = np.array(
    [
        0.00325126849861e-6, 0.00585395365047e-6, 0.01977191155085e-6, 0.07309568762914e-6,
        0.20084561514287e-6, 0.40383958096161e-6, 0.63551335912363e-6, 0.96707041180970e-6,
        1.54797400424410e-6, 2.09038647223331e-6, 2.46128056164565e-6, 2.73551299461512e-6,
        2.15125863128643e-6, 1.59051840791988e-6, 1.12356197979857e-6, 0.73527551487574e-6,
        0.46450130357806e-6, 0.33096079921048e-6, 0.22512612292678e-6, 0.14879129266490e-6,
        0.16828623364192e-6,
    ]
)  # fmt: skip
# The CIE's colour matching functions of 1931.
MATCHING = np.array(
    [
        [0.001368, 0.000039, 0.006450001], [0.01431, 0.000396, 0.06785001], [0.13438, 0.004,
        0.6456],
        [0.34828, 0.023, 1.74706], [0.2908, 0.06, 1.6692], [0.09564, 0.13902, 0.8129501],
        [0.0049, 0.323, 0.272], [0.06327, 0.71, 0.07824999], [0.2904, 0.954, 0.0203],
        [0.5945, 0.995, 0.0039], [0.9163, 0.87, 0.00165], [1.0622, 0.631, 0.0008],
        [0.8544499, 0.381, 0.00019], [0.4479, 0.175, 0.00002], [0.1649, 0.061, 0.0],
        [0.04677, 0.017, 0.0], [0.01135916, 0.004102, 0.0], [0.002899327, 0.001047, 0.0],
        [0.0006900786, 0.0002492, 0.0], [0.0001661505, 0.00006, 0.0], [0.00004150994,
        0.00001499, 0.0],
    ]
)  # fmt: skip
# Gauss-Laguerre, scaled so that all eight nodes lie on a ray: densities fall off exponentially.
_NODES, _WEIGHTS = np.polynomial.laguerre.laggauss(8)
DEPTH_NODES, DEPTH_WEIGHTS = _NODES / 25.0, _WEIGHTS * np.exp(_NODES) / 25.0


def _densities(height: np.ndarray) -> np.ndarray:
    """Of molecules, aerosols and ozone relative to their greatest, (..., 3); height in m."""
    ozone = np.maximum(1.0 - np.abs(height - 25000.0) / 15000.0, 0.0)
    return np.stack([np.exp(-height / 8000.0), np.exp(-height / 1200.0), ozone], axis=-1)


def _way_out(position: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """How far it is to the top of the atmosphere, m."""
    along = (position * direction).sum(axis=-1)
    return -along + np.sqrt(along**2 - (position**2).sum(axis=-1) + ATMOSPHERE_M**2)


def _depths(position: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Of the three kinds to the top of the atmosphere, (..., 3) m at their greatest densities."""
    way = _way_out(position, direction)
    total = 0.0
    for node, weight in zip(DEPTH_NODES, DEPTH_WEIGHTS, strict=True):
        point = position + direction * (node * way)[..., None]
        total = total + weight * _densities(np.linalg.norm(point, axis=-1) - EARTH_M)
    return total * way[..., None]


def _single_altitude(sky: Sky) -> float:
    return min(max(sky.altitude, 1.0), 59999.0)


def _single_scattering(sky: Sky, directions: np.ndarray) -> np.ndarray:
    """XYZ along directions whose azimuth counts from the sun."""
    sun = _on_sphere(0.0, sky.elevation)
    eye = np.array([0.0, 0.0, EARTH_M + _single_altitude(sky)])
    cosine = directions @ sun
    g2 = SINGLE_G**2
    rayleigh = 3.0 / (16.0 * math.pi) * (1.0 + cosine**2)
    mie = (3.0 * (1.0 - g2) * (1.0 + cosine**2)) / (
        8.0 * math.pi * (2.0 + g2) * (1.0 + g2 - 2.0 * SINGLE_G * cosine) ** 1.5
    )
    scale = np.array([sky.air, sky.aerosols, sky.ozone])
    extinction = np.stack([RAYLEIGH, np.full_like(RAYLEIGH, AEROSOL_EXTINCTION), OZONE])
    step = _way_out(np.broadcast_to(eye, directions.shape), directions) / SINGLE_STEPS
    depth = np.zeros_like(directions)
    spectrum = np.zeros((*directions.shape[:-1], len(RAYLEIGH)))
    for i in range(SINGLE_STEPS):
        point = eye + directions * ((i + 0.5) * step)[..., None]
        density = scale * _densities(np.linalg.norm(point, axis=-1) - EARTH_M)
        depth += step[..., None] * density
        attenuation = np.exp(-(depth + scale * _depths(point, sun)) @ extinction)
        scattered = (rayleigh * density[..., 0])[..., None] * RAYLEIGH
        scattered += (mie * density[..., 1] * AEROSOL_SCATTERING)[..., None]
        along = point @ sun
        shaded = (sun[2] < 0.0) & (along**2 >= (point**2).sum(axis=-1) - EARTH_M**2)
        spectrum += np.where(shaded[..., None], 0.0, attenuation * scattered * step[..., None])
    return (spectrum * SUN_SPECTRUM) @ MATCHING * STEP_NM


def _sun_xyz_single(sky: Sky, elevations: np.ndarray) -> np.ndarray:
    """Irradiance in XYZ of a sun at elevations, (..., 3); as in Blender without ozone."""
    direction = _on_sphere(0.0, elevations)
    eye = np.array([0.0, 0.0, EARTH_M + _single_altitude(sky)])
    depth = _depths(np.broadcast_to(eye, direction.shape), direction)
    air, aerosols = sky.air * depth[..., :1], sky.aerosols * depth[..., 1:2]
    spectrum = SUN_SPECTRUM * np.exp(-air * RAYLEIGH - aerosols * AEROSOL_EXTINCTION)
    return spectrum @ MATCHING * STEP_NM


# ---------------------------------------------------------------------------- multiple scattering

EARTH, ATMOSPHERE = 6371.0, 6471.0  # radii, km
MULTIPLE_STEPS = 64
TABLE = (64, 256)  # of transmittance by altitude and by the sun's cosine
MULTIPLE_G = 0.8
GROUND_ALBEDO = 0.3
# At 630, 560, 490 and 430 nm; 1/km and, of cross sections, m^2 times 1e-3.
SUN_4 = np.array([1.679, 1.828, 1.986, 1.307])
RAYLEIGH_4 = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])
OZONE_4 = np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27]) * 334.5
AEROSOL_ABSORPTION_4 = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
AEROSOL_SCATTERING_4 = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
AEROSOL_DENSITY, AEROSOL_BACKGROUND = 1.3681e20, 2e6
SECOND_ORDER_4 = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])
XYZ_4 = np.array(
    [
        [53.386917738564668023, 22.981337506691024754, 0.0],
        [43.904844466369358263, 71.347795700053393866, 0.102506867965741307],
        [1.6137278251608962005, 18.422960591455485011, 31.742921188390805758],
        [20.762668673810577145, 2.3614213523314368527, 110.48009643252140334],
    ]
)


def _coefficients(sky: Sky, altitude: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Molecular scattering, aerosol scattering and extinction, (..., 4) 1/km; altitude in km."""
    altitude = np.maximum(altitude, 0.0)[..., None]
    density = AEROSOL_DENSITY * np.exp(-altitude / 0.73) + AEROSOL_BACKGROUND
    log_altitude = np.log(np.maximum(altitude, 1e-4))
    ozone = 3.78547397e20 * np.exp(-((log_altitude - 3.22261) ** 2) * 5.55555555 - log_altitude)
    molecules = sky.air * RAYLEIGH_4 * np.exp(-0.07771971 * altitude**1.16364243)
    aerosols = sky.aerosols * density * AEROSOL_SCATTERING_4
    absorption = sky.aerosols * density * AEROSOL_ABSORPTION_4 + sky.ozone * ozone * OZONE_4
    return molecules, aerosols, molecules + aerosols + absorption


def _to_sphere(position: np.ndarray, direction: np.ndarray, radius: float) -> np.ndarray:
    """Distance to where a sphere around the Earth's centre is hit; negative where it is not, km."""
    along = (position * direction).sum(axis=-1)
    square = along**2 - (position**2).sum(axis=-1) + radius**2
    root = np.sqrt(np.maximum(square, 0.0))
    near, far = -along - root, -along + root
    return np.where(square < 0.0, -1.0, np.where(near > 0.0, near, far))


def _transmittance(sky: Sky, cosine: np.ndarray, altitude: np.ndarray) -> np.ndarray:
    """To the top of the atmosphere at an angle from the zenith, (..., 4); altitude in km."""
    cosine, altitude = np.broadcast_arrays(cosine, altitude)
    sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    direction = np.stack([sine, np.zeros_like(sine), cosine], axis=-1)
    position = np.stack([np.zeros_like(sine), np.zeros_like(sine), EARTH + altitude], axis=-1)
    step = _to_sphere(position, direction, ATMOSPHERE) / MULTIPLE_STEPS
    depth = 0.0
    for i in range(MULTIPLE_STEPS):
        point = position + direction * ((i + 0.5) * step)[..., None]
        depth = depth + _coefficients(sky, np.linalg.norm(point, axis=-1) - EARTH)[2]
    return np.exp(-depth * step[..., None])


def _multiple_altitude(sky: Sky) -> float:
    """In km."""
    return min(max(sky.altitude, 1.0), 99999.0) * 1e-3


def _multiple_scattering(sky: Sky, directions: np.ndarray) -> np.ndarray:
    """XYZ along directions whose azimuth counts from the sun."""
    heights, cosines = np.linspace(0.0, 1.0, TABLE[0]), np.linspace(-1.0, 1.0, TABLE[1])
    table = _transmittance(sky, cosines[None, :], heights[:, None] * (ATMOSPHERE - EARTH))

    def look_up(cosine, height):
        x = np.clip(0.5 * cosine + 0.5, 0.0, 1.0) * (TABLE[1] - 1)
        y = np.clip(height, 0.0, 1.0) * (TABLE[0] - 1)
        x0, y0 = np.minimum(x.astype(int), TABLE[1] - 2), np.minimum(y.astype(int), TABLE[0] - 2)
        fx, fy = (x - x0)[..., None], (y - y0)[..., None]
        low = table[y0, x0] * (1.0 - fx) + table[y0, x0 + 1] * fx
        high = table[y0 + 1, x0] * (1.0 - fx) + table[y0 + 1, x0 + 1] * fx
        return low * (1.0 - fy) + high * fy

    sun = _on_sphere(0.0, sky.elevation)
    eye = np.array([0.0, 0.0, EARTH + _multiple_altitude(sky)])
    cosine = directions @ sun
    molecular_phase = (3.0 / (16.0 * math.pi) * (1.0 + cosine**2))[..., None]
    g = MULTIPLE_G
    aerosol_phase = (1.0 - g**2) / (4.0 * math.pi * (1.0 + g**2 - 2.0 * g * cosine) ** 1.5)
    position = np.broadcast_to(eye, directions.shape)
    ground = _to_sphere(position, directions, EARTH)
    top = _to_sphere(position, directions, ATMOSPHERE)
    step = np.where(ground < 0.0, top, ground) / MULTIPLE_STEPS
    radiance = np.zeros((*directions.shape[:-1], 4))
    transmittance = np.ones_like(radiance)
    for i in range(MULTIPLE_STEPS):
        point = eye + directions * ((i + 0.5) * step)[..., None]
        distance = np.linalg.norm(point, axis=-1)
        altitude = np.maximum(distance - EARTH, 0.0)
        height = altitude / (ATMOSPHERE - EARTH)
        to_sun = (point @ sun) / distance
        molecules, aerosols, extinction = _coefficients(sky, altitude)
        # What comes from the ground, and from other points of the atmosphere by a fit.
        below = 2.0 * math.pi * (1.0 - np.sqrt(np.maximum(1.0 - (EARTH / distance) ** 2, 0.0)))
        up = np.ones_like(to_sun)
        from_ground = look_up(up, 0.0 * height) / look_up(up, height)
        ground_light = below * (GROUND_ALBEDO / math.pi / (4.0 * math.pi)) * to_sun
        again = SECOND_ORDER_4 / (1.0 + 5.0 * np.exp(-17.92 * to_sun))[..., None]
        again = again + ground_light[..., None] * look_up(to_sun, 0.0 * height) * from_ground
        direct = look_up(to_sun, height)
        source = molecules * (molecular_phase * direct + again)
        source = SUN_4 * (source + aerosols * (aerosol_phase[..., None] * direct + again))
        passed = np.exp(-step[..., None] * extinction)
        radiance += transmittance * source * (1.0 - passed) / np.maximum(extinction, 1e-7)
        transmittance *= passed
    return radiance @ XYZ_4


def _sun_xyz_multiple(sky: Sky, elevations: np.ndarray) -> np.ndarray:
    """Irradiance in XYZ of a sun at elevations, (..., 3)."""
    altitude = np.full_like(elevations, _multiple_altitude(sky))
    return (SUN_4 * _transmittance(sky, np.sin(elevations), altitude)) @ XYZ_4
