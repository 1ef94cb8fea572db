# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the reference of a scene, which `./dev bench` holds every method against.

The method is unbiased, and nothing is clamped. What is rendered is kept in build/bench/references
in parts, each with a seed of its own: another run of the same scene and method adds to them, until
they have so many seconds of rendering together. The reference is the mean of all; its variance,
that of rounding to half floats included, is estimated from how they differ, of fewer than four
from their samples. With --add they join the reference that is stored, whichever program and method
rendered that: light tracing (LT) is the cheapest where the camera sees caustics directly, and
counts for next to nothing elsewhere. With --window they are of some pixels alone, in which they
take the place of the stored ones: for those few whose light is hardly ever found. What is added to
the whole picture later leaves such windows as they are.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import sys
import time
from pathlib import Path

import numpy as np

from tests.images import _reference
from tests.images._reference import Reference
from tests.instruments.bench import _children, _metrics, _program, _scenes, _store
from tests.instruments.bench._children import Progress
from tools.common import BUILD, ROOT, DevError

FOLDER = BUILD / "bench" / "references"
LONG_SIDE = 256  # pixels
# Into how many parts rendering is cut, of which an interrupt can lose one, and the least seconds of
# a part. Its samples are stratified: a long one is better than two of half the length. The few
# pixels of a window have many samples soon.
PARTS, PART_SECONDS, WINDOW_PART_SECONDS = 8, 60.0, 5.0
LEAST_PARTS = 4  # that tell their variance
# What is farther from the stored one than so many times the variance of both is not added, which is
# worth a word from this share on.
LEAST_SHARE, MOST_APART = 0.05, 1.4
FIRST_SEED = 500_000  # far from those of what is measured
OVERHEAD = 5.0  # s of a child beside rendering
PATH_TRACED = ("cornell",)  # where path tracing converges; elsewhere the manifold and light paths
METHODS = ("PT", "LT", "SMS_UNBIASED", "SHEETS")
SCRIPT = "_reference_job.py"
SCRIPTS = (  # what renders a part
    _children.HERE / SCRIPT,
    _children.HERE / "_image_job.py",
    ROOT / "tests" / "images" / "_render.py",
)


Window = tuple[int, int, int, int]  # left, bottom, width, height


class Parts:
    """What was rendered so far: moments of all samples."""

    def __init__(self, folder: Path, first_seed: int = FIRST_SEED):
        self.folder = folder
        self.first_seed = first_seed
        self.reports = [json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))]

    @property
    def seconds(self) -> float:
        return sum(report["seconds"] for report in self.reports)

    def next_seed(self) -> int:
        return max((report["seed"] + 1 for report in self.reports), default=self.first_seed)

    def merged(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]:
        """Mean, variance of the mean, caustics, light paths' share of them, samples.

        Samples of a pixel are stratified, so that their mean is better than their own variance
        tells, on soft shadows by ten times. Parts are independent of each other.
        """
        count, mean, within, between, caustics, direct = 0, 0.0, 0.0, 0.0, 0.0, 0.0
        for report in self.reports:
            with np.load(self.folder / f"{report['seed']}.npz") as part:
                samples = report["samples"]
                total = count + samples
                delta = part["mean"] - mean
                within += part["variance"] * samples * (samples - 1.0)
                between += delta**2 * (count * samples / total)
                mean += delta * (samples / total)
                caustics += (part["caustics"] - caustics) * (samples / total)
                direct += part["direct"] / len(self.reports)
                count = total
        if len(self.reports) >= LEAST_PARTS:
            variance = between / (count * (len(self.reports) - 1.0))
        else:
            variance = (within + between) / (count * (count - 1.0))
        return mean, variance, caustics, direct, count


def render_part(blend: Path, job: dict, parts: Parts) -> None:
    """Adds one part to the folder."""
    seed = parts.next_seed()
    image = parts.folder / f"{seed}.npz"
    run = _children.run(
        f"part-{seed}",
        "specula in bpy",
        SCRIPT,
        job | {"scene": str(blend), "seed": seed, "image": str(image)},
        parts.folder,
        _children.CHILD_SECONDS + 2.0 * job["seconds"],
    )
    report = run.report | {"seed": seed}
    path = parts.folder / f"{seed}.json"
    fresh = path.with_suffix(".new")
    fresh.write_text(json.dumps(report))
    fresh.replace(path)  # only what is complete counts
    parts.reports.append(report)


def check_worth(path: Path, digest: str, seconds: float) -> None:
    """Raises DevError if `path` is the same scene's and took longer: an hour of rendering must not
    make way for a minute."""
    if not path.is_file():
        return
    stored = _reference.read(path).about
    if stored.get("sceneDigest") == digest and float(stored.get("seconds", 0.0)) > seconds:
        raise DevError(
            f"{path} was rendered for {stored['seconds']} s, more than {seconds:g} s: "
            "add to it (--add), name another file (--out), or remove it"
        )


def stored_reference(path: Path, digest: str, size: tuple[int, int]) -> Reference:
    """The one that parts are to be added to: of the scene with this digest, at this size."""
    if not path.is_file():
        raise DevError(f"--add: there is no {path}")
    stored = _reference.read(path)
    height, width = stored.mean.shape[:2]
    if stored.about.get("sceneDigest") != digest:
        raise DevError(f"--add {path}: the scene has changed since")
    if (width, height) != size or stored.caustics is None:
        raise DevError(f"--add {path}: {width}x{height} pixels, or no layer of caustics")
    return stored


def joined(stored: Reference, merged: tuple) -> tuple:
    """As `Parts.merged`, with a stored reference, whose masks stay as they are.

    Each counts by the inverse of its variance, of which there is one where the camera sees caustics
    directly and one elsewhere, so that light tracing may help the first alone: by a pixel's own it
    would count the more the fewer bright samples it has met there. Where the two differ by more
    than their errors tell, what is stored stays, as it does in windows.
    """
    mean, variance, _, _, count = merged
    share = np.zeros((*mean.shape[:2], 1))  # the new one's
    direct = stored.direct if stored.direct is not None else np.zeros(mean.shape[:2], bool)
    free = np.ones(mean.shape[:2], bool)
    for window in windows_of(stored):
        free[pixels_of(window)] = False
    refused = []
    for name, region in (("seen directly", direct & free), ("elsewhere", ~direct & free)):
        if not region.any():
            continue
        old = _metrics.trimmed_mean(stored.variance[region])
        new = _metrics.trimmed_mean(variance[region])
        part = old / (old + new)
        apart = _metrics.trimmed_mean(((mean - stored.mean) ** 2)[region]) / (old + new)
        if apart <= MOST_APART:
            share[region] = part
        elif part > LEAST_SHARE:
            refused.append(
                f"{name} squares of the differences from the stored one are {apart:.2f} times what "
                "both errors tell: one of them misses rare light"
            )
    if share.max() <= (LEAST_SHARE if refused else 0.0):
        raise DevError("; ".join(refused) or "nothing of it would count")
    for line in refused:
        print(f"left as it is: {line}")
    return (
        (1.0 - share) * stored.mean + share * mean,
        (1.0 - share) ** 2 * stored.variance + share**2 * variance,
        stored.caustics,
        direct,
        stored.samples + count,
    )


def replaced(stored: Reference, merged: tuple, window: Window) -> tuple:
    """As `Parts.merged`, of a stored reference with other pixels in a window.

    They are chosen by how the stored ones look, which would weigh them: none of those is kept.
    Raises DevError if the window has more noise than what is stored.
    """
    pixels = pixels_of(window)
    mean, variance = stored.mean.copy(), stored.variance.copy()
    before, after = variance[pixels].mean(), merged[1].mean()
    if after > before:
        raise DevError(
            f"--window: mean squared error {after:.3g}, stored is {before:.3g}: render it longer"
        )
    mean[pixels], variance[pixels] = merged[:2]
    return mean, variance, stored.caustics, stored.direct, stored.samples


def write(
    path: Path,
    about: dict[str, str],
    parts: Parts,
    stored: Reference | None,
    window: Window | None = None,
) -> None:
    """The EXR, and a line on how good it is."""
    merged, seeds, seconds = parts.merged(), [r["seed"] for r in parts.reports], parts.seconds
    seen_directly = _metrics.caustics_mask(merged[0], merged[3])
    if stored is not None:
        windows = [stored.about["windows"]] if "windows" in stored.about else []
        if window:
            windows.append("{},{},{}x{}: {}".format(*window, merged[4]))
            merged = replaced(stored, merged, window)
        else:
            merged = joined(stored, merged)
        if windows:
            about = about | {"windows": "; ".join(windows)}
        seen_directly = merged[3]
        seeds = [*seeds_of(stored), *seeds]
        seconds += float(stored.about["seconds"])
        methods = [*stored.about["method"].split(), about["method"]]
        about = about | {"method": " ".join(dict.fromkeys(methods))}
    mean, variance, caustics, _, samples = merged
    about = about | {
        "samples": str(samples),
        "seeds": " ".join(map(str, seeds)),
        "seconds": f"{seconds:.0f}",
        "date": time.strftime("%Y-%m-%d"),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        _reference.write(path, mean, variance, about, caustics, seen_directly)
    except ValueError as error:  # a sun that the camera sees, say; the parts stay
        raise DevError(str(error)) from error
    stored = _reference.read(path)
    relative = np.sqrt(stored.variance.mean() / (stored.mean**2).mean())
    print(
        f"{path}: {path.stat().st_size} bytes, {samples} samples per pixel in "
        f"{seconds:.0f} s, mean squared error {stored.variance.mean():.3g} "
        f"(root: {relative:.2%} of the picture's root mean square)"
    )


def seeds_of(stored: Reference) -> list[int]:
    return [int(seed) for seed in stored.about["seeds"].split()]


def windows_of(stored: Reference) -> list[Window]:
    """As `write` notes them, such as `124,176,3x3: 5000`, the last being the samples per pixel."""
    notes = stored.about.get("windows", "")
    found = re.findall(r"(\d+),(\d+),(\d+)x(\d+): \d+", notes)
    return [tuple(map(int, numbers)) for numbers in found]


def pixels_of(window: Window) -> tuple[slice, slice]:
    left, bottom, width, height = window
    return np.s_[bottom : bottom + height, left : left + width]


def image_size(text: str, blend: Path) -> tuple[int, int]:
    """Of `--size WxH`, else of the scene, scaled to LONG_SIDE."""
    if text:
        found = re.fullmatch(r"([1-9]\d*)x([1-9]\d*)", text)
        if not found:
            raise DevError(f"--size {text}: not of the form 320x200")
        return int(found[1]), int(found[2])
    report = _children.run("size", "bpy", "_size_job.py", {"scene": str(blend)}, FOLDER).report
    width, height = report["size"]
    scale = LONG_SIDE / max(width, height)
    return max(1, round(width * scale)), max(1, round(height * scale))


def window_edges(window: Window, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Left, bottom, right and top of a window within the picture."""
    left, bottom, width, height = window
    right, top = left + width, bottom + height
    if not (0 <= left < right <= size[0] and 0 <= bottom < top <= size[1]):
        raise DevError(f"--window {window}: not within {size[0]}x{size[1]} pixels")
    return left, bottom, right, top


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench reference",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", help="a name of blend_scenes/, or a .blend file")
    parser.add_argument(
        "--seconds",
        type=float,
        default=600.0,
        help="of rendering, with --add beside what is stored",
    )
    parser.add_argument(
        "--method", choices=METHODS, help=f"default: PT for {', '.join(PATH_TRACED)}, else SHEETS"
    )
    parser.add_argument("--size", default="", metavar="WxH", help="pixels (long side 256)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--add", action="store_true", help="to the stored one")
    parser.add_argument(
        "--window",
        type=int,
        nargs=4,
        metavar=("LEFT", "BOTTOM", "WIDTH", "HEIGHT"),
        help="with --add: pixels that take the stored ones' place",
    )
    parser.add_argument(
        "--out", type=Path, metavar="EXR", help="(tests/instruments/bench/references)"
    )
    args = parser.parse_args()
    if args.seconds <= 0.0:
        parser.error("--seconds must be positive")
    if args.window and not args.add:
        parser.error("--window needs --add")
    return args


def main() -> int:
    args = arguments()
    given = Path(args.scene)
    blend = given if given.suffix == ".blend" else _scenes.BLENDS / f"{args.scene}.blend"
    if not blend.is_file():
        raise DevError(f"there is no {blend}")
    blend = blend.resolve()
    if args.out and args.out.suffix != ".exr":
        raise DevError(f"--out {args.out}: a reference is an .exr file")
    if not args.out and blend.parent != _scenes.BLENDS.resolve():
        raise DevError(f"{blend} is no scene of blend_scenes/: name the file to write (--out EXR)")
    method = args.method or ("PT" if blend.stem in PATH_TRACED else "SHEETS")
    FOLDER.mkdir(parents=True, exist_ok=True)
    _program.freeze_library("reference")
    size = image_size(args.size, blend)
    digest = hashlib.sha256(blend.read_bytes()).hexdigest()
    about = {"scene": blend.stem, "sceneDigest": digest, "method": method}
    path = args.out or _scenes.REFERENCES / f"{blend.stem}.exr"
    stored = stored_reference(path, digest, size) if args.add else None
    first_seed = max(seeds_of(stored)) + 1 if stored else FIRST_SEED
    program = _store.specula_digest(SCRIPTS)[:8]  # a wrong estimator must not leave its parts
    name = f"{blend.stem}-{method.lower()}-{size[0]}x{size[1]}-{digest[:12]}-{program}"
    if args.window:
        left, bottom, right, top = window_edges(args.window, size)
        name += f"-{left}-{bottom}-{right}-{top}"
    folder = FOLDER / f"{name}-{first_seed}"
    folder.mkdir(exist_ok=True)
    parts = Parts(folder, first_seed)
    if not args.add:  # the same again is no worse
        check_worth(path, digest, max(args.seconds, round(parts.seconds)))
    job = {"size": size, "method": method, "threads": args.threads, "window": args.window}
    todo = args.seconds - parts.seconds
    least = WINDOW_PART_SECONDS if args.window else PART_SECONDS
    length = max(args.seconds / PARTS, least)
    progress = Progress("reference", [todo * (1.0 + OVERHEAD / length)])
    while (left := args.seconds - parts.seconds) > 0.05 * length or not parts.reports:
        progress.show(f"{blend.stem}, {method}, {parts.seconds:.0f} of {args.seconds:.0f} s")
        before = parts.seconds
        # The last two share what is left: a short part costs as much beside rendering.
        seconds = left / 2.0 if length < left < 1.5 * length else left
        render_part(blend, job | {"seconds": min(length, seconds)}, parts)
        progress.advance((parts.seconds - before) * (1.0 + OVERHEAD / length))
    progress.clear()
    write(path, about, parts, stored, args.window)
    return 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
