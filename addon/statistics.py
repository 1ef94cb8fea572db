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
    method: str = ""  # identifier of the method that rendered
    method_label: str = ""  # what the user chose, as the interface calls it
    samples_done: int = 0  # of the pixel that has the fewest
    pixels: int = 1
    export_seconds: float = 0.0
    render_seconds: float = 0.0
    scene_stats: dict = field(default_factory=dict)  # spc_scene_stats
    render_stats: dict = field(default_factory=dict)  # spc_render_stats
    report: list[str] = field(default_factory=list)  # of casters and fallbacks
    warnings: list[str] = field(default_factory=list)
    metadata: dict[str, str] = field(default_factory=dict)  # further ones of the image

    @property
    def first_sample_seconds(self) -> float | None:
        """Of render_seconds, until every pixel had a sample; None if one never had."""
        return self.render_stats["first_sample_seconds"] or None

    def rows(self) -> list[tuple[str, str]]:
        """Label and value of each line; those on walks and light paths only if there were any."""
        scene, render = self.scene_stats, self.render_stats
        rows = [
            ("Version", self.version),
            ("Method", self.method_label),
            ("Samples per pixel", self._samples()),
            ("Time", self._times()),
            (
                "Scene",
                f"{_count(scene['triangles'], 'triangle')}, "
                f"{_count(scene['instances'], 'instance')}, "
                f"{_count(scene['lights'], 'light')}, {scene['memory_bytes'] / 1e6:.1f} MB",
            ),
            (
                "Caustics",
                f"{_count(scene['casters'], 'caster')}, {_count(scene['receivers'], 'receiver')}",
            ),
            ("Rays", f"{render['rays']:,} ({_per(render['rays'], self.render_seconds):.3g}/s)"),
        ]
        if render["walks"]:
            rows.append(("Walks", self._walks()))
        if render["chain_seeds"]:
            rows.append(("Chain seeds", self._chain_seeds()))
        if render["light_paths"]:
            rows.append(("Light paths", self._light_paths()))
        if render["glint_estimates"]:
            rows.append(("Glints", self._glints()))
        if render["trial_estimates"]:
            rows += [("Trials", self._trials()), ("Possible loss", self._possible_loss())]
        return [*rows, ("Dropped", self._dropped())]

    def _walks(self) -> str:
        render = self.render_stats
        return (
            f"{render['walks']:,} for {_count(render['estimates'], 'estimate')}, "
            f"{_per(render['walks_converged'], render['walks']):.1%} found a path, "
            f"{_per(render['iterations'], render['walks']):.1f} iterations each"
        )

    def _chain_seeds(self) -> str:
        """What light sheets and camera chains know beforehand."""
        render = self.render_stats
        return (
            f"{_per(render['chain_seeds'], render['estimates']):.2g} an estimate, to "
            f"{_per(render['seeded_chains'], render['estimates']):.2g} chains; without them "
            f"{_per(render['missed_energy'], render['manifold_energy']):.3%} of the manifold's "
            "light was found"
        )

    def _light_paths(self) -> str:
        render = self.render_stats
        return f"{render['light_paths']:,}, {_count(render['splats'], 'splat')} in the picture"

    def _glints(self) -> str:
        render = self.render_stats
        estimates, capped = render["glint_estimates"], render["glint_capped"]
        return (
            f"{_count(estimates, 'estimate')}, "
            f"{_per(render['glint_nodes'], estimates):.0f} parts of maps each, "
            f"{_per(render['glint_points'], estimates):.1f} points, "
            f"{render['glint_bytes'] / 1e6:.1f} MB"
            + (f", {capped:,} stopped at the limit of trials" if capped else "")
        )

    def _trials(self) -> str:
        render = self.render_stats
        mean = _per(render["trials"], render["trial_estimates"])
        return f"{mean:.1f} on average, {render['max_trials']:,} at most"

    def _possible_loss(self) -> str:
        """Where the unbiased method stopped counting its trials, a caustic may be too dark."""
        render = self.render_stats
        share = _per(render["capped_energy"], render["manifold_energy"])
        return (
            f"{share:.3%} of the manifold's light, "
            f"{_count(render['capped_estimates'], 'estimate')} stopped at the limit of trials"
        )

    def _samples(self) -> str:
        """Of all pixels; a time limit may leave some with fewer than others."""
        mean = self.render_stats["samples"] / self.pixels
        if mean == self.samples_done:
            return str(self.samples_done)
        return f"{mean:.1f} on average, {self.samples_done} at least"

    def _times(self) -> str:
        commit = self.scene_stats["commit_seconds"]
        prepared, first = sum(self.render_stats["stage_seconds"][:-1]), self.first_sample_seconds
        return (
            f"{self.export_seconds:.2f} s export, {commit:.2f} s commit, "
            f"{self.render_seconds:.2f} s render, {prepared:.2f} s of it preparation, "
            + (
                "not every pixel has a sample"
                if first is None
                else f"first sample at {first:.1f} s"
            )
        )

    def _dropped(self) -> str:
        text = (
            f"{_count(self.render_stats['nan_samples'], 'sample')} not finite, "
            f"{_count(self.scene_stats['dropped_triangles'], 'triangle')} of zero area"
        )
        lost_rays = self.render_stats["lost_rays"]
        return text if lost_rays == 0 else f"{text}, {_count(lost_rays, 'ray')} not cast"

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


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _per(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator else 0.0


# Of the last render of each (scene, view layer) by name; shown in a panel.
last: dict[tuple[str, str], Statistics] = {}
