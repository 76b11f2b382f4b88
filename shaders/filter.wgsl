// One invocation runs one candidate (x) through one chunk of rows of one trajectory (y: a dispatch runs as many
// trajectories as fit its record).
//
// This is the skeleton: entry point, bindings, time loop, carried state, blocked sums. The lines that begin with `//#`
// are replaced by what the traced program needs (src/evaluate/gpu/shader.rs); `kfgpu shader PROBLEM` prints the result.
// WGSL may reassociate, fuse and assume that there is no NaN, so nothing here compensates sums or signals by NaN.

//# types

// The same layouts as `Header` and `Entry` in src/evaluate/gpu/layout.rs, which a test compares with naga's.
struct Dispatch {
    candidates: u32, // in this part of the population
    stride: u32,     // candidates a row of every structure-of-arrays buffer
    chunk: u32,      // the first of its chunks
    reserved: u32,
}

struct Chunk {
    record: u32,  // pack of the dispatch's record where its rows begin
    rows: u32,    // rows of the log
    first: u32,   // 1 in the first chunk of a trajectory
    last: u32,    // 1 in the last
    initial: u32, // row of `prologue` where this trajectory's initial states begin
    totals: u32,  // row of `totals` where this chunk's begin
    reserved_a: u32,
    reserved_b: u32,
    starts: array<Pack, STARTS>, // initial states that are the same for every candidate
}

@group(0) @binding(0) var<uniform> record: array<Pack, RECORD>;
@group(0) @binding(1) var<uniform> part: Dispatch;
@group(0) @binding(2) var<storage, read> prologue: array<Real>;
@group(0) @binding(3) var<storage, read_write> carried: array<Real>;
@group(0) @binding(4) var<storage, read_write> totals: array<Real>;
@group(0) @binding(5) var<storage, read> chunks: array<Chunk>;

//# functions

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let candidate = id.x;
    if (candidate >= part.candidates) {
        return;
    }
    let stride = part.stride;
    let chunk = part.chunk + id.y;
    let begin = chunks[chunk].record;
    let rows = chunks[chunk].rows;

    // Invariants, and what is carried from row to row.
    //# invariants
    //# carried
    if (chunks[chunk].first == 1u) {
        //# start
    } else {
        //# load
    }

    // Sums are moved every 32 rows, products split into mantissa and exponent every few: f32 keeps its digits.
    //# sums
    for (var row = 0u; row < rows; row = row + 1u) {
        //# record
        //# step
        if ((row & SPLIT) == SPLIT) {
            //# split
        }
        if ((row & 31u) == 31u) {
            //# move
        }
    }
    //# split
    //# move

    // Only one trajectory of a dispatch may go on in the next: what it carries has one place.
    if (chunks[chunk].last == 0u) {
        //# keep
    }
    let total = chunks[chunk].totals;
    //# store
}
