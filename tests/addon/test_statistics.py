# SPDX-License-Identifier: GPL-3.0-or-later
from specula import abi, native
from specula.statistics import Statistics


def statistics(**render):
    stats = Statistics("Scene", "Layer", "1.2.3", "SMS_UNBIASED", samples_done=16)
    stats.scene_stats = native.struct_values(abi.SceneStats())
    stats.render_stats = native.struct_values(abi.RenderStats(**render))
    stats.render_seconds = 2.0
    return stats


def test_block_has_a_line_for_each_row_and_each_report():
    stats = statistics()
    stats.report = ["caster Glass: smooth"]
    lines = stats.block().splitlines()
    assert lines[0] == "Specula: Scene, Layer"
    assert lines[-1] == "  caster Glass: smooth"
    assert len(lines) == 2 + len(stats.rows())


def test_rates():
    rows = dict(
        statistics(
            rays=3000,
            walks=10,
            walks_converged=4,
            iterations=60,
            trials=9,
            trial_estimates=3,
            capped_energy=1.0,
            manifold_energy=50.0,
        ).rows()
    )
    assert rows["Rays"] == "3000 (1.5e+03/s)"
    assert "40.0% converged, 6.0 iterations" in rows["Walks"]
    assert rows["Trials"].startswith("3.0 on average")
    assert rows["Energy given up"].startswith("2.000%")


def test_stamp_holds_every_number_of_the_core():
    stamp = statistics(rays=7).stamp()
    assert stamp["specula.render.rays"] == "7"
    assert stamp["specula.samples_done"] == "16"
    assert {f"specula.render.{name}" for name, *_ in abi.RenderStats._fields_[1:]} <= set(stamp)
    assert {f"specula.scene.{name}" for name, *_ in abi.SceneStats._fields_[1:]} <= set(stamp)
