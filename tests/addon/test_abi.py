# SPDX-License-Identifier: GPL-3.0-or-later
"""The ctypes mirror agrees with specula.h, as parsed and as compiled."""

import ctypes
import re
import subprocess
from pathlib import Path

import pytest

from specula import abi
from specula.export import desc

INCLUDE = Path(__file__).parents[2] / "native" / "include"
HEADER = re.sub(r"/\*.*?\*/", "", (INCLUDE / "specula" / "specula.h").read_text(), flags=re.S)

STRUCTS = {
    "spc_image_desc": abi.ImageDesc,
    "spc_node": abi.Node,
    "spc_node_input": abi.NodeInput,
    "spc_node_option": abi.NodeOption,
    "spc_node_link": abi.NodeLink,
    "spc_material_desc": abi.MaterialDesc,
    "spc_material_needs": abi.MaterialNeeds,
    "spc_uv_layer": abi.UvLayer,
    "spc_mesh_desc": abi.MeshDesc,
    "spc_instance_desc": abi.InstanceDesc,
    "spc_light_desc": abi.LightDesc,
    "spc_camera_desc": abi.CameraDesc,
    "spc_environment_desc": abi.EnvironmentDesc,
    "spc_scene_stats": abi.SceneStats,
    "spc_render_settings": abi.RenderSettings,
    "spc_render_progress": abi.RenderProgress,
    "spc_render_stats": abi.RenderStats,
}

ENUMS = {
    "SPC_COLOR_": desc.ColorSpace,
    "SPC_ALPHA_": desc.AlphaMode,
    "SPC_CAUSTICS_": desc.CausticsRole,
    "SPC_GLINTS_": desc.Glints,
    "SPC_GLINT_METHOD_": desc.GlintMethod,
    "SPC_LIGHT_": desc.LightType,
    "SPC_AREA_": desc.AreaShape,
    "SPC_PROJECTION_": desc.Projection,
    "SPC_METHOD_": desc.Method,
    "SPC_LIGHT_TRACING_": desc.LightTracing,
    "SPC_CONSTRAINT_": desc.Constraint,
    "SPC_FILTER_": desc.PixelFilter,
    "SPC_PASS_": abi.Pass,
    "SPC_STAGE_": desc.Stage,
}


def constants(prefix: str) -> dict[str, int]:
    """Enumerators of the header by what follows `prefix`, but for those of a longer prefix."""
    longer = tuple(other for other in ENUMS if other.startswith(prefix) and other != prefix)
    found = re.findall(rf"({prefix}(\w+)) = (\d+)", HEADER)
    return {name: int(value) for full, name, value in found if not full.startswith(longer)}


def compiled(expressions: list[str], tmp_path) -> list[int]:
    """Values that a C compiler gives the expressions."""
    prints = "".join(f'printf("%zu\\n", (size_t)({text}));' for text in expressions)
    source = tmp_path / "layout.c"
    source.write_text(
        f"#include <stdio.h>\n#include <specula/specula.h>\nint main(void) {{ {prints} }}\n"
    )
    program = tmp_path / "layout"
    subprocess.run(["cc", "-std=c99", f"-I{INCLUDE}", source, "-o", program], check=True)
    return [int(line) for line in subprocess.check_output([program]).split()]


def test_seconds_of_every_stage_are_told():
    assert len(desc.Stage) == abi.STAGE_COUNT


def test_struct_layouts(tmp_path):
    expressions, expected = [], []
    for name, struct in STRUCTS.items():
        expressions.append(f"sizeof({name})")
        expected.append(ctypes.sizeof(struct))
        for field, *_ in struct._fields_:
            member = f"(({name}*)0)->{field}"
            expressions += [f"offsetof({name}, {field})", f"sizeof({member})"]
            expected += [getattr(struct, field).offset, getattr(struct, field).size]
    values = compiled(expressions, tmp_path)
    assert dict(zip(expressions, expected, strict=True)) == dict(
        zip(expressions, values, strict=True)
    )


def test_every_struct_and_function_is_mirrored():
    assert set(STRUCTS) == set(re.findall(r"typedef struct (\w+) \{", HEADER))
    assert set(abi.PROTOTYPES) == set(re.findall(r"SPC_API [^;(]*?\b(spc_\w+)\(", HEADER))


def test_argument_counts():
    for name, parameters in re.findall(r"SPC_API [^;(]*?\b(spc_\w+)\(([^)]*)\)", HEADER):
        count = 0 if parameters.strip() == "void" else parameters.count(",") + 1
        assert len(abi.PROTOTYPES[name][1]) == count, name


def test_api_version():
    assert int(re.search(r"#define SPC_API_VERSION (\d+)u", HEADER)[1]) == abi.API_VERSION


@pytest.mark.parametrize(("prefix", "enum"), ENUMS.items())
def test_enumerations(prefix, enum):
    expected = {member.name: member.value for member in enum}
    assert constants(prefix) in (expected, expected | {"COUNT": len(enum)})


def test_visibility():
    expected = {flag.name: flag.value for flag in desc.Visibility} | {"ALL": desc.Visibility.ALL}
    assert constants("SPC_VISIBLE_") == expected


def test_states_and_statuses():
    assert constants("SPC_RENDER_") == {
        "RUNNING": abi.RENDER_RUNNING,
        "DONE": abi.RENDER_DONE,
        "CANCELLED": abi.RENDER_CANCELLED,
        "FAILED": abi.RENDER_FAILED,
    }
    status_count = len(
        re.findall(r"SPC_\w+ = \d", HEADER.split("typedef enum spc_status")[1].split("}")[0])
    )
    assert len(abi.STATUS_NAMES) == status_count
