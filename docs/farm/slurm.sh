#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Divides frames and their samples among the tasks of an array job, and merges each frame.
#
# usage: slurm.sh FILE.blend FIRST_FRAME LAST_FRAME SAMPLES PARTS OUT_FOLDER
#
# BLENDER is the program (blender), PYTHON one with NumPy (python3), SPECULA_PATH a folder that holds the
# addon's folder `specula`.
set -euo pipefail
if (($# != 6)); then
    sed -n '/^# usage/s/^# //p' "$0" >&2
    exit 2
fi
file=$(realpath "$1") first=$2 last=$3 samples=$4 parts=$5
mkdir -p "$6"
out=$(realpath "$6")
blender=${BLENDER:-blender}
python=${PYTHON:-python3}
addons=${SPECULA_PATH:?a folder that holds the folder specula}

for ((frame = first; frame <= last; frame++)); do
    # Task i has the samples from i / parts to (i + 1) / parts of all.
    array=$(sbatch --parsable --requeue --job-name="specula $frame" --array="0-$((parts - 1))" \
        --output="$out/%x_%a.log" <<EOF
#!/bin/bash
begin=\$((SLURM_ARRAY_TASK_ID * $samples / $parts))
end=\$(((SLURM_ARRAY_TASK_ID + 1) * $samples / $parts))
exec "$blender" -b "$file" -E SPECULA -o "$out/preview_#####_\$begin" -f $frame -- \
    --specula-part "$out/{frame}_{layer}_\$begin.part" --specula-samples "\$begin:\$end"
EOF
    )
    sbatch --parsable --job-name="specula merge $frame" --dependency="afterok:$array" \
        --output="$out/%x.log" <<EOF
#!/bin/bash
# A picture for each view layer.
number=\$(printf %04d $frame)
for part in "$out/\${number}"_*_0.part; do
    layer=\${part%_0.part}
    PYTHONPATH="$addons" "$python" -m specula.merge "\$layer"_*.part -o "\$layer.exr" || exit
done
EOF
done
