// SPDX-License-Identifier: Apache-2.0
// Finds pairs that show the error of a cell of the league table: the kept pairs of signatures in which the cell's lane
// makes that error.
import type { Report } from './report';

type Signature = Report['signatures'][number];

export const kErrors = {
  false_positive: 'false positives',
  false_negative: 'false negatives',
  wrong: 'wrong verdicts',
  differs_from_cpu: 'verdicts other than the cpu lane’s',
} as const;
export type Kind = keyof typeof kErrors;

export interface Cell {
  lane: number;
  stratum: number | null;
  kind: Kind;
}

// The cell as text for the URL: "moller_1997/f32/cpu,near_edge_edge,false_negative".
export const cell_text = (report: Report, { lane, stratum, kind }: Cell) =>
  [report.lanes[lane].id, stratum === null ? 'all' : report.strata[stratum].id, kind].join(',');

// Returns null if the text does not name a cell of this report.
export function cell_of(report: Report, text: string): Cell | null {
  const [id, where, kind] = text.split(',');
  const lane = report.lanes.findIndex((one) => one.id === id),
    stratum = where === 'all' ? null : report.strata.findIndex((one) => one.id === where);
  return lane < 0 || stratum === -1 || !(kind in kErrors) ? null : { lane, stratum, kind: kind as Kind };
}

export const cell_words = (report: Report, { lane, stratum, kind }: Cell) =>
  `${report.lanes[lane].id}, ${kErrors[kind]} on ${stratum === null ? 'all strata' : report.strata[stratum].id}`;

const lanes_beside = (report: Report, lane: number) =>
  report.lanes.flatMap((one, i) => (one.algorithm === report.lanes[lane].algorithm ? [i] : []));

const cpu_lane = (report: Report, lane: number) =>
  report.lanes.findIndex(
    (one) =>
      one.target === 'cpu' &&
      one.algorithm === report.lanes[lane].algorithm &&
      one.scalar === report.lanes[lane].scalar,
  );

// The ids of the lanes that are wrong in a signature.
export function wrong_lanes(report: Report, signature: Signature): string[] {
  const lanes = report.lanes.filter((lane) => lane.algorithm === signature.algorithm);
  return lanes.flatMap((lane, i) => ('+-?'.includes(signature.marks[i] ?? '_') ? [lane.id] : []));
}

// The kept pairs of the signature that show the cell's error.
export function kept_pairs(report: Report, { lane, stratum, kind }: Cell, signature: Signature): string[] {
  if (signature.algorithm !== report.lanes[lane].algorithm) return [];
  const lanes = lanes_beside(report, lane);
  const mark_of = (one: number) => signature.marks[lanes.indexOf(one)] ?? '_';
  const mark = mark_of(lane),
    cpu = cpu_lane(report, lane);
  const shows =
    kind === 'false_positive'
      ? mark === '+'
      : kind === 'false_negative'
        ? mark === '-'
        : kind === 'wrong'
          ? '+-?'.includes(mark)
          : mark !== '_' && cpu >= 0 && mark_of(cpu) !== '_' && mark !== mark_of(cpu);
  return shows
    ? signature.pairs.filter((pair) => stratum === null || pair.split(':')[0] === report.strata[stratum].id)
    : [];
}

const twin = (report: Report, lane: number) =>
  report.lanes[lane].evidence?.startsWith('twin') ? ' --executor twin' : '';

// A command that shows one pair of a cell again, and one that finds all of the cell's pairs.
export const repro_command = (report: Report, { lane }: Cell, pair: string) =>
  `graze repro ${pair} --lanes '${report.lanes[lane].id}'${twin(report, lane)}`;

export function campaign_command(report: Report, { lane, stratum }: Cell) {
  const cpu = cpu_lane(report, lane);
  const lanes = [...new Set([cpu < 0 ? lane : cpu, lane])].map((one) => report.lanes[one].id).join(',');
  const of =
    stratum === null
      ? `--pairs ${report.run.pairs}`
      : `--strata ${report.strata[stratum].id} --pairs ${report.strata[stratum].pairs}`;
  return `graze fuzz ${of} --seed ${report.run.seed} --lanes '${lanes}'${twin(report, lane)} --out cell && graze report cell`;
}
