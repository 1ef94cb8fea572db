# SPDX-License-Identifier: GPL-3.0-or-later
"""The C API of specula.h for ctypes: structs and prototypes, and nothing that decides anything."""

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
from enum import IntEnum

API_VERSION = 8  # SPC_API_VERSION that this file mirrors
STAGE_COUNT = 6  # SPC_STAGE_COUNT

STATUS_NAMES = (
    "OK",
    "invalid argument",
    "wrong state",
    "out of memory",
    "I/O error",
    "unsupported",
    "internal error",
)


class Pass(IntEnum):
    """spc_pass: what can be read from a film."""

    COMBINED = 0
    DEPTH = 1
    POSITION = 2
    NORMAL = 3
    CAUSTICS = 4
    VARIANCE = 5
    WALK_SUCCESS = 6
    WALK_TRIALS = 7


RENDER_RUNNING, RENDER_DONE, RENDER_CANCELLED, RENDER_FAILED = range(4)


class SizedStructure(Structure):
    """A struct whose first field is its own size."""

    def __init__(self, **fields):
        super().__init__(struct_size=sizeof(type(self)), **fields)


def _struct(name: str, *fields: tuple[str, type]) -> type[SizedStructure]:
    return type(name, (SizedStructure,), {"_fields_": [("struct_size", c_size_t), *fields]})


ImageDesc = _struct(
    "spc_image_desc",
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
)


class Node(Structure):
    _fields_ = [("name", c_char_p), ("kind", c_char_p), ("image", c_uint32)]


class NodeInput(Structure):
    _fields_ = [("node", c_uint32), ("socket", c_char_p), ("value", c_float * 4)]


class NodeOption(Structure):
    _fields_ = [("node", c_uint32), ("option", c_char_p), ("value", c_char_p)]


class NodeLink(Structure):
    _fields_ = [
        ("from_node", c_uint32),
        ("from_socket", c_char_p),
        ("to_node", c_uint32),
        ("to_socket", c_char_p),
    ]


MaterialDesc = _struct(
    "spc_material_desc",
    ("name", c_char_p),
    ("nodes", POINTER(Node)),
    ("node_count", c_uint32),
    ("inputs", POINTER(NodeInput)),
    ("input_count", c_uint32),
    ("options", POINTER(NodeOption)),
    ("option_count", c_uint32),
    ("links", POINTER(NodeLink)),
    ("link_count", c_uint32),
    ("glints", c_uint32),
)

MaterialNeeds = _struct("spc_material_needs", ("uv", c_uint32), ("tangents", c_uint32))


class UvLayer(Structure):
    _fields_ = [("name", c_char_p), ("uv", c_void_p), ("tangents", c_void_p)]


MeshDesc = _struct(
    "spc_mesh_desc",
    ("name", c_char_p),
    ("positions", c_void_p),
    ("vertex_count", c_uint32),
    ("triangles", c_void_p),
    ("triangle_count", c_uint32),
    ("normals", c_void_p),
    ("material_slots", c_void_p),
    ("slot_count", c_uint32),
    ("uv_layers", POINTER(UvLayer)),
    ("uv_layer_count", c_uint32),
    ("active_uv_layer", c_uint32),
)

InstanceDesc = _struct(
    "spc_instance_desc",
    ("name", c_char_p),
    ("mesh", c_uint32),
    ("transform", c_float * 12),
    ("materials", POINTER(c_uint32)),
    ("material_count", c_uint32),
    ("visibility", c_uint32),
    ("caustics_role", c_uint32),
)

LightDesc = _struct(
    "spc_light_desc",
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
)

CameraDesc = _struct(
    "spc_camera_desc",
    ("projection", c_uint32),
    ("transform", c_float * 12),
    ("width", c_uint32),
    ("height", c_uint32),
    ("crop", c_uint32 * 4),
    ("viewplane", c_float * 4),
    ("clip_near", c_float),
    ("clip_far", c_float),
    ("aperture_radius", c_float),
    ("focus_distance", c_float),
    ("aperture_blades", c_uint32),
    ("aperture_rotation", c_float),
    ("aperture_ratio", c_float),
)

EnvironmentDesc = _struct(
    "spc_environment_desc",
    ("material", c_uint32),
    ("visibility", c_uint32),
    ("feeds_caustics", c_uint32),
)

SceneStats = _struct(
    "spc_scene_stats",
    ("triangles", c_uint64),
    ("instances", c_uint64),
    ("lights", c_uint64),
    ("casters", c_uint64),
    ("receivers", c_uint64),
    ("dropped_triangles", c_uint64),
    ("memory_bytes", c_uint64),
    ("commit_seconds", c_double),
)

RenderSettings = _struct(
    "spc_render_settings",
    ("method", c_uint32),
    ("light_tracing", c_uint32),
    ("constraint", c_uint32),
    ("two_stage", c_uint32),
    ("set_size", c_uint32),
    ("glint_method", c_uint32),
    ("first_sample", c_uint32),
    ("samples", c_uint32),
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
    ("chain_family", c_char_p),
)

RenderProgress = _struct(
    "spc_render_progress",
    ("state", c_uint32),
    ("samples_done", c_uint32),
    ("fraction", c_float),
    ("seconds", c_double),
    ("stage", c_uint32),
    ("stage_fraction", c_float),
    ("seconds_left", c_double),
)

RenderStats = _struct(
    "spc_render_stats",
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
    ("leads", c_uint64),
    ("led_chains", c_uint64),
    ("missed_chains", c_uint64),
    ("missed_energy", c_double),
    ("glint_estimates", c_uint64),
    ("glint_nodes", c_uint64),
    ("glint_points", c_uint64),
    ("glint_capped", c_uint64),
    ("glint_bytes", c_uint64),
    ("stage_seconds", c_double * STAGE_COUNT),
    ("first_sample_seconds", c_double),
    ("lost_rays", c_uint64),
)

_HANDLE = c_void_p
_INDEX = POINTER(c_uint32)

# name: (result, arguments). A function that returns c_int returns an spc_status.
PROTOTYPES = {
    "spc_api_version": (c_uint32, ()),
    "spc_version_string": (c_char_p, ()),
    "spc_last_error": (c_char_p, ()),
    "spc_node_kinds": (c_char_p, ()),
    "spc_pass_channels": (c_uint32, (c_uint32,)),
    "spc_scene_create": (c_int, (POINTER(_HANDLE),)),
    "spc_scene_destroy": (None, (_HANDLE,)),
    "spc_scene_add_image": (c_int, (_HANDLE, POINTER(ImageDesc), _INDEX)),
    "spc_scene_add_material": (c_int, (_HANDLE, POINTER(MaterialDesc), _INDEX)),
    "spc_scene_material_needs": (c_int, (_HANDLE, c_uint32, POINTER(MaterialNeeds))),
    "spc_scene_add_mesh": (c_int, (_HANDLE, POINTER(MeshDesc), _INDEX)),
    "spc_scene_add_instance": (c_int, (_HANDLE, POINTER(InstanceDesc), _INDEX)),
    "spc_scene_add_light": (c_int, (_HANDLE, POINTER(LightDesc), _INDEX)),
    "spc_scene_set_camera": (c_int, (_HANDLE, POINTER(CameraDesc))),
    "spc_scene_set_environment": (c_int, (_HANDLE, POINTER(EnvironmentDesc))),
    "spc_scene_commit": (c_int, (_HANDLE, c_uint32)),
    "spc_scene_get_stats": (c_int, (_HANDLE, POINTER(SceneStats))),
    "spc_scene_report": (c_char_p, (_HANDLE,)),
    "spc_render_settings_init": (None, (POINTER(RenderSettings),)),
    "spc_render_start": (c_int, (_HANDLE, POINTER(RenderSettings), POINTER(_HANDLE))),
    "spc_render_report": (c_char_p, (_HANDLE,)),
    "spc_render_wait": (c_int, (_HANDLE, c_uint32, POINTER(RenderProgress))),
    "spc_render_cancel": (c_int, (_HANDLE,)),
    "spc_render_get_stats": (c_int, (_HANDLE, POINTER(RenderStats))),
    "spc_film_read": (c_int, (_HANDLE, c_uint32, POINTER(c_float), c_size_t)),
    "spc_session_destroy": (None, (_HANDLE,)),
}
