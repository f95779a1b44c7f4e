// SPDX-License-Identifier: Apache-2.0
// The page of `graze view`. The address stores the pair.
import '../style.css';
import { h } from '../dom';
import { from_bits, type ViewData } from './data';
import { fragment_of, from_fragment, special_cases, type Model } from './model';
import { make_ready, no_verdicts } from './ready';
import { viewer, type First } from './viewer';

function first_of({ coordinates, pairs, opens }: ViewData): First {
  const linked = from_fragment(coordinates);
  return linked
    ? { name: 'the pair of a link', ...linked }
    : pairs.length
      ? {
          name: pairs[0].name,
          pair: from_bits(pairs[0].bits, coordinates),
          lane: opens === 'triangles' ? `exact/${coordinates}/cpu` : '',
        }
      : { ...special_cases(coordinates)[0], lane: opens === 'random' ? 'interval_overlap/f32/cpu' : '' }; // the thesis's algorithm
}

async function start() {
  const page = document.getElementById('page')!,
    text = document.getElementById('view')?.textContent?.trim() ?? '';
  if (!text || text.startsWith('<!--'))
    return void (page.textContent = 'This page has no data. To make a viewer with data, run: graze view');
  const data = JSON.parse(text) as ViewData;
  try {
    const shown = viewer(data, await make_ready(data), first_of(data), {
      // A page inside a notebook (about:srcdoc) has no address.
      keep: (model: Model) => location.protocol !== 'about:' && history.replaceState(null, '', fragment_of(model)),
      link: (model: Model) => `${location.href.split('#')[0]}${fragment_of(model)}`,
      active: () => true,
    });
    page.replaceChildren(
      h('header', { class: 'viewer-head' }, shown.head),
      h('main', { class: 'viewer-body' }, shown.body),
      shown.help,
    );
    addEventListener('hashchange', ({ newURL }) => {
      const next = from_fragment(data.coordinates, newURL);
      if (next) shown.show({ name: 'the pair of a link', ...next });
    });
    shown.begin();
  } catch (error) {
    page.replaceChildren(h('main', {}, no_verdicts(error)));
  }
}

void start();
