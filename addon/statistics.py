# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render did: the same lines for the log, the image's metadata and the panel."""

from __future__ import annotations

from dataclasses import dataclass, field

STAMP_PREFIX = "specula."


@dataclass
class Statistics:
    """Of one view layer's render. Times in seconds."""

    scene: str = ""
    view_layer: str = ""
    version: str = ""
    method: str = ""
    samples_done: int = 0
    export_seconds: float = 0.0
    render_seconds: float = 0.0
    scene_stats: dict = field(default_factory=dict)  # spc_scene_stats
    render_stats: dict = field(default_factory=dict)  # spc_render_stats
    report: list[str] = field(default_factory=list)  # of casters and fallbacks
    warnings: list[str] = field(default_factory=list)

    def rows(self) -> list[tuple[str, str]]:
        """Label and value of each line."""
        scene, render = self.scene_stats, self.render_stats
        return [
            ("Version", self.version),
            ("Method", self.method),
            ("Samples per pixel", str(self.samples_done)),
            ("Time", self._times()),
            (
                "Scene",
                f"{scene['triangles']} triangles, {scene['instances']} instances, "
                f"{scene['lights']} lights, {scene['memory_bytes'] / 1e6:.1f} MB",
            ),
            ("Caustics", f"{scene['casters']} casters, {scene['receivers']} receivers"),
            ("Rays", f"{render['rays']} ({_per(render['rays'], self.render_seconds):.3g}/s)"),
            (
                "Walks",
                f"{render['walks']} for {render['estimates']} estimates, "
                f"{_per(render['walks_converged'], render['walks']):.1%} converged, "
                f"{_per(render['iterations'], render['walks']):.1f} iterations each",
            ),
            (
                "Trials",
                f"{_per(render['trials'], render['trial_estimates']):.1f} on average, "
                f"{render['max_trials']} at most, {render['capped_estimates']} estimates capped",
            ),
            (
                "Energy given up",
                f"{_per(render['capped_energy'], render['manifold_energy']):.3%} "
                "of the manifold's, at the cap of trials",
            ),
            ("Dropped", self._dropped()),
        ]

    def _times(self) -> str:
        commit = self.scene_stats["commit_seconds"]
        return (
            f"{self.export_seconds:.2f} s export, {commit:.2f} s commit, "
            f"{self.render_seconds:.2f} s render"
        )

    def _dropped(self) -> str:
        return (
            f"{self.render_stats['nan_samples']} samples that were not finite, "
            f"{self.scene_stats['dropped_triangles']} triangles of zero area"
        )

    def block(self) -> str:
        """For the log."""
        lines = [f"Specula: {self.scene}, {self.view_layer}"]
        lines += [f"  {label + ':':<19}{value}" for label, value in self.rows()]
        lines += [f"  {line}" for line in self.report]
        return "\n".join(lines)

    def stamp(self, prefix: str = STAMP_PREFIX) -> dict[str, str]:
        """Metadata fields, numbers as they came from the core."""
        fields = {
            "version": self.version,
            "method": self.method,
            "samples_done": self.samples_done,
            "export_seconds": self.export_seconds,
            "render_seconds": self.render_seconds,
            **{f"scene.{key}": value for key, value in self.scene_stats.items()},
            **{f"render.{key}": value for key, value in self.render_stats.items()},
        }
        return {prefix + key: str(value) for key, value in fields.items()}


def _per(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator else 0.0


# Of the last render of each (scene, view layer) by name; shown in a panel.
last: dict[tuple[str, str], Statistics] = {}
