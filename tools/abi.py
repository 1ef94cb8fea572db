# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes addon/abi.py, the C API for ctypes, from native/include/specula/specula.h.

The header keeps to a few forms: constants, enumerations, structs of numbers, pointers and arrays,
opaque handles, functions. Anything else is refused: who adds a form to the header adds it here.
"""

from __future__ import annotations

import os.path
import re
import subprocess

from pycparser import c_ast, c_parser

from tools.common import ROOT, DevError

HEADER = ROOT / "native" / "include" / "specula" / "specula.h"
MODULE = ROOT / "addon" / "abi.py"

# What the header takes from <stddef.h> and <stdint.h>, for the parser.
TYPEDEFS = (
    "typedef unsigned long size_t; typedef unsigned uint32_t; typedef unsigned long uint64_t;"
)
NUMBERS = {
    "float": "c_float",
    "double": "c_double",
    "size_t": "c_size_t",
    "uint32_t": "c_uint32",
    "uint64_t": "c_uint64",
}
SIZE_FIELD = "struct_size"
NOT_A_CONSTANT = {"SPECULA_SPECULA_H", "SPC_API"}

PREAMBLE = '''\
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

'''


def python_name(name: str) -> str:
    """Class of a C type: RenderSettings of spc_render_settings."""
    return "".join(part.capitalize() for part in name.removeprefix("spc_").split("_"))


def refuse(node: c_ast.Node, what: str) -> DevError:
    """The error for a declaration in a form that this generator does not know."""
    return DevError(f"{HEADER.name}:{node.coord.line}: {what}; teach tools/abi.py, or write it so")


class Generator:
    """Reads the header once, from top to bottom; `text` is then the module."""

    def __init__(self, header: str):
        self._enums: dict[str, dict[str, int]] = {}  # C name -> enumerator -> value
        self._structs: set[str] = set()
        self._handles: set[str] = set()
        self._blocks: list[str] = []  # classes
        self._prototypes: list[str] = []
        constants = self._constants(header)
        for node in self._parse(header).ext:
            if not node.coord.file:  # TYPEDEFS
                continue
            self._declaration(node)
        prototypes = "\n".join(f"    {line}" for line in self._prototypes)
        self.text = "\n".join(
            [
                PREAMBLE,
                *(f"{name} = {value}" for name, value in constants.items()),
                "",
                *self._blocks,
                "",
                "# name: (result, arguments)",
                f"PROTOTYPES = {{\n{prototypes}\n}}\n",
            ]
        )

    @staticmethod
    def _constants(header: str) -> dict[str, str]:
        constants = {}
        for name, value in re.findall(r"^#define (\w+)(.*)$", header, re.M):
            if name in NOT_A_CONSTANT:
                continue
            number = re.fullmatch(r" (0x[0-9a-f]+|\d+)u", value)
            if not number:
                raise DevError(f"{HEADER.name}: #define {name} is no unsigned number")
            constants[name.removeprefix("SPC_")] = number[1]
        return constants

    @staticmethod
    def _parse(header: str) -> c_ast.FileAST:
        # Without the headers of the system, and as for a compiler that marks no exports: plain C.
        own = re.sub(r"^#include <std(def|int)\.h>$", "", header, flags=re.M)
        command = ["cc", "-E", "-xc", "-std=c99", "-nostdinc", "-U__GNUC__", "-"]
        result = subprocess.run(command, input=own, capture_output=True, text=True)
        if result.returncode != 0:
            raise DevError(f"{HEADER.name} cannot be preprocessed: {result.stderr}")
        return c_parser.CParser().parse(f"{TYPEDEFS}\n{result.stdout}")

    def _declaration(self, node: c_ast.Node) -> None:
        if isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.FuncDecl):
            self._function(node)
        elif isinstance(node, c_ast.Typedef) and isinstance(node.type.type, c_ast.Enum):
            self._enumeration(node.name, node.type.type)
        elif isinstance(node, c_ast.Typedef) and isinstance(node.type.type, c_ast.Struct):
            if node.type.type.decls is None:
                self._handles.add(node.name)
            else:
                self._struct(node.name, node.type.type)
        else:
            raise refuse(node, "neither typedef of an enum or a struct nor a function")

    def _enumeration(self, name: str, node: c_ast.Enum) -> None:
        values = {}
        for item in node.values.enumerators:
            if not isinstance(item.value, c_ast.Constant):
                raise refuse(item, f"{item.name} has no number")
            values[item.name] = int(item.value.value)
        self._enums[name] = values
        prefix = os.path.commonprefix(list(values)).rpartition("_")[0] + "_"
        members = {item.removeprefix(prefix): value for item, value in values.items()}
        if members.get("COUNT") == len(members) - 1:
            del members["COUNT"]
        base = "IntFlag" if "ALL" in members else "IntEnum"
        lines = [f"    {member} = {value}" for member, value in members.items()]
        self._blocks.append("\n".join(["", f"class {python_name(name)}({base}):", *lines, ""]))

    def _struct(self, name: str, node: c_ast.Struct) -> None:
        fields = []
        for field in node.decls:
            if not isinstance(field, c_ast.Decl) or field.bitsize:
                raise refuse(field, f"a field of {name} that is no plain one")
            fields.append(f'        ("{field.name}", {self._type(field.type)}),')
        sized = node.decls[0].name == SIZE_FIELD
        base = "SizedStructure" if sized else "Structure"
        head = ["", f"class {python_name(name)}({base}):", "    _fields_ = ["]
        self._blocks.append("\n".join([*head, *fields, "    ]", ""]))
        self._structs.add(name)

    def _function(self, node: c_ast.Decl) -> None:
        arguments = [self._type(parameter.type) for parameter in node.type.args.params]
        if arguments == ["None"]:  # (void)
            arguments = []
        listed = ", ".join(arguments) + ("," if len(arguments) == 1 else "")
        self._prototypes.append(f'"{node.name}": ({self._type(node.type.type)}, ({listed})),')

    def _type(self, node: c_ast.Node) -> str:
        """The ctypes expression of a type."""
        if isinstance(node, c_ast.ArrayDecl):
            return f"{self._type(node.type)} * {self._length(node)}"
        if isinstance(node, c_ast.PtrDecl):
            return self._pointer(node.type)
        if isinstance(node, c_ast.TypeDecl) and isinstance(node.type, c_ast.IdentifierType):
            (name,) = node.type.names
            if name in NUMBERS:
                return NUMBERS[name]
            if name in self._structs:
                return python_name(name)
            if name in self._enums:
                return "c_int"
            if name == "void":
                return "None"
        raise refuse(node, "a type that is not known")

    def _pointer(self, target: c_ast.Node) -> str:
        if isinstance(target, c_ast.TypeDecl) and isinstance(target.type, c_ast.IdentifierType):
            (name,) = target.type.names
            if name == "char":
                return "c_char_p"
            if name == "void" or name in self._handles:
                return "c_void_p"
        return f"POINTER({self._type(target)})"

    def _length(self, node: c_ast.ArrayDecl) -> int:
        if isinstance(node.dim, c_ast.Constant):
            return int(node.dim.value)
        values = {name: value for enum in self._enums.values() for name, value in enum.items()}
        if isinstance(node.dim, c_ast.ID) and node.dim.name in values:
            return values[node.dim.name]
        raise refuse(node, "an array without a constant length")


def module_text() -> str:
    """What addon/abi.py must hold, but for the layout that ruff gives it."""
    return Generator(HEADER.read_text()).text
