# SPDX-License-Identifier: GPL-3.0-or-later
"""addon/abi.py is what specula.h says, as its generator reads it and as a compiler does."""

import ast
import ctypes
import re
import subprocess

import pytest

from specula import abi
from tools import abi as generator
from tools.common import DevError

STRUCTS = {
    "spc" + re.sub("([A-Z])", r"_\1", name).lower(): item
    for name, item in vars(abi).items()
    if isinstance(item, type) and issubclass(item, ctypes.Structure) and hasattr(item, "_fields_")
}


def compiled(expressions: list[str], tmp_path) -> list[int]:
    """Values that a C compiler gives the expressions."""
    prints = "".join(f'printf("%zu\\n", (size_t)({text}));' for text in expressions)
    source = tmp_path / "layout.c"
    source.write_text(
        f"#include <stdio.h>\n#include <specula/specula.h>\nint main(void) {{ {prints} }}\n"
    )
    program = tmp_path / "layout"
    include = generator.HEADER.parents[1]
    subprocess.run(["cc", "-std=c99", f"-I{include}", source, "-o", program], check=True)
    return [int(line) for line in subprocess.check_output([program]).split()]


def test_the_module_is_not_stale():
    there = ast.dump(ast.parse(generator.MODULE.read_text()))
    assert there == ast.dump(ast.parse(generator.module_text())), "run ./dev format"


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


SAMPLE = """
#define SPC_NONE 0xffu
typedef struct spc_thing spc_thing; /* a handle */
typedef enum spc_status { SPC_OK = 0, SPC_OUT_OF_MEMORY = 1 } spc_status;
typedef enum spc_ray_kind { SPC_RAY_CAMERA = 1, SPC_RAY_ALL = 1 } spc_ray_kind;
typedef enum spc_stage { SPC_STAGE_FIRST = 0, SPC_STAGE_COUNT = 1 } spc_stage;
typedef struct spc_part { const char* name; const float* values; } spc_part;
typedef struct spc_whole {
    size_t struct_size;
    uint32_t width, height;
    double seconds[SPC_STAGE_COUNT];
    float matrix[12];
    const spc_part* parts;
    const char* const* names;
} spc_whole;
SPC_API uint32_t spc_version(void);
SPC_API spc_status spc_thing_create(spc_thing** thing);
SPC_API void spc_thing_set(spc_thing* thing, const spc_whole* whole);
"""


def test_forms_of_the_header():
    module = {}
    source = generator.Generator(f"#define SPC_API\n{SAMPLE}").text
    exec(compile(source, "generated", "exec", dont_inherit=True), module)
    whole, part = module["Whole"], module["Part"]
    pointer = ctypes.POINTER
    assert module["NONE"] == 255
    assert [item.name for item in module["Status"]] == ["OK", "OUT_OF_MEMORY"]
    assert [item.name for item in module["Stage"]] == ["FIRST"]
    assert module["RayKind"].ALL | module["RayKind"].CAMERA == module["RayKind"].ALL
    assert part._fields_ == [("name", ctypes.c_char_p), ("values", pointer(ctypes.c_float))]
    assert whole().struct_size == ctypes.sizeof(whole)
    assert dict(whole._fields_[1:]) == {
        "width": ctypes.c_uint32,
        "height": ctypes.c_uint32,
        "seconds": ctypes.c_double * 1,
        "matrix": ctypes.c_float * 12,
        "parts": pointer(part),
        "names": pointer(ctypes.c_char_p),
    }
    assert module["PROTOTYPES"] == {
        "spc_version": (ctypes.c_uint32, ()),
        "spc_thing_create": (ctypes.c_int, (pointer(ctypes.c_void_p),)),
        "spc_thing_set": (None, (ctypes.c_void_p, pointer(whole))),
    }


@pytest.mark.parametrize(
    "text",
    [
        "#define SPC_HALF 0.5f",
        "typedef enum spc_kind { SPC_KIND_A, SPC_KIND_B } spc_kind;",
        "typedef struct spc_flags { uint32_t bits : 3; } spc_flags;",
        "typedef struct spc_long { long value; } spc_long;",
        "typedef struct spc_list { float values[sizeof(float)]; } spc_list;",
        "typedef union spc_either { float real; uint32_t whole; } spc_either;",
        "typedef uint32_t spc_index;",
        "extern uint32_t spc_global;",
        "void spc_call(void (*function)(void));",
        "#if 1",
    ],
)
def test_what_the_generator_does_not_know_is_refused(text):
    with pytest.raises(DevError, match=generator.HEADER.name):
        generator.Generator(text)
