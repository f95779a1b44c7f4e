// SPDX-License-Identifier: Apache-2.0
// Fields whose values are kept in the URL (state.ts).
import { choice, h } from './dom';
import { choose, chosen, when_chosen } from './state';

// A labelled <select>. The first option is the default, which is not written to the URL. `changed` is called after the
// reader makes a choice; after a link or Back, only the field changes.
export function kept_choice(key: string, label: string, options: [string, string][], changed: () => void) {
  const value = () => (options.find(([id]) => id === chosen(key)) ?? options[0])[0];
  const element = choice(label, options, value(), (id) => {
    choose(key, id === options[0][0] ? '' : id);
    changed();
  });
  when_chosen(() => (element.querySelector('select')!.value = value()));
  return { element, value };
}

// A labelled search field.
export function kept_search(key: string, label: string, placeholder: string, changed: () => void) {
  const search = () => {
    choose(key, field.value.trim());
    changed();
  };
  const field = h('input', { type: 'search', placeholder, value: chosen(key), oninput: search });
  when_chosen(() => (field.value = chosen(key)));
  return h('label', { class: 'field' }, h('span', {}, label), field);
}
