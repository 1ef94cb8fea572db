# SPDX-License-Identifier: GPL-3.0-or-later
"""The C API of specula.h for ctypes, written by tools/abi.py: `./dev format` makes it anew.

Names are the header's without their prefix: spc_render_settings is RenderSettings, SPC_METHOD_PT is
Method.PT, SPC_NONE is NONE. A function that returns c_int returns a Status.
"""

from __future__ import annotations

from ctypes import (
    POINTER,
    Structure,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
    sizeof,
)
from enum import IntEnum, IntFlag


class SizedStructure(Structure):
    """A struct whose first field is its own size."""

    def __init__(self, **fields):
        unknown = fields.keys() - {name for name, *_ in self._fields_}
        if unknown:  # ctypes would take them for new attributes
            raise TypeError(f"{type(self).__name__} has no field {', '.join(sorted(unknown))}")
        super().__init__(struct_size=sizeof(type(self)), **fields)


API_VERSION = 18
NONE = 0xFFFFFFFF


class Status(IntEnum):
    OK = 0
    INVALID_ARGUMENT = 1
    WRONG_STATE = 2
    OUT_OF_MEMORY = 3
    IO_ERROR = 4
    UNSUPPORTED = 5
    INTERNAL_ERROR = 6
    CANCELLED = 7


class PixelType(IntEnum):
    U8 = 0
    F32 = 1


class ColorSpace(IntEnum):
    LINEAR = 0
    SRGB = 1
    DATA = 2


class AlphaMode(IntEnum):
    STRAIGHT = 0
    PREMULTIPLIED = 1
    NONE = 2
    PACKED = 3


class ImageDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("name", c_char_p),
        ("pixels", c_void_p),
        ("width", c_uint32),
        ("height", c_uint32),
        ("channels", c_uint32),
        ("pixel_type", c_uint32),
        ("encoded", c_void_p),
        ("encoded_size", c_size_t),
        ("path", c_char_p),
        ("color_space", c_uint32),
        ("alpha_mode", c_uint32),
    ]


class Node(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("kind", c_char_p),
        ("image", c_uint32),
    ]


class NodeInput(Structure):
    _fields_ = [
        ("node", c_uint32),
        ("socket", c_char_p),
        ("value", c_float * 4),
    ]


class NodeOption(Structure):
    _fields_ = [
        ("node", c_uint32),
        ("option", c_char_p),
        ("value", c_char_p),
    ]


class NodeArray(Structure):
    _fields_ = [
        ("node", c_uint32),
        ("name", c_char_p),
        ("values", POINTER(c_float)),
        ("count", c_uint32),
    ]


class NodeLink(Structure):
    _fields_ = [
        ("from_node", c_uint32),
        ("from_socket", c_char_p),
        ("to_node", c_uint32),
        ("to_socket", c_char_p),
    ]


class Glints(IntEnum):
    AUTO = 0
    ON = 1
    OFF = 2


class Displacement(IntEnum):
    BUMP = 0
    VERTICES = 1
    BOTH = 2


class BumpCorrection(IntEnum):
    NONE = 0
    SMOOTHED = 1
    MICROFACET = 2


class MaterialDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("name", c_char_p),
        ("nodes", POINTER(Node)),
        ("node_count", c_uint32),
        ("inputs", POINTER(NodeInput)),
        ("input_count", c_uint32),
        ("options", POINTER(NodeOption)),
        ("option_count", c_uint32),
        ("arrays", POINTER(NodeArray)),
        ("array_count", c_uint32),
        ("links", POINTER(NodeLink)),
        ("link_count", c_uint32),
        ("glints", c_uint32),
        ("bump_correction", c_uint32),
        ("displacement", c_uint32),
        ("pass_index", c_uint32),
        ("crypto", c_float),
    ]


class AttributeKind(IntEnum):
    NAMED = 0
    UV = 1
    COLOR = 2
    GENERATED = 3
    POINTINESS = 4
    ISLAND = 5
    OBJECT = 6
    INSTANCER = 7
    OBJECT_INFO = 8
    PARTICLE_INFO = 9
    VIEW_LAYER = 10


class AttributeNeed(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("kind", c_uint32),
        ("tangents", c_uint32),
    ]


class MaterialNeeds(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("attributes", POINTER(AttributeNeed)),
        ("attribute_count", c_uint32),
    ]


class AttributeDomain(IntEnum):
    CORNER = 0
    VERTEX = 1
    TRIANGLE = 2
    OBJECT = 3


class Attribute(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("kind", c_uint32),
        ("domain", c_uint32),
        ("components", c_uint32),
        ("values", POINTER(c_float)),
        ("tangents", POINTER(c_float)),
    ]


class MeshDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("name", c_char_p),
        ("positions", POINTER(c_float)),
        ("vertex_count", c_uint32),
        ("triangles", POINTER(c_uint32)),
        ("triangle_count", c_uint32),
        ("normals", POINTER(c_float)),
        ("flat_faces", POINTER(c_uint32)),
        ("material_slots", POINTER(c_uint32)),
        ("slot_count", c_uint32),
        ("attributes", POINTER(Attribute)),
        ("attribute_count", c_uint32),
    ]


class Visibility(IntFlag):
    CAMERA = 1
    DIFFUSE = 2
    GLOSSY = 4
    TRANSMISSION = 8
    SHADOW = 16
    ALL = 31


class CausticsRole(IntEnum):
    AUTO = 0
    OFF = 1
    CASTER = 2
    RECEIVER = 3
    BOTH = 4


class InstanceDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("name", c_char_p),
        ("mesh", c_uint32),
        ("transform", c_float * 12),
        ("materials", POINTER(c_uint32)),
        ("material_count", c_uint32),
        ("visibility", c_uint32),
        ("caustics_role", c_uint32),
        ("terminator_offset", c_float),
        ("holdout", c_uint32),
        ("pass_index", c_uint32),
        ("crypto_object", c_float),
        ("crypto_asset", c_float),
        ("light_group", c_char_p),
        ("attributes", POINTER(Attribute)),
        ("attribute_count", c_uint32),
        ("receives_in", c_uint64),
        ("blocks_in", c_uint64),
        ("receiver_sets", c_uint64),
        ("blocker_sets", c_uint64),
    ]


class CausticsSearch(IntEnum):
    NONE = 0
    LIGHT_PATHS = 1
    MANIFOLD = 2
    MANIFOLD_IF_COARSE = 3


class Forecast(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("receives", c_uint32),
        ("search", c_uint32),
        ("reason", c_char_p),
        ("glints", c_char_p),
        ("no_glints", c_char_p),
    ]


class LightType(IntEnum):
    POINT = 0
    SPOT = 1
    SUN = 2
    AREA = 3


class AreaShape(IntEnum):
    RECTANGLE = 0
    ELLIPSE = 1


class LightDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("name", c_char_p),
        ("type", c_uint32),
        ("transform", c_float * 12),
        ("power", c_float * 3),
        ("radius", c_float),
        ("spot_angle", c_float),
        ("spot_blend", c_float),
        ("sun_angle", c_float),
        ("shape", c_uint32),
        ("size", c_float * 2),
        ("spread", c_float),
        ("visibility", c_uint32),
        ("feeds_caustics", c_uint32),
        ("soft_falloff", c_uint32),
        ("material", c_uint32),
        ("light_group", c_char_p),
        ("receiver_sets", c_uint64),
        ("blocker_sets", c_uint64),
        ("max_bounces", c_uint32),
    ]


class Projection(IntEnum):
    PERSPECTIVE = 0
    ORTHOGRAPHIC = 1
    EQUIRECTANGULAR = 2
    FISHEYE_EQUIDISTANT = 3
    FISHEYE_EQUISOLID = 4
    FISHEYE_POLYNOMIAL = 5
    MIRROR_BALL = 6
    EQUIANGULAR_CUBEMAP_FACE = 7
    CENTRAL_CYLINDRICAL = 8


class CameraDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("projection", c_uint32),
        ("transform", c_float * 12),
        ("width", c_uint32),
        ("height", c_uint32),
        ("crop", c_uint32 * 4),
        ("viewplane", c_float * 4),
        ("panorama", c_float * 8),
        ("clip_near", c_float),
        ("clip_far", c_float),
        ("aperture_radius", c_float),
        ("focus_distance", c_float),
        ("aperture_blades", c_uint32),
        ("aperture_rotation", c_float),
        ("aperture_ratio", c_float),
    ]


class EnvironmentDesc(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("material", c_uint32),
        ("visibility", c_uint32),
        ("feeds_caustics", c_uint32),
        ("light_group", c_char_p),
    ]


class SceneStats(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("triangles", c_uint64),
        ("instances", c_uint64),
        ("lights", c_uint64),
        ("casters", c_uint64),
        ("receivers", c_uint64),
        ("dropped_triangles", c_uint64),
        ("memory_bytes", c_uint64),
        ("commit_seconds", c_double),
    ]


class Method(IntEnum):
    PT = 0
    SMS_UNBIASED = 1
    SMS_BIASED = 2
    LT = 3
    SHEETS = 4
    MNEE = 5
    MNEE_BIASED = 6
    AUTO = 7


class LightTracing(IntEnum):
    AUTO = 0
    ON = 1
    OFF = 2


class Constraint(IntEnum):
    HALF_VECTOR = 0
    ANGLE_DIFFERENCE = 1


class GlintMethod(IntEnum):
    SEARCH = 0
    WALKS = 1
    WALKS_BIASED = 2
    YAN = 3


class PixelFilter(IntEnum):
    BOX = 0
    GAUSSIAN = 1
    BLACKMAN_HARRIS = 2


class Crypto(IntEnum):
    OBJECT = 0
    MATERIAL = 1
    ASSET = 2


class RenderSettings(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("method", c_uint32),
        ("light_tracing", c_uint32),
        ("constraint", c_uint32),
        ("two_stage", c_uint32),
        ("set_size", c_uint32),
        ("glint_method", c_uint32),
        ("first_sample", c_uint32),
        ("samples", c_uint32),
        ("total_samples", c_uint32),
        ("time_limit", c_float),
        ("seed", c_uint32),
        ("threads", c_uint32),
        ("max_bounces", c_uint32),
        ("max_diffuse_bounces", c_uint32),
        ("max_glossy_bounces", c_uint32),
        ("max_transmission_bounces", c_uint32),
        ("max_transparent_bounces", c_uint32),
        ("caustics_reflective", c_uint32),
        ("caustics_refractive", c_uint32),
        ("pixel_filter", c_uint32),
        ("filter_width", c_float),
        ("transparent_film", c_uint32),
        ("transparent_glass", c_uint32),
        ("transparent_glass_roughness", c_float),
        ("chain_family", c_char_p),
        ("passes", c_uint64),
        ("light_groups", c_char_p),
        ("color_aovs", c_char_p),
        ("value_aovs", c_char_p),
        ("pass_alpha_threshold", c_float),
        ("mist_start", c_float),
        ("mist_depth", c_float),
        ("mist_exponent", c_float),
        ("for_denoiser", c_uint32),
        ("crypto_kinds", c_uint32),
        ("crypto_ranks", c_uint32),
        ("noise_threshold", c_float),
        ("min_samples", c_uint32),
    ]


class RenderState(IntEnum):
    RUNNING = 0
    DONE = 1
    CANCELLED = 2
    FAILED = 3


class RenderStage(IntEnum):
    MAPS = 0
    SHEETS = 1
    LIGHT_PATHS = 2
    CAMERA_CHAINS = 3
    PROBES = 4
    SAMPLES = 5


class RenderProgress(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("state", c_uint32),
        ("samples_done", c_uint32),
        ("fraction", c_float),
        ("seconds", c_double),
        ("stage", c_uint32),
        ("stage_fraction", c_float),
        ("seconds_left", c_double),
    ]


class RenderStats(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("samples", c_uint64),
        ("rays", c_uint64),
        ("estimates", c_uint64),
        ("walks", c_uint64),
        ("walks_converged", c_uint64),
        ("iterations", c_uint64),
        ("trial_estimates", c_uint64),
        ("trials", c_uint64),
        ("max_trials", c_uint64),
        ("trial_histogram", c_uint64 * 17),
        ("capped_estimates", c_uint64),
        ("capped_energy", c_double),
        ("manifold_energy", c_double),
        ("nan_samples", c_uint64),
        ("light_paths", c_uint64),
        ("splats", c_uint64),
        ("chain_seeds", c_uint64),
        ("seeded_chains", c_uint64),
        ("missed_chains", c_uint64),
        ("missed_energy", c_double),
        ("glint_estimates", c_uint64),
        ("glint_nodes", c_uint64),
        ("glint_points", c_uint64),
        ("glint_capped", c_uint64),
        ("glint_bytes", c_uint64),
        ("stage_seconds", c_double * 6),
        ("first_sample_seconds", c_double),
        ("lost_rays", c_uint64),
    ]


class Pass(IntEnum):
    COMBINED = 0
    DEPTH = 1
    POSITION = 2
    NORMAL = 3
    CAUSTICS = 4
    VARIANCE = 5
    WALK_SUCCESS = 6
    WALK_TRIALS = 7
    UV = 8
    MIST = 9
    OBJECT_INDEX = 10
    MATERIAL_INDEX = 11
    EMISSION = 12
    ENVIRONMENT = 13
    DIFFUSE_DIRECT = 14
    GLOSSY_DIRECT = 15
    TRANSMISSION_DIRECT = 16
    DIFFUSE_INDIRECT = 17
    GLOSSY_INDIRECT = 18
    TRANSMISSION_INDIRECT = 19
    DIFFUSE_COLOR = 20
    GLOSSY_COLOR = 21
    TRANSMISSION_COLOR = 22
    DENOISING_ALBEDO = 23
    DENOISING_NORMAL = 24
    DENOISING_DEPTH = 25
    SAMPLE_COUNT = 26


class CustomPass(IntEnum):
    LIGHT_GROUP = 256
    COLOR_AOV = 512
    VALUE_AOV = 768


class Sums(SizedStructure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("data", c_void_p),
        ("size", c_size_t),
        ("samples", c_uint32),
    ]


# name: (result, arguments)
PROTOTYPES = {
    "spc_api_version": (c_uint32, ()),
    "spc_version_string": (c_char_p, ()),
    "spc_last_error": (c_char_p, ()),
    "spc_scene_create": (c_int, (POINTER(c_void_p),)),
    "spc_scene_destroy": (None, (c_void_p,)),
    "spc_scene_edit": (c_int, (c_void_p, POINTER(c_void_p))),
    "spc_scene_keep_image": (c_int, (c_void_p, c_uint32, POINTER(c_uint32))),
    "spc_scene_keep_material": (c_int, (c_void_p, c_uint32, POINTER(c_uint32))),
    "spc_scene_keep_mesh": (c_int, (c_void_p, c_uint32, POINTER(c_uint32))),
    "spc_scene_add_image": (c_int, (c_void_p, POINTER(ImageDesc), POINTER(c_uint32))),
    "spc_scene_add_material": (c_int, (c_void_p, POINTER(MaterialDesc), POINTER(c_uint32))),
    "spc_scene_material_needs": (c_int, (c_void_p, c_uint32, POINTER(MaterialNeeds))),
    "spc_scene_material_emission": (
        c_int,
        (c_void_p, c_uint32, POINTER(c_float), POINTER(c_uint32)),
    ),
    "spc_node_kinds": (c_char_p, ()),
    "spc_scene_add_mesh": (c_int, (c_void_p, POINTER(MeshDesc), POINTER(c_uint32))),
    "spc_scene_add_instance": (c_int, (c_void_p, POINTER(InstanceDesc), POINTER(c_uint32))),
    "spc_scene_forecast": (
        c_int,
        (c_void_p, POINTER(c_uint32), c_uint32, c_uint32, c_uint32, POINTER(Forecast)),
    ),
    "spc_scene_add_light": (c_int, (c_void_p, POINTER(LightDesc), POINTER(c_uint32))),
    "spc_scene_set_camera": (c_int, (c_void_p, POINTER(CameraDesc))),
    "spc_scene_set_environment": (c_int, (c_void_p, POINTER(EnvironmentDesc))),
    "spc_scene_commit": (c_int, (c_void_p, c_uint32)),
    "spc_scene_commit_start": (c_int, (c_void_p, c_uint32)),
    "spc_scene_commit_wait": (c_int, (c_void_p, c_uint32, POINTER(c_uint32))),
    "spc_scene_commit_cancel": (c_int, (c_void_p,)),
    "spc_scene_get_stats": (c_int, (c_void_p, POINTER(SceneStats))),
    "spc_scene_report": (c_char_p, (c_void_p,)),
    "spc_render_settings_init": (None, (POINTER(RenderSettings),)),
    "spc_render_start": (c_int, (c_void_p, POINTER(RenderSettings), POINTER(c_void_p))),
    "spc_render_wait": (c_int, (c_void_p, c_uint32, POINTER(RenderProgress))),
    "spc_render_cancel": (c_int, (c_void_p,)),
    "spc_render_pause": (c_int, (c_void_p, c_uint32)),
    "spc_render_get_stats": (c_int, (c_void_p, POINTER(RenderStats))),
    "spc_render_report": (c_char_p, (c_void_p,)),
    "spc_pass_channels": (c_uint32, (c_uint32,)),
    "spc_passes": (c_char_p, ()),
    "spc_film_read": (c_int, (c_void_p, c_uint32, POINTER(c_float), c_size_t)),
    "spc_film_read_crypto": (c_int, (c_void_p, c_uint32, c_uint32, POINTER(c_float), c_size_t)),
    "spc_film_export": (c_int, (c_void_p, POINTER(Sums))),
    "spc_sums_add": (c_int, (c_void_p, c_void_p, c_size_t, c_uint32)),
    "spc_sums_extent": (c_int, (c_void_p, c_size_t, c_uint32 * 2)),
    "spc_sums_read": (c_int, (c_void_p, c_size_t, c_uint32, POINTER(c_float), c_size_t)),
    "spc_sums_read_crypto": (
        c_int,
        (c_void_p, c_size_t, c_uint32, c_uint32, POINTER(c_float), c_size_t),
    ),
    "spc_session_destroy": (None, (c_void_p,)),
}
