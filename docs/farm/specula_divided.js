// SPDX-License-Identifier: GPL-3.0-or-later
// A job type of Flamenco 3: each frame's samples are divided among tasks, then merged.

const JOB_TYPE = {
    label: "Specula, samples divided",
    settings: [
        { key: "frames", type: "string", required: true, eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          description: "Frames, such as 1-10,14" },
        { key: "samples", type: "int32", required: true, default: 256,
          description: "Samples of each pixel, as the scene has them" },
        { key: "parts", type: "int32", required: true, default: 4,
          description: "Parts into which the samples of a frame are divided" },
        { key: "out", type: "string", subtype: "dir_path", required: true, visible: "submission",
          description: "Folder for parts and pictures, which all workers see" },
        { key: "addons", type: "string", subtype: "dir_path", required: true,
          description: "Folder that holds the addon's folder specula" },
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "The file to render" },
    ],
};

function rangeOf(part, settings) {
    const at = (i) => Math.floor((i * settings.samples) / settings.parts);
    return { begin: at(part), end: at(part + 1) };
}

function renderTask(settings, frame, part) {
    const { begin, end } = rangeOf(part, settings);
    const task = author.Task(`frame ${frame}, samples ${begin}:${end}`, "blender");
    task.addCommand(author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: settings.blendfile,
        args: [
            "--engine", "SPECULA",
            "--render-output", `${settings.out}/preview_#####_${begin}`,
            "--render-frame", String(frame),
            "--",
            "--specula-part", `${settings.out}/{frame}_{layer}_${begin}.part`,
            "--specula-samples", `${begin}:${end}`,
        ],
    }));
    return task;
}

function mergeTask(settings, frame) {
    const name = `${settings.out}/${String(frame).padStart(4, "0")}`;
    const script =
        `for part in "${name}"_*_0.part; do layer="\${part%_0.part}"; ` +
        `PYTHONPATH="${settings.addons}" python3 -m specula.merge "$layer"_*.part -o "$layer.exr" || exit; done`;
    const task = author.Task(`merge frame ${frame}`, "misc");
    task.addCommand(author.Command("exec", { exe: "bash", args: ["-c", script] }));
    return task;
}

function compileJob(job) {
    for (const chunk of frameChunker(job.settings.frames, 1)) {
        const merge = mergeTask(job.settings, Number(chunk));
        for (let part = 0; part < job.settings.parts; part++) {
            const render = renderTask(job.settings, Number(chunk), part);
            job.addTask(render);
            merge.addDependency(render);
        }
        job.addTask(merge);
    }
}
