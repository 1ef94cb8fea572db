# SPDX-License-Identifier: GPL-3.0-or-later
"""What the core is told: dataclasses and NumPy arrays, without Blender.

Conventions are those of specula.h: right-handed, Z up, metres, watts, linear Rec.709, images from
the bottom row up. Indices refer to the lists of `SceneDesc`. Fields are named as in the C API's
structs, whose enumerations they hold.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..abi import (
    NONE,
    AlphaMode,
    AreaShape,
    AttributeDomain,
    AttributeKind,
    BumpCorrection,
    CausticsRole,
    ColorSpace,
    Crypto,
    Displacement,
    Glints,
    LightType,
    Projection,
    Visibility,
)


class ExportError(Exception):
    """Something in the scene cannot be rendered; the message names the object."""


@dataclass
class ImageDesc:
    """An image with exactly one source: `pixels`, `encoded` or `path`."""

    name: str
    pixels: np.ndarray | None = None  # (H, W, C) uint8 or float32, C in 1, 3, 4; bottom row first
    encoded: bytes | None = None  # an image file's bytes
    path: str | None = None  # an image file, absolute
    color_space: ColorSpace = ColorSpace.SRGB
    alpha_mode: AlphaMode = AlphaMode.STRAIGHT


def missing_image() -> ImageDesc:
    """A magenta pixel, which Cycles shows for an image that cannot be read."""
    magenta = np.array([[[255, 0, 255, 255]]], np.uint8)
    return ImageDesc("(missing image)", pixels=magenta, color_space=ColorSpace.LINEAR)


@dataclass
class NodeDesc:
    """A node; its kinds, sockets and options are those that `native.node_kinds()` lists."""

    name: str
    kind: str
    image: int = NONE
    inputs: dict[str, tuple[float, float, float, float]] = field(default_factory=dict)
    options: dict[str, str] = field(default_factory=dict)
    arrays: dict[str, np.ndarray] = field(default_factory=dict)  # (rows, columns) float32


@dataclass(frozen=True)
class LinkDesc:
    """Output `from_socket` of node `from_node` feeds input `to_socket` of node `to_node`."""

    from_node: int
    from_socket: str
    to_node: int
    to_socket: str


@dataclass
class MaterialDesc:
    """A shader graph with exactly one node of kind "output"; a world's background is one too."""

    name: str
    nodes: list[NodeDesc] = field(default_factory=list)
    links: list[LinkDesc] = field(default_factory=list)
    glints: Glints = Glints.AUTO
    displacement: Displacement = Displacement.BUMP
    bump_correction: BumpCorrection = BumpCorrection.NONE
    pass_index: int = 0
    crypto: float = 0.0  # identifier for Cryptomatte; 0: none


@dataclass(frozen=True, order=True)
class AttributeNeed:
    """An attribute that a material reads; '' is the one of its kind, as the active UV layer."""

    kind: AttributeKind
    name: str = ""
    tangents: bool = False


@dataclass
class AttributeDesc:
    """Numbers of a mesh or an object for materials to read."""

    name: str
    kind: AttributeKind
    domain: AttributeDomain
    values: np.ndarray  # (elements of the domain, 1 to 4) float32
    tangents: np.ndarray | None = None  # (T, 3, 4) float32: MikkTSpace xyz, bitangent sign


def uv_layer(
    name: str, uv: np.ndarray, tangents: np.ndarray | None = None, active: bool = True
) -> AttributeDesc:
    """A UV layer of `uv` (T, 3, 2); the active one answers where a node names none."""
    kind = AttributeKind.UV if active else AttributeKind.NAMED
    return AttributeDesc(name, kind, AttributeDomain.CORNER, uv.reshape(-1, 2), tangents)


@dataclass
class MeshDesc:
    """Triangles in object space, counter-clockwise seen from outside."""

    name: str
    positions: np.ndarray  # (V, 3) float32, m
    triangles: np.ndarray  # (T, 3) uint32
    normals: np.ndarray | None = None  # (T, 3, 3) float32 at corners; None: every face is flat
    flat_faces: np.ndarray | None = None  # (T,) uint32: 1 where a face is flat; None: as `normals`
    material_slots: np.ndarray | None = None  # (T,) uint32 < slot_count; None: all 0
    slot_count: int = 1
    attributes: list[AttributeDesc] = field(default_factory=list)


@dataclass
class InstanceDesc:
    name: str
    mesh: int
    transform: np.ndarray  # (3, 4) float32, object to world, invertible
    materials: list[int]  # one for each of the mesh's slots; NONE: nothing is drawn there
    visibility: Visibility = Visibility.ALL
    caustics_role: CausticsRole = CausticsRole.AUTO
    holdout: bool = False  # the camera sees a hole in its place
    attributes: list[AttributeDesc] = field(default_factory=list)
    terminator_offset: float = 0.0  # 0 .. 1: how far the edge of light moves into the light
    pass_index: int = 0
    crypto_object: float = 0.0  # identifiers for Cryptomatte; 0: none
    crypto_asset: float = 0.0
    light_group: str = ""  # of the light that it emits; "": none
    receives_in: int = 0  # sets that it is in, a bit each, as a receiver of light
    blocks_in: int = 0  # and as what throws shadows
    receiver_sets: int = 0  # of the light that it emits, as LightDesc has them
    blocker_sets: int = 0


@dataclass
class LightDesc:
    """A light; fields that its type does not have keep their defaults."""

    name: str
    type: LightType
    transform: np.ndarray  # (3, 4) float32, light to world, shining along -Z
    power: tuple[float, float, float]  # W times colour; sun: irradiance, W/m^2
    radius: float = 0.0  # point, spot: m
    soft_falloff: bool = False  # point, spot: a disk that faces what it lights, not a sphere
    spot_angle: float = np.pi  # full opening angle, rad
    spot_blend: float = 0.0  # share of the cone that is soft
    sun_angle: float = 0.0  # full angular diameter, rad
    shape: AreaShape = AreaShape.RECTANGLE
    size: tuple[float, float] = (1.0, 1.0)  # area: full extents before the transform, m
    spread: float = np.pi  # area: full angle of the beam, rad
    visibility: Visibility = Visibility.ALL
    feeds_caustics: bool = True
    light_group: str = ""  # "": none
    material: int = NONE  # whose emission is a factor of the light; NONE: 1
    receiver_sets: int = 0  # whose members alone it shines on; 0: on everything
    blocker_sets: int = 0  # whose members alone throw its shadow; 0: everything does
    max_bounces: int = 1024  # of paths that are connected to it


@dataclass
class CameraDesc:
    """A camera.

    Its aperture is a disc, or a regular polygon with its corners on the radius, whose rotation is 0
    if the middle of a side is at +X. The ratio divides its width.
    """

    transform: np.ndarray  # (3, 4) float32, camera to world, looking along -Z, +Y up
    width: int  # of the full frame, pixels
    height: int
    crop: tuple[int, int, int, int]  # x0, y0, width, height from the bottom left, pixels
    # left, right, bottom, top at distance 1; orthographic: m; panoramic: shares of the panorama
    viewplane: tuple[float, float, float, float]
    clip_near: float = 0.0  # m along the viewing axis
    clip_far: float = 1e10
    projection: Projection = Projection.PERSPECTIVE
    panorama: tuple[float, ...] = (0.0,) * 8  # as the projection says
    aperture_radius: float = 0.0  # m; 0: all is in focus, and nothing below is read
    focus_distance: float = 1.0  # m along the viewing axis
    aperture_blades: int = 0  # sides of the polygon, at least 3; 0: a disc
    aperture_rotation: float = 0.0  # of the polygon, rad from +X to +Y
    aperture_ratio: float = 1.0  # height by width


@dataclass
class EnvironmentDesc:
    material: int
    visibility: Visibility = Visibility.ALL
    feeds_caustics: bool = True
    light_group: str = ""  # "": none


@dataclass
class SceneDesc:
    images: list[ImageDesc] = field(default_factory=list)
    materials: list[MaterialDesc] = field(default_factory=list)
    meshes: list[MeshDesc] = field(default_factory=list)
    instances: list[InstanceDesc] = field(default_factory=list)
    lights: list[LightDesc] = field(default_factory=list)
    camera: CameraDesc | None = None
    environment: EnvironmentDesc | None = None
    # Names that Cryptomatte may show, by spc_crypto; empty if nobody asks.
    crypto_names: dict[Crypto, set[str]] = field(default_factory=dict)
