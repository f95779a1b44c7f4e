// SPDX-License-Identifier: Apache-2.0
// What each key does. docs/viewer.md compares the keys with those of 2012.
import type { board } from './board';
import { kMove } from './coordinates';
import type { field } from './field';
import type { Key } from './keys';
import { kCentres, type Model } from './model';
import type { sources } from './sources';

interface Parts {
  model: Model;
  drawing: ReturnType<typeof board>;
  many: ReturnType<typeof field>;
  from: ReturnType<typeof sources>;
  say: (text: string) => void;
  other_processor: () => void;
  toggle_help: () => void;
}

// The first view of 2012 looked along -x, where w moved the reference away and d moved it to the right.
const kMoves: [string, number, number, string][] = [
  ['w', 0, -kMove, '−x'],
  ['s', 0, kMove, '+x'],
  ['a', 1, -kMove, '−y'],
  ['d', 1, kMove, '+y'],
  ['q', 2, -kMove, '−z'],
  ['e', 2, kMove, '+z'],
];

function keys_of_2012({ model, drawing, many, other_processor, toggle_help }: Parts): Key[] {
  const show = (what: keyof Model['shows']) => () => model.toggle(what);
  const on_board: Key[] = [
    { keys: ['ArrowLeft'], shown: '←', does: 'turn left', press: () => drawing.turn(-1, 0) },
    { keys: ['ArrowRight'], shown: '→', does: 'turn right', press: () => drawing.turn(1, 0) },
    {
      keys: ['ArrowUp'],
      shown: '↑',
      does: 'magnify; with Shift tilt up',
      press: (event) => (event.shiftKey ? drawing.turn(0, 1) : drawing.magnify(1.5)),
    },
    {
      keys: ['ArrowDown'],
      shown: '↓',
      does: 'magnify less; with Shift tilt down',
      press: (event) => (event.shiftKey ? drawing.turn(0, -1) : drawing.magnify(1 / 1.5)),
    },
    { keys: [' '], shown: 'space', does: 'new random triangles', press: many.again },
  ];
  const anywhere: Key[] = [
    { keys: ['h', '?'], shown: 'h', does: 'this help', press: toggle_help },
    ...kMoves.map(([key, axis, step, where]) => ({
      keys: [key],
      shown: key,
      does: `move the first triangle by ${kMove} along ${where}`,
      press: () => model.move_reference(axis, step),
    })),
    { keys: ['o'], shown: 'o', does: 'axes', press: show('axes') },
    { keys: ['c'], shown: 'c', does: 'coordinates', press: show('coordinates') },
    { keys: ['i'], shown: 'i', does: 'vertex ids, or the numbers of many triangles', press: show('ids') },
    { keys: ['p'], shown: 'p', does: 'planes', press: show('planes') },
    { keys: ['t'], shown: 't', does: 'show or leave the ten special cases', press: many.special },
    { keys: ['g'], shown: 'g', does: 'switch the chosen lane between CPU and GPU', press: other_processor },
    { keys: ['+', '='], shown: '+', does: 'one more triangle against the first', press: () => many.add(1) },
    { keys: ['-'], shown: '-', does: 'one triangle fewer', press: () => many.add(-1) },
  ];
  return [...on_board.map((key) => ({ ...key, on_board: true })), ...anywhere].map((key) => ({
    ...key,
    of_2012: true,
  }));
}

function new_keys({ model, drawing, from, say }: Parts): Key[] {
  const ulps = (event: KeyboardEvent) => (event.altKey ? 65536 : event.shiftKey ? 256 : 1);
  return [
    {
      keys: ['n'],
      shown: 'n',
      does: 'next pair; with Shift the next pair on which CPU and GPU differ',
      press: (event) => void from.go(1, event.shiftKey ? 'apart' : 'any'),
    },
    { keys: ['b'], shown: 'b', does: 'previous pair', press: () => void from.go(-1) },
    ...['0', '1', '2', '3', '4', '5'].map((key, v) => ({
      keys: [key],
      shown: key,
      does: `choose vertex ${v < 3 ? 'a' : 'b'}[${v % 3}]`,
      press: () => model.set({ chosen: 3 * v + (model.chosen % 3) }),
    })),
    ...['x', 'y', 'z'].map((key, k) => ({
      keys: [key],
      shown: key,
      does: `choose the vertex’s ${key}`,
      press: () => model.set({ chosen: model.vertex + k }),
    })),
    {
      keys: ['['],
      shown: '[',
      does: 'lower the chosen coordinate by 1 ulp; with Shift by 256, with Alt by 65,536',
      press: (event) => model.step(-ulps(event)),
    },
    {
      keys: [']'],
      shown: ']',
      does: 'raise the chosen coordinate by the same steps',
      press: (event) => model.step(ulps(event)),
    },
    {
      keys: ['f'],
      shown: 'f',
      does: 'change the centre: both triangles, the chosen vertex, or the contact or gap',
      press: () => model.set({ centre: kCentres[(kCentres.indexOf(model.centre) + 1) % kCentres.length] }),
    },
    { keys: ['Home'], shown: 'Home', does: 'reset the view', on_board: true, press: () => drawing.reset() },
    {
      keys: ['u'],
      shown: 'u',
      does: 'undo; also Ctrl+Z',
      with_control: 'z',
      press: () => model.travel('past') || say('nothing to undo'),
    },
    {
      keys: ['r'],
      shown: 'r',
      does: 'redo; also Ctrl+Y',
      with_control: 'y',
      press: () => model.travel('future') || say('nothing to redo'),
    },
  ];
}

export const all_keys = (parts: Parts): Key[] => [...keys_of_2012(parts), ...new_keys(parts)];
