# SPDX-License-Identifier: GPL-3.0-or-later
from specula import abi, native
from specula.statistics import Statistics


def statistics(**render):
    stats = Statistics(
        "Scene", "Layer", "1.2.3", "SMS_UNBIASED", "Automatic (SMS Unbiased)", 16, 10
    )
    stats.scene_stats = native.struct_values(abi.SceneStats(casters=1, receivers=2))
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
    assert rows["Rays"] == "3,000 (1.5e+03/s)"
    assert "40.0% found a path, 6.0 iterations" in rows["Walks"]
    assert rows["Trials"].startswith("3.0 on average")
    assert rows["Possible loss"].startswith("2.000% of the manifold's light, 0 estimates")


def test_wording():
    rows = dict(statistics(nan_samples=1).rows())
    assert rows["Method"] == "Automatic (SMS Unbiased)"
    assert rows["Caustics"] == "1 caster, 2 receivers"
    assert rows["Dropped"] == "1 sample not finite, 0 triangles of zero area"
    rows = dict(statistics(lost_rays=2).rows())
    assert rows["Dropped"].endswith("0 triangles of zero area, 2 rays not cast")


def test_the_first_sample_of_the_whole_picture_is_told():
    stats = statistics()
    time = dict(stats.rows())["Time"]
    assert time.endswith("2.00 s render, 0.00 s of it preparation, not every pixel has a sample")
    stats = statistics(first_sample_seconds=0.31, stage_seconds=(0, 0.1, 0.15, 0, 0, 0))
    time = dict(stats.rows())["Time"]
    assert time.endswith("2.00 s render, 0.25 s of it preparation, first sample at 0.3 s")
    assert stats.stamp()["specula.render.first_sample_seconds"] == "0.31"


def test_uneven_samples_are_told():
    assert dict(statistics(samples=160).rows())["Samples per pixel"] == "16"
    uneven = dict(statistics(samples=275).rows())["Samples per pixel"]
    assert uneven == "27.5 on average, 16 at least"


def test_lines_on_walks_are_there_if_there_were_walks():
    assert {"Walks", "Trials", "Possible loss"}.isdisjoint(dict(statistics().rows()))
    labels = set(dict(statistics(walks=3).rows()))  # of the biased method
    assert "Walks" in labels
    assert {"Trials", "Possible loss"}.isdisjoint(labels)


def test_the_line_on_chain_seeds_is_there_if_there_were_any():
    counts = {"estimates": 200, "walks": 3, "missed_energy": 0.5, "manifold_energy": 20.0}
    assert "Chain seeds" not in dict(statistics(**counts).rows())
    chain_seeds = dict(statistics(**counts, chain_seeds=300, seeded_chains=50).rows())[
        "Chain seeds"
    ]
    text = "1.5 an estimate, to 0.25 chains; without them 2.500% of the manifold's light was found"
    assert chain_seeds == text


def test_the_line_on_light_paths_is_there_if_there_were_any():
    assert "Light paths" not in dict(statistics(walks=3).rows())
    rows = dict(statistics(light_paths=4096, splats=1).rows())
    assert rows["Light paths"] == "4,096, 1 splat in the picture"
    assert "Light paths" in dict(statistics(light_paths=9).rows())  # that all went astray


def test_the_line_on_glints_is_there_if_there_were_any():
    assert "Glints" not in dict(statistics(walks=3).rows())
    counts = {"glint_estimates": 1000, "glint_nodes": 300000, "glint_points": 8200}
    text = "1,000 estimates, 300 parts of maps each, 8.2 points, 3.1 MB"
    assert dict(statistics(**counts, glint_bytes=3_100_000).rows())["Glints"] == text
    capped = dict(statistics(**counts, glint_bytes=3_100_000, glint_capped=7).rows())["Glints"]
    assert capped == f"{text}, 7 stopped at the limit of trials"


def test_stamp_holds_every_number_of_the_core():
    stamp = statistics(rays=7).stamp()
    assert stamp["specula.render.rays"] == "7"
    assert stamp["specula.samples_done"] == "16"
    assert stamp["specula.method"] == "SMS_UNBIASED"
    assert {f"specula.render.{name}" for name, *_ in abi.RenderStats._fields_[1:]} <= set(stamp)
    assert {f"specula.scene.{name}" for name, *_ in abi.SceneStats._fields_[1:]} <= set(stamp)
