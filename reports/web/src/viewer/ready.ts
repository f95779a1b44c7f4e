// SPDX-License-Identifier: Apache-2.0
// Prepares the module, and checks it against the native build.
import { h } from '../dom';
import { replay, type Stored } from './data';
import { load, type Graze } from './graze.js';

async function module_of(base64: string): Promise<WebAssembly.Module> {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

export interface Ready {
  graze: Graze;
  module: WebAssembly.Module;
  said: string;
}

// Returns the module after it has decided the stored pairs.   Throws: how it differs from the native build, as text.
export async function make_ready(stored: Stored): Promise<Ready> {
  const module = await module_of(stored.module),
    graze = await load(module),
    apart = replay(graze, stored.replay);
  if (apart.length)
    throw new Error(
      `This browser decides differently from the native build: ${apart.slice(0, 3).join('; ')}${apart.length > 3 ? `; and ${apart.length - 3} more` : ''}.`,
    );
  return {
    graze,
    module,
    said: `Same as the native build on ${stored.replay.pairs.length} pairs, ${stored.replay.lanes.length} lanes each.`,
  };
}

export const no_verdicts = (error: unknown) => [
  h('h1', {}, 'No verdicts'),
  h('p', { class: 'notice', role: 'alert', id: 'warning' }, String(error instanceof Error ? error.message : error)),
  h('p', {}, 'To decide the pair in a terminal: ', h('code', {}, 'graze check FILE'), '.'),
];
