// SPDX-License-Identifier: Apache-2.0
// Many triangles against the reference, as in 2012: random ones of the thesis's generator, or those of a mesh or a
// query.
import { h } from '../dom';
import { count } from '../format';
import { from_bits, type Coordinates, type ViewData } from './data';
import type { Model } from './model';
import type { Field } from './shape';

const kLeast = 16,
  kMost = 8192;

export function field(model: Model, data: ViewData, changed: () => void) {
  const { graze } = model,
    mesh = data.triangles.map(from_bits);
  let shown = 0,
    seed = 1n,
    triangles: Coordinates[] = [],
    current: Field | null = null;
  const told = h('p', { class: 'small', id: 'field' });

  function draw_triangles() {
    triangles = mesh.length
      ? mesh.slice(0, shown)
      : Array.from({ length: shown }, (_, i) => graze.generate('thesis', seed, BigInt(i)).slice(9));
  }

  // Decides all triangles with the chosen lane and with the exact decision.
  function decide() {
    if (!shown) return (current = null);
    const { exports } = graze,
      lane = graze.lanes.indexOf(model.lane),
      hit: boolean[] = [],
      wrong: boolean[] = [];
    for (let first = 0; first < triangles.length; first += graze.room) {
      const some = triangles.slice(first, first + graze.room);
      const room = new Float32Array(exports.memory.buffer, exports.pairs(), 18 * some.length);
      some.forEach((triangle, i) => {
        room.set(model.pair.subarray(0, 9), 18 * i);
        room.set(triangle, 18 * i + 9);
      });
      const said = () => new Uint8Array(exports.memory.buffer, exports.verdicts(), some.length).slice();
      exports.decide_truth(some.length);
      const truth = said();
      const verdicts = exports.decide(lane, some.length) ? said() : truth;
      verdicts.forEach((verdict, i) => {
        hit.push(verdict === 1);
        wrong.push(verdict !== truth[i]);
      });
    }
    return (current = { triangles, hit, wrong });
  }

  function tell() {
    const sum = (all: boolean[]) => count(all.filter(Boolean).length);
    told.replaceChildren(
      ...(current
        ? [
            h(
              'strong',
              {},
              `${count(triangles.length)} ${mesh.length ? '' : 'random '}triangles against a, the reference: `,
            ),
            h('code', {}, model.lane),
            ` hits ${sum(current.hit)}, wrong on ${sum(current.wrong)} (outlined). The table is of the pair named above; press a verdict to see its lane here. `,
            h(
              'button',
              { type: 'button', onclick: take },
              current.wrong.some(Boolean) ? 'Take a wrong one' : 'Take a hit',
            ),
            ' ',
            h('button', { type: 'button', onclick: () => set_shown(0) }, 'Back to the pair'),
          ]
        : []),
    );
  }

  function take() {
    const at = current!.wrong.indexOf(true),
      one = at < 0 ? current!.hit.indexOf(true) : at;
    if (one < 0) return;
    const triangle = triangles[one];
    set_shown(0);
    model.change((pair) => pair.set(triangle, 9));
  }
  function set_shown(next: number) {
    shown = Math.min(mesh.length || kMost, next);
    if (shown < Math.min(kLeast, mesh.length || kLeast)) shown = 0;
    draw_triangles();
    changed();
  }
  return {
    element: told,
    current: () => current,
    all: () => set_shown(mesh.length),
    more: () => set_shown(shown ? 2 * shown : mesh.length || 4 * kLeast),
    fewer: () => set_shown(Math.floor(shown / 2)),
    again() {
      if (mesh.length) return set_shown(shown || mesh.length);
      ++seed;
      set_shown(shown || 4 * kLeast);
    },
    update() {
      decide();
      tell();
    },
  };
}
