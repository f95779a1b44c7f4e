// SPDX-License-Identifier: Apache-2.0
// The page's choices, kept in the URL's fragment so that links, reloads and Back restore them.
// "#kind-7&find=moller+f64" is a place, followed by the filters. A link that has only a place keeps the filters. A pair
// in the viewer (card_viewer.ts) is not a filter: "#kind-7&p=…&by=…".

let place = '';
let entered = false; // the viewer was opened from the history entry before this one
let values = new URLSearchParams();
const kOfTheViewer = ['p', 'by'];
const listeners: (() => void)[] = [];
const announce = () => listeners.forEach((changed) => changed());

// Only our own history entries have a state, so Back can be told from a click on a link.
const is_own = () => (history.state as { graze?: boolean } | null)?.graze === true;

function read() {
  const [first, ...rest] = location.hash.slice(1).split('&');
  const has_place = !first.includes('=');
  place = has_place ? first : '';
  const filters = new URLSearchParams((has_place ? rest : [first, ...rest]).join('&'));
  if (is_own() || filters.size > 0) values = filters;
  else kOfTheViewer.forEach((key) => values.delete(key));
}

function write(how: 'pushState' | 'replaceState') {
  const text = [place, values.toString()].filter(Boolean).join('&');
  history[how]({ graze: true }, '', text ? `#${text}` : location.href.split('#')[0]);
}

export const chosen = (key: string) => values.get(key) ?? '';

// An empty value removes the choice.
export function choose(key: string, value: string) {
  if (value) values.set(key, value);
  else values.delete(key);
  write('replaceState');
}

// Calls `changed` after a link or Back has changed the choices.
export const when_chosen = (changed: () => void) => listeners.push(changed);

function visit(id: string, more: Record<string, string>) {
  place = id;
  Object.entries(more).forEach(([key, value]) => values.set(key, value));
  write('pushState');
  announce();
}

// Shows the element with that id, as a click on a link would, and sets additional choices.
export function go_to(id: string, more: Record<string, string> = {}) {
  visit(id, more);
  document.getElementById(id)?.scrollIntoView({ block: 'start' });
}

export const place_of_address = () => place;

// Opens a pair in the viewer over the element with that id; Back closes it.
export function into_viewer(id: string, pair: string, lane: string) {
  entered = true;
  visit(id, { p: pair, by: lane });
}

export function out_of_viewer() {
  if (entered) return history.back();
  kOfTheViewer.forEach((key) => values.delete(key));
  write('replaceState');
  announce();
}

// Calls arrived(id) with the place in the fragment, now and after every link.
export function follow_fragment(arrived: (id: string) => void) {
  write('replaceState');
  if (place) arrived(place);
  addEventListener('hashchange', () => {
    const before = place,
      in_viewer = chosen('p') !== '';
    read();
    entered = false;
    write('replaceState');
    announce();
    if (place && !(in_viewer && place === before)) arrived(place); // closing the viewer keeps the scroll position
  });
}

read();
