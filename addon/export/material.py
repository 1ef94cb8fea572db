# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as graphs of the core's nodes, driven by the tables that `nodes.py` joins."""

from __future__ import annotations

from dataclasses import replace
from operator import attrgetter

from . import compat, graph, ignored
from .desc import Glints, LinkDesc, MaterialDesc, NodeDesc
from .image import Images
from .log import ExportLog
from .node_kind import NodeKind
from .nodes import NODES
from .sky import Sky, add_sun

DEFAULT_COLOR = (0.8, 0.8, 0.8, 1.0)
MAGENTA = (1.0, 0.0, 1.0, 1.0)
ONE = (1.0, 1.0, 1.0, 1.0)


def plain_material(name: str, kind: str, output: str, color, **scalars: float) -> MaterialDesc:
    """A material of one node of `kind` with a Color and scalar inputs."""
    inputs = {"Color": tuple(color), **{key: (v, v, v, 1.0) for key, v in scalars.items()}}
    return MaterialDesc(
        name,
        [NodeDesc("Output", "output"), NodeDesc(name, kind, inputs=inputs)],
        [LinkDesc(1, output, 0, "Surface")],
    )


def default_material() -> MaterialDesc:
    """What an empty material slot looks like in Cycles."""
    if compat.is_principled_by_default():
        shader = NodeDesc("(no material)", "bsdf_principled", options={"distribution": "MULTI_GGX"})
        links = [LinkDesc(1, "BSDF", 0, "Surface")]
        return MaterialDesc(shader.name, [NodeDesc("Output", "output"), shader], links)
    return plain_material("(no material)", "bsdf_diffuse", "BSDF", DEFAULT_COLOR)


def export_material(
    material, images: Images, log: ExportLog, aovs: frozenset[str] = frozenset()
) -> MaterialDesc:
    """The node graph of `material`'s surface and volume, with what writes `aovs`."""
    ignored.warn_of_material(material, log)
    if not compat.uses_nodes(material):
        color = (*material.diffuse_color[:3], 1.0)
        desc = plain_material(material.name, "bsdf_diffuse", "BSDF", color)
        desc.pass_index = material.pass_index
        return desc
    converter = Converter(f"material {material.name}", images, log)
    converter.material_index = material.pass_index
    desc = converter.convert(material.name, material.node_tree)
    converter.add_aovs(desc, material.node_tree, aovs)
    converter.draw_suns()
    make_emission(desc)
    desc.glints = Glints[material.specula.glints]
    desc.displacement = compat.displacement(material)
    desc.bump_correction = compat.bump_correction(material)
    desc.pass_index = material.pass_index
    return desc


def make_emission(desc: MaterialDesc) -> None:
    """A Background shader on a surface is an emission."""
    backgrounds = {i for i, node in enumerate(desc.nodes) if node.kind == "background"}
    for index in backgrounds:
        desc.nodes[index].kind = "emission"
    desc.links = [
        replace(link, from_socket="Emission") if link.from_node in backgrounds else link
        for link in desc.links
    ]


class Converter:
    """Converts one node tree; only nodes that its active output reaches are visited."""

    def __init__(self, owner: str, images: Images, log: ExportLog):
        self.owner = owner
        self.images = images
        self.log = log
        self.skies: list[tuple[NodeDesc, Sky]] = []  # whose suns are not in their images
        self.material_index = 0
        self._in_volume = False  # the walk is behind the output's Volume
        self._nodes: list[NodeDesc] = []
        self._links: list[LinkDesc] = []
        self._indices: dict[tuple, int] = {}

    def convert(self, name: str, tree) -> MaterialDesc:
        """The graph behind the output that Cycles would use; without one it is an empty output."""
        self._nodes.append(NodeDesc("Output", "output"))
        output = tree.get_output_node("CYCLES")
        if output:
            self._input(0, output, "Surface", path=())
            of_material = output.bl_idname == "ShaderNodeOutputMaterial"
            if of_material:
                self._input(0, output, "Displacement", path=())
                self._volume(output)
            volume = None if of_material else compat.find_input(output, "Volume")
            if volume and volume.is_linked:
                self.warn(output, "Volume is not supported and has no effect")
        return MaterialDesc(name, self._nodes, self._links)

    def add_aovs(self, desc: MaterialDesc, tree, wanted: frozenset[str]) -> None:
        """Adds the tree's nodes that write AOVs of these names to what `convert` gave."""
        self._in_volume = False
        if wanted:
            self._add_aovs_of(tree, wanted, ())
        desc.links = self._links

    def _add_aovs_of(self, tree, wanted: frozenset[str], path: graph.GroupPath) -> None:
        """Those of groups as well."""
        for node in tree.nodes if tree else ():
            if node.mute:
                continue
            if hasattr(node, "node_tree"):
                self._add_aovs_of(node.node_tree, wanted, (*path, node))
            name = compat.aov_name(node)
            if name in wanted:
                index = len(self._nodes)
                self._nodes.append(NodeDesc(node.name, "aov_output", options={"aov_name": name}))
                for socket in ("Color", "Value"):
                    self._input(index, node, socket, path)

    def _volume(self, output) -> None:
        """What fills the mesh. As in Cycles its surface is invisible if only that is given."""
        if not output.inputs["Volume"].is_linked:
            return
        if not output.inputs["Surface"].is_linked:
            self._nodes.append(NodeDesc("Surface", "bsdf_transparent", inputs={"Color": ONE}))
            self._links.append(LinkDesc(len(self._nodes) - 1, "BSDF", 0, "Surface"))
        self._in_volume = True
        self._input(0, output, "Volume", path=())

    def draw_suns(self) -> None:
        """Of skies whose suns are no lights."""
        for node, sky in self.skies:
            add_sun(self.images.descs[node.image].pixels, sky)

    # ---------------------------------------------------- for `adjust` functions of nodes_*.py

    def label(self, node) -> str:
        return f"{self.owner}, node {node.name}"

    def warn(self, node, message: str) -> None:
        self.log.warn(self.label(node), message)

    def set_constant(self, desc: NodeDesc, socket: str, value) -> None:
        """Gives an input a constant in place of whatever it read."""
        index = next(i for i, node in enumerate(self._nodes) if node is desc)
        self._links = [
            link for link in self._links if (link.to_node, link.to_socket) != (index, socket)
        ]
        desc.inputs[socket] = value

    # ------------------------------------------------------------------------------ the walk

    def _input(self, index: int, node, name: str, path: graph.GroupPath) -> None:
        """Links or sets input `name` of the node at `index`; without either its default holds."""
        socket = compat.find_input(node, name)
        if socket is None:
            return
        source = graph.source(socket, path)
        if isinstance(source, graph.Output):
            feeding = self._output(source, socket)
            if feeding is not None:
                self._links.append(LinkDesc(*feeding, index, name))
                return
            source = graph.constant(socket)
        if source is not None:
            self._nodes[index].inputs[name] = source.read_as(socket.type)

    def _output(self, source: graph.Output, reader) -> tuple[int, str] | None:
        """Node index and socket name for `source`; None if its value is not supported."""
        node, row = source.node, NODES.get(source.node.bl_idname)
        name = compat.output_name(source.socket, row.outputs) if row else None
        if name is not None:
            return self._node(node, row, source.path), name
        what = f"node type {node.bl_label}" if row is None else f"output {source.socket.name}"
        if reader.type == "SHADER" and self._in_volume:
            self.warn(node, f"{what} is not supported in a volume and has no effect")
            return None
        if reader.type == "SHADER":
            self.warn(node, f"{what} is not supported, shown in magenta")
            return self._magenta(node), "Emission"
        self.warn(node, f"{what} is not supported, {reader.node.name} uses its own {reader.name}")
        return None

    def _node(self, node, row: NodeKind, path: graph.GroupPath) -> int:
        """Index of the node's description, which the first visit makes with all that feeds it."""
        key = (path, node)
        if key in self._indices:
            return self._indices[key]
        index = self._indices[key] = len(self._nodes)
        desc = NodeDesc(node.name, row.kind)
        self._nodes.append(desc)
        for name in row.inputs:
            self._input(index, node, name, path)
        for path, values in row.options.items():
            desc.options[path.split(".")[-1]] = self._option(node, path, values)
        desc.options |= row.fixed_options
        for name, values in row.arrays.items():
            desc.arrays[name] = values(node)
        self._check_neutral(node, row)
        if row.adjust:
            row.adjust(self, node, desc)
        return index

    def _option(self, node, path: str, values: tuple[str, ...]) -> str:
        try:
            value = str(attrgetter(path)(node))  # of booleans, too
        except AttributeError:  # of a newer Blender
            return values[0]
        if values and value not in values and not compat.is_sharp(node):
            option = path.split(".")[-1]
            self.warn(node, f"{option} {value} is not supported, {values[0]} is used")
        return value if not values or value in values else values[0]

    def _check_neutral(self, node, row: NodeKind) -> None:
        """Warns of settings that Specula does not model."""
        for name, neutral in row.neutral_inputs.items():
            socket = compat.find_input(node, name)
            if socket and (socket.is_linked or socket.default_value != neutral):
                self.warn(node, f"{socket.name} is not supported and has no effect")
        for name, neutral in row.neutral_properties.items():
            if getattr(node, name) != neutral:
                self.warn(node, f"{name.replace('_', ' ')} is not supported and has no effect")

    def _magenta(self, node) -> int:
        inputs = {"Color": MAGENTA, "Strength": ONE}
        self._nodes.append(NodeDesc(node.name, "emission", inputs=inputs))
        return len(self._nodes) - 1
