// SPDX-License-Identifier: Apache-2.0
// The contents of report.json. reports/report.cpp writes it and computes all numbers; the page only renders them.
// tests/types.spec.ts checks real reports against these types. Lanes and strata are given by their index in `lanes` and
// `strata`. A missing value is null or an empty array.

export interface Share {
  count: number;
  of: number;
  share: number;
  low: number;
  high: number;
} // low and high: Wilson's 95 % interval; six significant digits are enough; share, low and high are null if `of` is 0

export type Times = [number | null, number, number | null];

// The smallest margin (in ulps, a power of two) at or above which no error was seen; if there was no error, the
// smallest margin seen. `bound`: the 95 % upper bound of the error rate on the `above` pairs with such margins,
// 1 - 0.05^(1/n). exponent is null if errors were seen up to the largest margin, 2^largest. largest is null if no pair
// is on that side of zero.
export interface Threshold {
  exponent: number | null;
  above: number;
  bound: number;
  largest: number | null;
}

// costs.json: lane costs in nanoseconds per pair on one core, in a separate file because they depend on the machine.
// low, middle and high are the quartiles of the passes. A null group means all strata. answer: the report's answer with
// costs.
export interface Costs {
  report?: string; // the checksum of its report.json
  machine: string;
  passes: number;
  rows: { lane: number; group: number | null; pairs: number; low: number; middle: number; high: number }[];
  answer: string[];
}

export interface Errors {
  pairs: number;
  false_negative: number;
  false_positive: number;
  declined: number;
  crashed?: number; // these four only for your own code
  timed_out?: number;
  unstable?: number;
  by_convention?: number; // not the truth, but allowed by the code's convention
}
// Errors under one policy; fixed and broken are relative to the lane without a policy.
export interface PolicyErrors extends Errors {
  policy: string;
  fixed: number;
  broken: number;
}

// tune.json and pareto.json, if they are in the campaign's folder; docs/formats.md describes them.
export interface Tuned {
  epsilon?: { name: string; written: string; file: string; lines: number[]; chosen: string }; // the epsilon of a user's own code
  lane: string;
  forbid: 'false_negative' | 'false_positive' | 'any';
  max_rate: number;
  max_other: number;
  chosen: string;
  result: string;
  bound: number;
  other_bound: number;
  confirmed: PolicyErrors;
  zero_confirmed: PolicyErrors;
  dead: string[];
  scale_break: {
    up?: { log2: number; from: PolicyErrors; errors: PolicyErrors };
    down?: { log2: number; from: PolicyErrors; errors: PolicyErrors };
  };
  interactions: { first: PolicyErrors; second: PolicyErrors; together: PolicyErrors }[];
  zero: PolicyErrors;
  curves: { site: string; tolerance: 'rel' | 'abs'; points: PolicyErrors[] }[];
  sentences: string[];
}
export interface Quartiles {
  low: number;
  middle: number;
  high: number;
}
export interface Pareto {
  pairs: number;
  seed: number;
  machine: string;
  // Lanes on one core have in_cache, from_memory and one_a_call. Lanes on a device have resident, with_copies and the
  // kernels' resources.
  // failure: the smallest pair on which the lane is wrong, as input for `graze check`.
  lanes: {
    lane: string;
    errors: Errors;
    bound: number;
    in_cache?: Quartiles;
    from_memory?: Quartiles;
    one_a_call?: Quartiles;
    resident?: Quartiles;
    with_copies?: Quartiles;
    dominated: boolean;
    registers?: number;
    local_bytes?: number;
    active_threads?: number;
    failure: string | null;
  }[];
  extremes: { lane: string; extreme: string; says: string; points: ({ log2: number } & Errors)[] }[];
  sentences: string[];
}
export interface Choices {
  tuned: Tuned | null;
  pareto: Pareto | null;
  discrepancy: Discrepancy | null;
}
// How the values of lanes differ: sentences, and the page with every value.
export interface Discrepancy {
  sentences: string[];
  page: string;
}

export interface Report {
  format: 2;
  run: {
    seed: number;
    pairs: number;
    complete: boolean;
    command: string; // reproduces the whole campaign
    map_command: string; // regenerates the page from stored data: "graze report DIR"
    build: { version: string; commit: string; compiler: string; cuda: string | null; device: string | null };
    scene: string | null; // "arm.toml#0123456789abcdef"
    machine: string | null; // from timings.json only if deterministic; otherwise null
    subjects?: {
      name: string; // a subject of foreign code, as the campaign recorded it
      what: string;
      hash: string; // a hash of everything that was compiled or run
      source_hash?: string; // a hash of the source file only
      compiler?: string;
      flags?: string[];
      environment?: { [variable: string]: string }; // the variables that chose the compiler or its inputs
      contraction?: { [toolchain: string]: { [scalar: string]: { plan: string; operations: number } } };
    }[];
  };
  strata: { id: string; describes: string; pairs: number; intersects: number }[];
  lanes: {
    id: string;
    algorithm: string;
    scalar: 'f32' | 'f64';
    target: string;
    paper: string;
    evidence: string | null;
    exact: boolean;
  }[];
  answer: string[]; // sentences, the most useful first; shown if costs are unknown
  groups: { id: string; describes: string; strata: number[] }[]; // strata that are reported together; their indices
  // One row for each lane and stratum that has pairs, and one for each lane over all strata (stratum null).
  rates: {
    lane: number;
    stratum: number | null;
    false_positive: Share;
    false_negative: Share;
    wrong: Share;
    declined: number;
    differs_from_cpu: Share | null;
    stored?: number; // pairs of doubles on which the lane is wrong because float32 stores another pair
  }[];
  group_rates: { lane: number; group: number; wrong: Share; false_positive?: Share; false_negative?: Share }[];
  // Pairs of lanes of one algorithm. `differs` is the share of pairs with different verdicts; null if unknown. A null
  // stratum means all strata together, as in `rates`.
  side_by_side: {
    kind: 'cpu-nofma' | 'nofma-fma' | 'f32-f64';
    left: number;
    right: number;
    strata: { stratum: number | null; left_wrong: Share; right_wrong: Share; differs: Share | null }[];
  }[];
  toolchains?: ToolchainMap | null; // null: no toolchain ran
  // Error against margin over all strata (stratum null; margins.csv has each stratum). side: disjoint or intersecting
  // pairs. exponent e stands for margins in [2^e, 2^(e+1)) ulps; zero margins have an entry with exponent null. Buckets
  // without pairs are absent. differs: the share that differs from the lane’s cpu lane, if there is one.
  margins: {
    lane: number;
    stratum: number | null;
    points: {
      side: 'disjoint' | 'zero' | 'intersects';
      exponent: number | null;
      wrong: Share;
      differs?: Share;
    }[];
  }[];
  // For a group of strata, a stratum, or all strata (both null).
  thresholds: {
    lane: number;
    group: number | null;
    stratum: number | null;
    disjoint: Threshold;
    intersects: Threshold;
  }[];
  // kind scale: by the exponent of the largest coordinate; offset: by log2(largest coordinate / extent of the pair);
  // …/f64: the same on pairs of doubles. A cell stands for exponents [exponent, exponent + step); cells without pairs
  // are absent. origin: the exponent nearest to 0 that has enough pairs to compare with; null if there is none. says:
  // the exponents up to which the lane is as right as at the origin. times, if the lane errs in the cell: the ratio of
  // the cell's share to the origin's, with a lower and an upper bound from both 95 % intervals; null for a division by
  // 0.
  extremes: {
    kind: 'scale' | 'offset' | 'scale/f64' | 'offset/f64';
    step: number;
    lane: number;
    cells: { exponent: number; wrong: Share; times?: Times }[];
    origin: number | null;
    says: string;
  }[];
  signature_count: number; // all signatures; `signatures` has the most frequent ones
  signatures: {
    // one for each signature that fits the page, most frequent first
    key: string;
    algorithm: string;
    count: number;
    share: number; // of all pairs
    contact: string;
    dimensions: string;
    coplanar: boolean;
    nesting?: 'a_in_b' | 'b_in_a' | 'same'; // which triangle lies in the other
    margin: string; // "-2^-3", "0", "2^4" ulps
    marks: string; // one character ('.' '+' '-' '?') for each lane of the algorithm, in the order of `lanes`
    cards: number[]; // the signature's kinds: indices in `cards`, most frequent first
    pairs: string[]; // kept pairs, such as "near_edge_edge:1:42"
  }[];
  sources: { [algorithm: string]: string }; // replaces "@SOURCE@" in the snippets of the algorithm's cards
  cards: {
    // one for each kind of failure, most frequent first; the pair is its simplest case
    kind: FailureKind;
    file: string;
    minimised: boolean;
    from: string; // "near_edge_edge:1:42"
    coordinates: 'f32' | 'f64';
    pair: { decimal: string[]; hex: string[]; value: number[] }; // 18 each, a[0].x … b[2].z
    truth: { verdict: string; contact: string; margin: number; margin_ulps: number };
    // For the drawing, in double, rounded from exact values: the points of the common set, and the line where the
    // planes meet, clipped to the pair's enlarged box.
    drawing: { contact: number[][]; planes_line: number[][] }; // 0, 1, 2 or more points; 0 or 2 points
    verdicts: { lane: number; verdict: 'disjoint' | 'intersects' | 'declined'; wrong: boolean }[]; // all that ran
    sentences: string[]; // explain's sentences; those about lanes of the kind come first
    // The result of `graze minimize DIR`; null if it is missing, belongs to another pair, or does not fit the page.
    maps: {
      title: string;
      x: string;
      y: string;
      size: number; // "b[0].x", "b[0].y", 256; y points upwards
      legend: { colour: string; means: string }[]; // "#rrggbb" as in the panels, "disjoint", …
      // name: "truth" or a lane id; shows: its counts in words, missing in old maps; png: base64
      panels: { name: string; shows?: string; png: string }[];
    } | null;
    commands: { label: string; text: string }[]; // "repro", "explain", "minimize"
    snippets: { label: string; text: string }[]; // "cpp", "python", …; may be empty to save space
  }[];
  missing: string[]; // sentences on what this report lacks (not minimised, no maps, …)
  compare: Compare | null;
}

// How verdicts change with the toolchain. A row has a cell for each variant that ran. differs: the share of verdicts
// that differ from the reference's; null if not counted. agree: groups of variants with the same verdicts on every pair
// of every row.
export interface ToolchainMap {
  reference: string;
  variants: string[];
  rows: {
    algorithm: string;
    scalar: string;
    cells: { variant: number; lane: number; differs: Share | null; wrong: Share }[];
  }[];
  agree: string[][];
  sentences: string[];
}

// A kind of failure groups signatures (fuzz/minimise/kinds.h): a subject (algorithm), a cause, the source line of the
// deciding comparison, and the shape of the pairs.
export interface FailureKind {
  key: string; // "moller_1997/rounding/moller_1997.h:117/general"
  subject: string;
  cause: string;
  line: string; // "core/algorithms/moller_1997.h:117"; empty if no comparison is to blame
  shape: 'general' | 'coplanar' | 'contained' | 'degenerate';
  pairs: number;
  intersecting: number; // pairs that intersect; wrong verdicts on these are false negatives
  signatures: number;
  lanes: string[]; // ids of the lanes that fail in this way on some pair of the kind
  settled: [number, number]; // numbers of lanes whose cause passed the audit, and of lanes that it could check
  strata: { [id: string]: number }; // kept pairs by stratum; at most four for each signature
  margins: { [bucket: string]: number }; // all pairs of the kind by margin; "-2^-3", "0", "+2^4" ulps
  worst: { case: string; pair: string; from: string; margin_ulps: number }; // pair: 18 hex floats
}

export interface ChangedVerdicts {
  lane: string;
  stratum: string;
  pairs: number;
  known: string; // same, changed, unknown
  least: number; // least and most: bounds on the number of changed verdicts
  most: number;
  broken?: number; // became wrong; only if both versions of the code decided the pairs again
  mended?: number; // no longer wrong
  smallest_broken?: string; // "STRATUM:SEED:INDEX 18 numbers"
  smallest_mended?: string;
}

export interface Compare {
  // `--compare DIR1 DIR2`: run is DIR2, other is DIR1
  other: Report['run'];
  headline: string; // "Nothing changed: …", "Changed: …"
  differences: string[]; // sentences on how the campaigns differ
  rates: {
    lane: string;
    stratum: string;
    before: Share; // wrong
    after: Share;
    changed: boolean; // by more than chance; on the same pairs, by any amount
    unseen?: number | null; // a smaller difference could be chance; absent on the same pairs
    errors: { error: string; before: Share; after: Share }[]; // kinds of error that changed: "false positives", …
  }[];
  gained: { key: string; signatures: number; count: number }[]; // kinds, with their signatures and pairs
  lost: { key: string; signatures: number; count: number }[];
  kinds_compared: boolean; // false unless `graze minimize` ran on both
  verdicts?: ChangedVerdicts[] | null; // only on the same pairs
}
