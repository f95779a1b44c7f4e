// SPDX-License-Identifier: Apache-2.0
// The ulp map: the verdicts around the pair as two of its coordinates move by single ulps.
import { breakable, choice, h, section } from '../dom';
import { coordinate_name } from './data';
import type { Model } from './model';
import { kSide, type MapPart, type MapRequest } from './map_worker';
import MapWorker from './map_worker?worker&inline';

// The colours of `graze map` (reports/ulp_map_picture.cpp).
const kColours = {
  disjoint: '#eeeeee',
  intersects: '#aaaaaa',
  'false positive': '#d55e00',
  'false negative': '#0072b2',
  declined: '#f0e442',
  'not finite': '#cc79a7',
};
const kPalette = Object.values(kColours).map((colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16)));
const kCells = [
  ['1 ulp', 1],
  ['16 ulps', 16],
  ['256 ulps', 256],
  ['4,096 ulps', 4096],
  ['65,536 ulps', 65536],
] as const;
const kWait = 40; // milliseconds without a change before the map is drawn again

// The index in kPalette for a lane's verdict, given the truth.
const cell_of = (verdict: number, truth: number) =>
  truth === 2 ? 5 : verdict === 2 ? 4 : verdict === truth ? truth : verdict === 1 ? 2 : 3;

export function map(model: Model, module: WebAssembly.Module) {
  let x = 9,
    y = 10,
    step = 1,
    of = 'variants',
    number = 0,
    timer = 0,
    lanes: string[] = [],
    worker: Worker | null = null;
  const panels = h('div', { class: 'panels' }),
    told = h('p', { class: 'small', id: 'map-told', 'data-number': 0 });
  let canvases: HTMLCanvasElement[] = [],
    seen = false;

  function start_worker() {
    const started = new MapWorker();
    started.postMessage(module);
    started.onmessage = ({ data }: MessageEvent<MapPart>) => data.number === number && paint(data);
    return started;
  }

  function paint({ row, every, rows, milliseconds, last }: MapPart) {
    const truth = rows[0]!;
    canvases.forEach((canvas, panel) => {
      const context = canvas.getContext('2d')!,
        cells = rows[panel];
      if (!cells) return context.clearRect(0, 0, kSide, kSide);
      const image = context.createImageData(kSide, every);
      for (let i = 0; i < kSide; ++i) {
        const column = Math.floor(i / every),
          [r, g, b] =
            kPalette[panel === 0 ? (truth[column] === 2 ? 5 : truth[column]) : cell_of(cells[column], truth[column])];
        for (let j = 0; j < every; ++j) image.data.set([r, g, b, 255], 4 * (j * kSide + i));
      }
      context.putImageData(image, 0, row);
    });
    if (last) {
      told.textContent = `${kSide} × ${kSide} cells of ${rows.length - 1} lanes and the truth, decided in ${Math.round(milliseconds)} ms`;
      told.dataset.number = String(number);
    }
  }

  // Loads the pair of the clicked cell.
  function press(canvas: HTMLCanvasElement, event: MouseEvent) {
    const box = canvas.getBoundingClientRect();
    const column = Math.floor(((event.clientX - box.left) / box.width) * kSide),
      row = Math.floor(((event.clientY - box.top) / box.height) * kSide);
    model.change((pair) => {
      pair[x] = model.graze.nudged(pair[x], (column - kSide / 2) * step);
      pair[y] = model.graze.nudged(pair[y], (kSide / 2 - row) * step);
    });
  }

  function request() {
    const [subject, scalar, variant] = model.lane.split('/');
    const next = model.graze.lanes.filter(
      (lane) =>
        !lane.startsWith('exact/') &&
        (of === 'variants' && subject !== 'exact'
          ? lane.startsWith(`${subject}/${scalar}/`)
          : lane.endsWith(`/${scalar}/${variant}`) || (subject === 'exact' && lane.endsWith('/f32/cpu'))),
    );
    if (next.join() !== lanes.join() || !canvases.length) {
      lanes = next;
      canvases = ['truth', ...lanes].map((name) => {
        const canvas = h('canvas', { width: kSide, height: kSide, role: 'img', 'aria-label': `Ulp map of ${name}` });
        canvas.onclick = (event) => press(canvas, event);
        return canvas;
      });
      panels.replaceChildren(
        ...canvases.map((canvas, i) =>
          h(
            'figure',
            { class: 'panel' },
            h('div', {}, canvas),
            h('figcaption', {}, i ? breakable(lanes[i - 1]) : 'truth'),
          ),
        ),
      );
    }
    worker ??= start_worker();
    ++number;
    worker.postMessage({ number, pair: model.pair, x, y, step, lanes, policy: model.policy } satisfies MapRequest);
  }

  const again = () => {
    clearTimeout(timer);
    if (seen) timer = window.setTimeout(request, kWait);
  };
  const names = Array.from({ length: 18 }, (_, c) => [String(c), coordinate_name(c)] as [string, string]);
  const across = choice('To the right', names, String(x), (value) => {
    x = Number(value);
    again();
  });
  const upwards = choice('Upwards', names, String(y), (value) => {
    y = Number(value);
    again();
  });
  let last_chosen = -1;
  const element = section(
    'map',
    'Ulp map',
    h('p', { class: 'small' }, 'The pair is in the middle; press a cell to take its pair.'),
    h(
      'div',
      { class: 'controls' },
      across,
      upwards,
      choice(
        'A cell is',
        kCells.map(([name, ulps]) => [String(ulps), name]),
        '1',
        (value) => {
          step = Number(value);
          again();
        },
      ),
      choice(
        'Lanes',
        [
          ['variants', 'the chosen algorithm'],
          ['algorithms', 'all algorithms, built the same way'],
        ],
        of,
        (value) => {
          of = value;
          again();
        },
      ),
    ),
    panels,
    h(
      'p',
      { class: 'map-key small' },
      Object.entries(kColours).map(([name, colour]) => h('span', {}, h('i', { style: `background:${colour}` }), name)),
    ),
    told,
  );
  new IntersectionObserver(
    ([entry]) => {
      seen = entry.isIntersecting;
      if (seen) again();
    },
    { rootMargin: '200px' },
  ).observe(element);
  return {
    element,
    update() {
      if (model.chosen !== last_chosen) {
        // the map's axes become the chosen coordinate and the next coordinate of its vertex
        last_chosen = x = model.chosen;
        y = model.vertex + ((model.chosen + 1) % 3);
        across.querySelector('select')!.value = String(x);
        upwards.querySelector('select')!.value = String(y);
      }
      again();
    },
  };
}
