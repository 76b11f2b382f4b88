#!/usr/bin/env bash
# Measures kfgpu on a machine with a GPU: parity first, then filter-steps a second on the adapter, on the processor
# and, where Python has it, in JAX on the same machine. Nothing is compiled here, so the machine needs no Rust:
#
#     cargo build --release --locked                          # where there is a compiler: target/release/kfgpu
#     cargo test --release --locked --test gpu --no-run       # names the test binary: target/release/deps/gpu-...
#     benches/hardware/run.sh --gpu-tests target/release/deps/gpu-...
#
# The test binary reads examples/ and tests/ at the path it was built in: copy the checkout to the same path, or link it.
#
# Vulkan is found through the environment, if it does not lie where the loader looks:
#     LD_LIBRARY_PATH=DIR      folder of libvulkan.so.1 (Debian: package libvulkan1, which can be unpacked anywhere)
#     VK_DRIVER_FILES=FILE     the driver's manifest, say .../vulkan/icd.d/nvidia_icd.json (loader 1.3.207 and later)
#     VK_ICD_FILENAMES=FILE    the same for older loaders; set both when in doubt
# `kfgpu devices` then lists the card. In a container the NVIDIA driver must be passed in with its graphics capability
# (NVIDIA_DRIVER_CAPABILITIES=all), not for compute alone, or there is no Vulkan.
#
# Options (defaults in brackets):
#     --kfgpu FILE         the command [target/release/kfgpu]
#     --gpu-tests FILE     test binary of tests/gpu; without it parity is not checked, and the results say so
#     --adapter NAME       part of the adapter's name [the best GPU; a software adapter must be named]
#     --jax FILE           a program that prints the same JSON line as `kfgpu bench --json`, called with
#                          --variant idiomatic|closed|soa --workload W --N N --dtype f32|f64; without it no JAX
#     --python FILE        Python with jax [python3]
#     --steps LIST         of parity,kfgpu,crossover,jax [all]: to spread the work over several calls on one --out
#     --workloads LIST     [A B]
#     --problems LIST      problem files whose filters are not linear, compared with the processor in the crossover step
#                          [range and bearing, several models, robust updates, a robot's ranges]
#     --sizes LIST         candidates [1024 4096 16384 65536 262144 1048576]
#     --limit SECONDS      longest time of one measurement; what takes longer is listed as missing [120]
#     --out DIR            results folder [hardware-results]: *.jsonl, parity.log, missing.txt, table.md
#
# table.md is ready to go into benches/RESULTS.md. Exit code 0: all done; 1: parity failed, and nothing was timed;
# 2: wrong use, or no adapter.
set -euo pipefail

kfgpu=target/release/kfgpu gpu_tests='' adapter='' jax='' python=python3 steps=parity,kfgpu,crossover,jax
problems='benches/workloads/range_bearing.toml examples/imm_turns.toml examples/robust_gps.toml examples/plaza2.toml'
workloads='A B' sizes='1024 4096 16384 65536 262144 1048576' limit=120 out=hardware-results
command_line="$0 $*"

fail() { echo "error: $1" >&2; exit "${2:-2}"; }

while [ $# -gt 0 ]; do
    [ $# -ge 2 ] || fail "$1 needs a value"
    case $1 in
        --kfgpu) kfgpu=$2 ;;
        --gpu-tests) gpu_tests=$2 ;;
        --adapter) adapter=$2 ;;
        --jax) jax=$2 ;;
        --python) python=$2 ;;
        --steps) steps=$2 ;;
        --workloads) workloads=$2 ;;
        --problems) problems=$2 ;;
        --sizes) sizes=$2 ;;
        --limit) limit=$2 ;;
        --out) out=$2 ;;
        *) fail "unknown option $1 (the head of $0 lists them)" ;;
    esac
    shift 2
done
[ -x "$kfgpu" ] || fail "$kfgpu is not there: build it with \`cargo build --release\`, or name it with --kfgpu"
[ -z "$gpu_tests" ] || [ -x "$gpu_tests" ] || fail "$gpu_tests is not there: \`cargo test --release --test gpu --no-run\`"
[ -z "$jax" ] || [ -f "$jax" ] || fail "$jax is not there"
# Mesa's device-select layer writes to stderr on a machine without a display.
export NODEVICE_SELECT=1
mkdir -p "$out"
touch "$out/missing.txt"
printf '%s\n' "$command_line" >>"$out/commands.txt"
on_adapter=(--device gpu)
[ -z "$adapter" ] || on_adapter+=(--adapter "$adapter")

wanted() { case ",$steps," in *",$1,"*) ;; *) return 1 ;; esac; }

# measure FILE WHAT COMMAND...: appends the JSON line that the command prints; what fails or lasts is noted as missing.
measure() {
    local file=$1 what=$2 code=0
    shift 2
    timeout "$limit" "$@" >"$out/line" 2>"$out/stderr" || code=$?
    if [ "$code" -eq 0 ]; then
        cat "$out/line" >>"$file"
        echo "ok       $what"
    else
        [ "$code" -ne 124 ] || echo "longer than $limit s" >"$out/stderr"
        echo "- $what: $(grep -v '^ *$' "$out/stderr" | tail -n 1)" | tee -a "$out/missing.txt"
    fi
}

# The adapter is there, and what is it?
"$kfgpu" bench "${on_adapter[@]}" --n 64 --t 64 --repetitions 1 --json >"$out/probe.json" 2>"$out/stderr" ||
    { cat "$out/stderr" >&2; exit 2; }
field() { sed -n "s/.*\"$1\":\"\([^\"]*\)\".*/\1/p" "$2" | head -n 1; }
device=$(field device "$out/probe.json")
name=$(field isa "$out/probe.json")
echo "$device: $name"

if wanted parity && [ -n "$gpu_tests" ]; then
    KFGPU_TEST_GPU=require "$gpu_tests" --nocapture >"$out/parity.log" 2>&1 ||
        { tail -n 40 "$out/parity.log" >&2; fail "parity failed ($out/parity.log): nothing is timed" 1; }
    grep '^test result' "$out/parity.log"
fi

threads=$(nproc)
if wanted kfgpu; then
    : >"$out/kfgpu.jsonl"
    for workload in $workloads; do for n in $sizes; do for dtype in f32 f64; do
        common=(bench --workload "$workload" --n "$n" --precision "$dtype" --budget 10 --json --quiet)
        measure "$out/kfgpu.jsonl" "kfgpu $workload $n $dtype, $device" "$kfgpu" "${common[@]}" "${on_adapter[@]}"
        measure "$out/kfgpu.jsonl" "kfgpu $workload $n $dtype, cpu" \
            "$kfgpu" "${common[@]}" --device cpu --threads "$threads"
    done; done; done
fi

if wanted crossover; then
    : >"$out/crossover.jsonl"
    for workload in $workloads; do
        compared=(bench --workload "$workload" --n "${sizes##* }" --threads "$threads" --precision f32 --budget 10)
        measure "$out/crossover.jsonl" "crossover $workload" \
            "$kfgpu" "${compared[@]}" --adapter "${adapter:-${name%% (*}}" --json --quiet
    done
    for problem in $problems; do
        compared=(bench "$problem" --n "${sizes##* }" --threads "$threads" --precision f32 --budget 10)
        measure "$out/crossover.jsonl" "crossover $problem" \
            "$kfgpu" "${compared[@]}" --adapter "${adapter:-${name%% (*}}" --json --quiet
    done
fi

if wanted jax && [ -n "$jax" ]; then
    if "$python" -c 'import jax' 2>/dev/null; then
        : >"$out/jax.jsonl"
        "$python" -c 'import jax; print("jax", jax.__version__, jax.devices())' >"$out/jax.txt" 2>/dev/null
        # Otherwise JAX takes three quarters of the card's memory at once.
        export XLA_PYTHON_CLIENT_PREALLOCATE=false
        for workload in $workloads; do for n in $sizes; do for dtype in f32 f64; do
            for variant in idiomatic closed soa; do
                measure "$out/jax.jsonl" "jax $variant $workload $n $dtype" "$python" "$jax" \
                    --variant "$variant" --workload "$workload" --N "$n" --dtype "$dtype" --budget 10
            done
        done; done; done
    else
        echo "- JAX: $python cannot import jax" | tee -a "$out/missing.txt"
    fi
fi

# One row a measurement, from the JSON lines of every step so far.
rows() {
    { cat "$out"/kfgpu.jsonl "$out"/jax.jsonl 2>/dev/null || true; } | awk '
        function text(key) { return match($0, "\"" key "\":\"[^\"]*\"") ? cut(key, 1) : "" }
        function number(key) { return match($0, "\"" key "\":[-+0-9.eE]+") ? cut(key, 0) : "" }
        function cut(key, quotes) { return substr($0, RSTART + length(key) + 3 + quotes, RLENGTH - length(key) - 3 - 2 * quotes) }
        function rate(value) { return value == "" ? "-" : sprintf("%.3g", value) }
        {
            gsub(/": /, "\":")
            program = text("peer") == "kfgpu" ? "kfgpu, " text("device") : text("peer")
            key[NR] = text("workload") " | " number("N") " | " text("dtype")
            if (program ~ /idiomatic/) idiomatic[key[NR]] = number("steps_per_s")
            who[NR] = program; seconds[NR] = number("median_s")
            whole[NR] = number("steps_per_s"); kernels[NR] = number("kernel_steps_per_s")
        }
        END {
            for (i = 1; i <= NR; i++) {
                times = key[i] in idiomatic ? sprintf("%.1f", whole[i] / idiomatic[key[i]]) : "-"
                printf "| %s | %s | %.6f | %s | %s | %s |\n",
                    key[i], who[i], seconds[i], rate(whole[i]), rate(kernels[i]), times
            }
        }' | sort -s -t '|' -k 2,2 -k 4,4 -k 3,3n
}

crossovers() {
    local pattern='s/^{"workload":"\([^"]*\)".*"threads":\([0-9]*\),"candidates":\([0-9a-z]*\),"ladder".*/'
    { cat "$out/crossover.jsonl" 2>/dev/null || true; } |
        sed -n "$pattern- Crossover on \1, f32, end to end against \2 threads: \3/p" |
        sed "s/: null\$/: none up to ${sizes##* } candidates/; s/\([0-9]\)\$/\1 candidates/"
}

# Longest of the times to assemble a shader and create its pipeline.
kernel_build() {
    { cat "$out/kfgpu.jsonl" 2>/dev/null || true; } | sed -n 's/.*"kernel_build_s":\([0-9.e-]*\).*/\1/p' | sort -g | tail -n 1
}

report() {
    echo "### $name"
    echo
    [ "$device" != "software adapter" ] || printf '**Software adapter**: a program on the processor; it says nothing of a GPU.\n\n'
    echo "- Measured on $(date -u +%Y-%m-%d): $device, $name"
    echo "- Processor: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $threads threads;" \
        "load average $(cut -d ' ' -f 1 /proc/loadavg) at the end"
    [ ! -f "$out/jax.txt" ] || echo "- $(cat "$out/jax.txt")"
    sort -u "$out/commands.txt" | sed 's/.*/- Command: `&`/'
    if [ -f "$out/parity.log" ]; then
        echo "- Parity, checked first: $(sed -n 's/^test result: \([^;]*; [^;]*\);.*/\1/p' "$out/parity.log" | tail -n 1)"
    else
        echo "- Parity was **not checked**"
    fi
    echo "- Shader and pipeline: $(kernel_build) s at most"
    crossovers
    echo
    echo "| workload | candidates | format | program | evaluation s | filter-steps/s | in kernels, steps/s | x idiomatic JAX |"
    echo "|---|---|---|---|---|---|---|---|"
    rows
    if [ -s "$out/missing.txt" ]; then printf '\nMissing:\n\n'; sort -u "$out/missing.txt"; fi
}

report >"$out/table.md"
rm -f "$out/line" "$out/stderr"
cat "$out/table.md"
